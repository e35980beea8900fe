"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from clepsydra.base.errors import InputError, reason_of
from clepsydra.base.standing import Standing, standing_at

#: The ending of a file that is not whole yet.
PART = ".part"
#: The name of a folder of what stood in the places of files before others were put there.
_BEFORE = re.compile(r"\.before\.[a-z0-9_]{8}")
#: A part of a file that is older was left by a process that was killed [s].
_ABANDONED = 3600.0
_WRITABLE, _REMEDY = "a file that can be written", "choose another folder, or make room"


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a place to write to; on success it becomes `path`, otherwise nothing is left.

    Raises
    ------
    InputError
        The file cannot be written: no such folder, no right to, no room.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with whole_file(Path(folder) / "result.txt") as part:
    ...         _ = part.write_text("done")
    ...     (Path(folder) / "result.txt").read_text()
    'done'
    """
    try:
        remove_abandoned(path.parent, f".{path.name}.")
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=PART)
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise _unwritable(path, error) from None
    os.close(handle)
    part = Path(name)
    try:
        yield part
        mask = os.umask(0)
        os.umask(mask)
        part.chmod(0o666 & ~mask)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise _unwritable(path, error) from None
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def make_folder(folder: Path, place: str) -> None:
    """Make a folder where it is missing, and those above it.

    Raises
    ------
    InputError
        A file stands in its place, or it cannot be made.

    Examples
    --------
    >>> make_folder(Path("/dev/null/results"), "--output")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: --output: got '/dev/null/results', expected a folder, or a \
place for one; choose another (not a directory).
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise InputError(
            place, str(folder), "a folder, or a place for one",
            f"choose another ({reason_of(error)})",
        ) from None  # fmt: skip


def require_writable(folder: Path, place: str) -> None:
    """Refuse a folder in which no file can be made, before any work is done for one.

    Examples
    --------
    >>> require_writable(Path("/proc"), "--output")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: --output: got '/proc', expected a folder in which files can \
be written; choose another (no such file or directory).
    """
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except (OSError, ValueError) as error:
        expected = "a folder in which files can be written"
        remedy = f"choose another ({reason_of(error)})"
        raise InputError(place, str(folder.absolute()), expected, remedy) from None


def remove_abandoned(folder: Path | int, beginning: str = "") -> None:
    """Remove parts of files that processes which were killed have left in a folder.

    Parameters
    ----------
    folder : Path or int
        A folder, or the descriptor of one that is open.
    beginning : str
        Of the names of the parts.

    Raises
    ------
    OSError
        The folder cannot be read.
    """
    where = folder if isinstance(folder, int) else None
    _remove_old(
        folder,
        lambda name: name.startswith(beginning) and name.endswith(PART),
        lambda path: os.unlink(path, dir_fd=where),
    )


def _remove_old(
    folder: Path | int, left: Callable[[str], object], remove: Callable[[str], None]
) -> None:
    """Remove what has such a name in a folder, and is older than anything still at work."""
    before = time.time() - _ABANDONED
    with os.scandir(folder) as entries:
        for entry in entries:
            if left(entry.name):
                with suppress(OSError):  # another process was faster
                    if entry.stat(follow_symlinks=False).st_mtime < before:
                        remove(entry.path)


def write_together(folder: Path, files: Mapping[str, bytes]) -> list[Path]:
    """Write files of one folder, all of them or, where one cannot be written, none.

    Each is written beside its place first, and then they are put there one after the other; where
    that fails for one, what stood in the place of the others before is put back.

    Parameters
    ----------
    files : mapping
        Name to content.

    Raises
    ------
    InputError
        A file cannot be written.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = write_together(Path(folder), {"law.h": b"...", "law.c": b"..."})
    ...     [path.name for path in written]
    ['law.h', 'law.c']
    """
    paths = [folder / name for name in files]
    for path in paths:
        if standing_at(path, "output", _WRITABLE, _REMEDY) is Standing.FOLDER:
            raise _unwritable(path, IsADirectoryError(0, "a folder has that name"))
    with _put_back(folder, paths), ExitStack() as stack:
        parts = [stack.enter_context(whole_file(path)) for path in paths]
        for part, content in zip(parts, files.values(), strict=True):
            part.write_bytes(content)
    return paths


@contextmanager
def _put_back(folder: Path, paths: Sequence[Path]) -> Iterator[None]:
    """Where the block fails, leave in each place what stood there before.

    Copies of it that a process which was killed has left are removed first, when they are old.
    """
    there = [path for path in paths if os.path.lexists(path)]
    try:
        _remove_old(folder, _BEFORE.fullmatch, shutil.rmtree)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".before.") as name:
            kept = Path(name)
            for path in there:
                shutil.copy2(path, kept / path.name, follow_symlinks=False)
            try:
                yield
            except BaseException:
                for path in paths:
                    if path in there:
                        (kept / path.name).replace(path)
                    else:
                        path.unlink(missing_ok=True)
                raise
    except (OSError, ValueError) as error:
        raise _unwritable(folder, error) from None


def _unwritable(path: Path, error: OSError | ValueError) -> InputError:
    return InputError("output", str(path), _WRITABLE, f"{_REMEDY} ({reason_of(error)})")
