"""Compiled objects on disk, so that a kernel is compiled once a machine."""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import tempfile
from pathlib import Path

_DIGEST = 32


class ObjectCache:
    """A private folder of compiled objects, one file a key.

    A file is written whole under another name and then renamed, and carries a digest of its
    content, so a crash or a full disk leaves either the object or nothing usable. A folder
    that belongs to somebody else or that others can write to is not used: an object is code.

    Parameters
    ----------
    folder : Path
        Made with mode 0700 where it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def load(self, key: str) -> bytes | None:
        """Return the object of a key, or None where there is none that is whole."""
        if not self._is_private():
            return None
        try:
            content = self._path(key).read_bytes()
        except OSError:
            return None
        digest, body = content[:_DIGEST], content[_DIGEST:]
        return body if hashlib.sha256(body).digest() == digest else None

    def store(self, key: str, body: bytes) -> None:
        """Keep an object; a disk that cannot be written to costs a compilation, not a run."""
        with contextlib.suppress(OSError):
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not self._is_private():
                return
            handle, name = tempfile.mkstemp(dir=self.folder, suffix=".part")
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(hashlib.sha256(body).digest() + body)
                Path(name).replace(self._path(key))
            except OSError:
                Path(name).unlink(missing_ok=True)
                raise

    def _path(self, key: str) -> Path:
        return self.folder / (hashlib.sha256(key.encode()).hexdigest() + ".o")

    def _is_private(self) -> bool:
        if os.name != "posix":
            return self.folder.is_dir()
        try:
            status = self.folder.lstat()
        except OSError:
            return False
        others = stat.S_IRWXG | stat.S_IRWXO
        return (
            stat.S_ISDIR(status.st_mode)
            and status.st_uid == os.getuid()
            and not status.st_mode & others
        )


def default_cache() -> ObjectCache:
    """Return the cache in CLEPSYDRA_CACHE, or in the user's cache folder."""
    chosen = os.environ.get("CLEPSYDRA_CACHE")
    if chosen:
        return ObjectCache(Path(chosen))
    base = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    return ObjectCache((Path(base) if base else Path.home() / ".cache") / "clepsydra" / "kernels")
