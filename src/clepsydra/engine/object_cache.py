"""Compiled objects on disk, so that a kernel is compiled once a machine."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from clepsydra.base.files import PART, remove_abandoned

_DIGEST = 32
_LOG = logging.getLogger(__name__)
#: What is opened must be there itself, not a link to it, and a FIFO must not wait for a writer.
_ITSELF = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)
_FOLDER = _ITSELF | getattr(os, "O_DIRECTORY", 0)
_OTHERS = stat.S_IRWXG | stat.S_IRWXO


class ObjectCache:
    """A private folder of compiled objects, one file a key.

    An object is code, so it is read only from a regular file of this user in a folder of this
    user, neither open to anybody else. The folder is opened once for each object and asked by
    its descriptor, so nothing can be put in its place between the question and the reading. A file
    carries a digest of its key and its content, and is written under another name before it is
    renamed: damage, a crash and a full disk leave either the object or nothing usable. A folder
    that is left alone for its owner or its mode is told once, as a warning of the log.

    Parameters
    ----------
    folder : Path or None
        Made with mode 0700 where it is missing. None keeps nothing, and neither does a system
        on which files are not opened relative to a folder.
    holding : str
        What the objects are, for the warning that they are not kept.
    """

    def __init__(self, folder: Path | None, holding: str = "compiled kernels") -> None:
        self.folder, self.holding = folder, holding

    def load(self, key: str) -> bytes | None:
        """Return the object of a key, or None where there is none that can be trusted."""
        with contextlib.suppress(OSError), self._opened(make=False) as folder:
            file = os.open(_name(key), os.O_RDONLY | _ITSELF, dir_fd=folder)
            with os.fdopen(file, "rb") as stream:
                status = os.fstat(file)
                if not (stat.S_ISREG(status.st_mode) and _is_private(status)):
                    return None
                content = stream.read()
            digest, body = content[:_DIGEST], content[_DIGEST:]
            return body if secrets.compare_digest(_digest(key, body), digest) else None
        return None

    def store(self, key: str, body: bytes) -> None:
        """Keep an object; a disk that cannot be written to costs a compilation, not a run."""
        with contextlib.suppress(OSError), self._opened(make=True) as folder:
            remove_abandoned(folder)
            part = secrets.token_hex(8) + PART
            mode = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _ITSELF
            file = os.open(part, mode, 0o600, dir_fd=folder)
            try:
                with os.fdopen(file, "wb") as stream:
                    os.fchmod(file, 0o600)  # whatever the umask left of it
                    stream.write(_digest(key, body) + body)
                os.rename(part, _name(key), src_dir_fd=folder, dst_dir_fd=folder)
            except BaseException:
                os.unlink(part, dir_fd=folder)
                raise

    @contextmanager
    def _opened(self, *, make: bool) -> Iterator[int]:
        """Give the descriptor of the folder; raise OSError where it is not this user's alone."""
        if self.folder is None or os.open not in os.supports_dir_fd:
            raise FileNotFoundError("no folder to keep objects in")
        if make:
            _make_private(self.folder)
        folder = os.open(self.folder, os.O_RDONLY | _FOLDER)
        try:
            status = os.fstat(folder)
            if not _is_private(status):
                mode = stat.S_IMODE(status.st_mode)
                _tell_left_alone(self.folder, self.holding, status.st_uid, mode)
                raise PermissionError(f"{self.folder} is open to others")
            yield folder
        finally:
            os.close(folder)


def default_cache() -> ObjectCache:
    """Return the cache in CLEPSYDRA_CACHE, or in the user's cache folder, or one without a folder.

    A user without a home, as in many a container, keeps nothing.
    """
    chosen = os.environ.get("CLEPSYDRA_CACHE")
    if chosen:
        return ObjectCache(Path(chosen))
    base = os.environ.get("XDG_CACHE_HOME")
    try:
        caches = Path(base) if base else Path.home() / ".cache"
    except RuntimeError:  # neither HOME nor an entry in the table of users
        return ObjectCache(None)
    return ObjectCache(caches / "clepsydra" / "kernels")


def _name(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest() + ".o"


def _digest(key: str, body: bytes) -> bytes:
    return hashlib.sha256(hashlib.sha256(key.encode()).digest() + body).digest()


def _is_private(status: os.stat_result) -> bool:
    """Return whether what was opened is this user's, and open to nobody else."""
    return status.st_uid == os.geteuid() and not status.st_mode & _OTHERS


@functools.cache
def _tell_left_alone(folder: Path, holding: str, owner: int, mode: int) -> None:
    """Say once a process why objects are not kept: each is made anew."""
    if owner != os.geteuid():
        why, remedy = "belongs to another user", "name one of your own in CLEPSYDRA_CACHE"
    else:
        why = f"is open to others (mode {mode:o})"
        remedy = f"close it, chmod 700 {folder}, or name another in CLEPSYDRA_CACHE"
    _LOG.warning("%s are not kept, since the folder %s %s; %s", holding, folder, why, remedy)


def _make_private(folder: Path) -> None:
    """Make a folder and those above it that are missing, each for this user alone."""
    missing = [path for path in (folder, *folder.parents) if not os.path.lexists(path)]
    for path in reversed(missing):
        with contextlib.suppress(FileExistsError):  # another process was faster
            path.mkdir(mode=0o700)
            path.chmod(0o700)  # whatever the umask left of it
