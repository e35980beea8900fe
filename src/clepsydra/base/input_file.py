"""The one way in which a file of a user is read: a regular file, whole, and within a bound."""

from __future__ import annotations

import glob
import os
import stat
from pathlib import Path

from clepsydra.base.errors import Finding, InputError, reason_of
from clepsydra.base.suggestion import nearest

#: A process of a thousand tanks takes less; what is larger is something else.
LARGEST_TEXT = 1_000_000
_MEGABYTE = 1_000_000


def read_input(
    path: Path, expected: str, largest: int = LARGEST_TEXT, inside: str = "the file"
) -> bytes:
    """Read a file whole.

    It is opened without waiting, and what was opened is looked at before it is read: nothing that
    comes to stand at the path in between is read, and a pipe never holds the program up.

    Parameters
    ----------
    expected : str
        What it should be, for messages: "a process file".
    largest : int
        Most bytes that are read.
    inside : str
        What to name where the path is of a folder, for messages.

    Raises
    ------
    InputError
        There is no such file, it is no regular file, it cannot be read, or it is too large.

    Examples
    --------
    >>> from clepsydra.process.catalogue_names import catalogue_file
    >>> read_input(Path(str(catalogue_file("quadruple-tank"))), "a process file")[:1]
    b'#'
    >>> read_input(Path("/dev/null"), "a CSV file")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: /dev/null: got no regular file, expected a CSV file; \
check the path.
    """
    place = str(path) if str(path).isprintable() else ascii(str(path))
    try:
        # Devices are not even opened: that alone can wind a tape or raise a line.
        _check_regular(path.stat().st_mode, place, expected, inside)
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(path, flags), "rb") as stream:
            status = os.fstat(stream.fileno())
            _check_regular(status.st_mode, place, expected, inside)
            content = stream.read(largest + 1) if status.st_size <= largest else None
    except FileNotFoundError:
        raise InputError(place, Finding("no such file"), expected, check_path(path)) from None
    except (OSError, ValueError) as error:
        raise InputError(place, Finding(reason_of(error)), expected, "check the path") from None
    if content is None or len(content) > largest:
        bound = f"{largest / _MEGABYTE:g} MB"
        raise InputError(
            place, Finding(f"more than {bound}"), f"{expected} of at most {bound}",
            "check that this is the file you mean",
        )  # fmt: skip
    return content


def check_path(path: Path, otherwise: str = "check the path") -> str:
    """Return what to do about a file that is not there: which of those beside it may be meant."""
    beside = {each.stem: each.name for each in path.parent.glob(f"*{glob.escape(path.suffix)}")}
    close = nearest(path.stem, sorted(beside))
    return f"perhaps '{beside[close]}' was meant" if close else otherwise


def input_text(content: bytes, file: str, expected: str, longest_line: int) -> str:
    r"""Return the text of a file, its lines ended by line feeds alone.

    Parameters
    ----------
    file : str
        Its name, for messages.
    expected : str
        What it should be, for messages: "a process file".
    longest_line : int
        Most characters of a line.

    Raises
    ------
    InputError
        It is not UTF-8, or a line is too long.

    Examples
    --------
    >>> input_text(b"\xef\xbb\xbftime [s],pump [V]\r\n0,3", "a.csv", "a CSV file", 80)
    'time [s],pump [V]\n0,3'
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{file}, line {line}", Finding(f"byte 0x{content[error.start]:02x}"), "text in UTF-8",
            f"check that this is {expected}, and save it as UTF-8",
        ) from None  # fmt: skip
    text = text.replace("\r\n", "\n")
    for number, line_text in enumerate(text.split("\n"), 1):
        if len(line_text) > longest_line:
            raise InputError(
                f"{file}, line {number}", Finding(f"{len(line_text)} characters"),
                f"a line of at most {longest_line} characters", "break the line",
            )  # fmt: skip
    return text


def _check_regular(mode: int, place: str, expected: str, inside: str) -> None:
    if stat.S_ISDIR(mode):
        raise InputError(place, Finding("a folder"), expected, f"name {inside} in it")
    if not stat.S_ISREG(mode):
        raise InputError(place, Finding("no regular file"), expected, "check the path")
