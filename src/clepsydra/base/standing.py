"""The one way in which it is asked what stands at a path that a user gave."""

from __future__ import annotations

import stat
from enum import Enum
from pathlib import Path

from clepsydra.base.errors import InputError, reason_of


class Standing(Enum):
    """What stands at a path; a link counts as what it leads to."""

    NOTHING = "nothing"
    FILE = "a regular file"
    FOLDER = "a folder"
    OTHER = "a pipe, a device or a socket"


def standing_at(
    path: Path, place: str, expected: str, remedy: str = "check the path", value: object = None
) -> Standing:
    """Return what stands at a path.

    `Path.exists` and its like raise errors of the system where a folder may not be entered, or
    say that nothing is there; here the user is told.

    Parameters
    ----------
    place : str
        Who names the path, for messages: "--output".
    expected : str
        What should be there, for messages: "the name of a file".
    remedy : str
        What to do where the path cannot be looked at.
    value : object, optional
        The path as it was written; as it is if left out.

    Raises
    ------
    InputError
        Nobody can say what is there: a folder on the way may not be entered, a name is too long
        for the system or holds a null character, or links lead to each other.

    Examples
    --------
    >>> standing_at(Path("/dev"), "--output", "the name of a file")
    <Standing.FOLDER: 'a folder'>
    >>> standing_at(Path("long" * 100), "--output", "the name of a file", value="long…")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: --output: got 'long…', expected the name of a file; \
check the path (file name too long).
    """
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return Standing.NOTHING
    except (OSError, ValueError) as error:
        found = str(path) if value is None else value
        raise InputError(place, found, expected, f"{remedy} ({reason_of(error)})") from None
    if stat.S_ISDIR(mode):
        return Standing.FOLDER
    return Standing.FILE if stat.S_ISREG(mode) else Standing.OTHER
