"""Results that are computed where they are wanted, instead of in a variable before."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable


def mentions(line: str, name: str) -> bool:
    """Whether a line reads or assigns a variable.

    Examples
    --------
    >>> mentions("t1 := t10 + tank.t;", "t1"), mentions("t1 := t10 + tank.t;", "t")
    (True, False)
    """
    return re.search(_whole(name), line) is not None


def in_place(lines: list[str], variables: Container[str], places: Iterable[str]) -> list[str]:
    """Return statements in which a variable that a result is read from is that result.

    Parameters
    ----------
    lines : list of str
    variables : container of str
        Those that nothing else knows.
    places : iterable of str
        What the results are assigned to.

    Examples
    --------
    >>> in_place(["t1 := a + b;", "z := c * t1;", "(* outputs *)", "y := t1;"], ["t1"], ["y"])
    ['y := a + b;', 'z := c * y;']
    """
    for place in places:
        for k, line in enumerate(lines):
            found = re.fullmatch(rf"{re.escape(place)} :?= (\w+);", line)
            if found is None or found[1] not in variables:
                continue
            first = next(j for j, each in enumerate(lines) if mentions(each, found[1]))
            later = [*lines[first:k], *lines[k + 1 :]]
            # What stands in no branch or loop may read what it overwrites.
            once = not lines[first].startswith(" ")
            if not any(mentions(each, place) for each in later[once:]):
                renamed = (re.sub(_whole(found[1]), place, each) for each in later)
                lines = [*lines[:first], *renamed]
            break
    after = [*lines[1:], ""]
    return [line for line, then in zip(lines, after, strict=False) if not _idle(line, then)]


def _whole(name: str) -> str:
    return rf"(?<![\w.>]){re.escape(name)}\b"


def _idle(line: str, then: str) -> bool:
    """Whether a title stands above nothing."""
    return _is_title(line) and (not then or _is_title(then))


def _is_title(line: str) -> bool:
    return line.strip("(*/ )") in ("outputs", "next state")
