"""What a result says, as sections of lines and tables that any page can show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from clepsydra.base.words import with_minus


class Mark(Enum):
    """What stands before a line, and so what kind of line it is.

    COMMAND is one to copy, NEXT what else follows on the command line; Python shows neither.
    """

    PLAIN = ""
    ANSWER = "answer"
    POINT = "•"
    WATCH = "!"
    REFUSED = "–"
    COMMAND = "$"
    NEXT = "next"
    FILE = "file"


_COPIED = (Mark.COMMAND, Mark.NEXT, Mark.FILE)


@dataclass(frozen=True)
class Line:
    """One sentence or more, to be broken where the page ends; numbers in it have a real minus.

    Parameters
    ----------
    text : str
    mark : Mark
    narrow : str
        What stands in its place below a table that has lost columns, with "{}" for how many.
    """

    text: str
    mark: Mark = Mark.PLAIN
    narrow: str = ""

    def __post_init__(self) -> None:
        """Print numbers of words that others wrote as tables do, but in what is copied."""
        if self.mark not in _COPIED:
            object.__setattr__(self, "text", with_minus(self.text))


@dataclass(frozen=True)
class Table:
    """A table of text with a title, a head and rows.

    Parameters
    ----------
    title : str
        Without one it stands close to the lines around it.
    names : int
        So many columns from the left hold names; the others hold values.
    kept : int
        So many columns from the left stay where the page is too narrow; 0 for all, those that
        have no room below the others.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    names: int = 1
    kept: int = 0


@dataclass(frozen=True)
class Picture:
    """A picture of a page; a terminal leaves it out.

    Parameters
    ----------
    svg : str
        One ``<svg>`` element that escapes its own words.
    words : str
        What stands below it.
    """

    svg: str
    words: str = ""


@dataclass(frozen=True)
class Section:
    """What belongs together: its title, then its lines and tables in their order.

    Parameters
    ----------
    title : str
        May be empty.
    parts : tuple
        Of `Line`, `Table`, `Picture` and `Section`.
    folded : bool
        Whether a page shows only its title until it is asked for more.
    """

    title: str = ""
    parts: tuple[Line | Table | Picture | Section, ...] = ()
    folded: bool = False


def marked(mark: Mark, texts: Iterable[str]) -> tuple[Line, ...]:
    """Return lines with the same mark."""
    return tuple(Line(text, mark) for text in texts)
