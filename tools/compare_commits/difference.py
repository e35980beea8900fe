"""Where two documents differ, number by number and key by key."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

#: Keys that say which of a list's objects one is, so that one more or another order is no
#: difference of all that follow.
_IDENTITIES = (
    ("document", "place", "name"),
    ("subject", "target", "precision", "against"),
    ("controller",),
    ("name",),
    ("key",),
    ("loop",),
)
#: Names of a path that a pattern has at most.
_DEPTH = 3
#: What stands for a value that one side has not.
ABSENT = "absent"


@dataclass(frozen=True)
class Bound:
    """Numbers differ by more than a share of the larger one and by more than nothing."""

    relative: float = 1e-9
    floor: float = 1e-14

    def size(self, first: float, second: float) -> float:
        """Return the difference as a share of the larger number; 0 within the bound."""
        if math.isnan(first) and math.isnan(second):
            return 0.0
        if not (math.isfinite(first) and math.isfinite(second)):
            return 0.0 if first == second else math.inf
        largest, apart = max(abs(first), abs(second)), abs(first - second)
        return apart / largest if apart > max(self.relative * largest, self.floor) else 0.0


@dataclass(frozen=True)
class Difference:
    """One place where two commits differ.

    Parameters
    ----------
    command : str
        Its label.
    group : str
        Its verb, and the target of an export.
    path : tuple of str
        In what it printed and wrote; an entry of a list stands in brackets.
    kind : {"status", "stopped", "came", "gone", "number", "text", "order"}
    first, second
        The values; those of a key that came or went are ABSENT on one side.
    size : float
        Of numbers: the difference as a share of the larger one.
    """

    command: str
    group: str
    path: tuple[str, ...]
    kind: str
    first: Any
    second: Any
    size: float = 0.0

    @property
    def place(self) -> str:
        """The path as it is printed; what was printed in the only step needs no such words."""
        return joined(_short(self.path))

    @property
    def pattern(self) -> str:
        """The begin of the path, without what counts: entries of lists, numbers, names of files."""
        parts = list(_short(self.path))
        if parts[0] == "files" and len(parts) > 1:
            parts[1] = "*" + Path(parts[1]).suffix
        general = [re.sub(r"\d+", "#", re.sub(r"\[.*\]", "[]", part)) for part in parts]
        named = [number for number, part in enumerate(general) if part != "[]"]
        end = named[_DEPTH] if len(named) > _DEPTH else len(general)
        return joined(tuple(general[:end]))


def joined(path: tuple[str, ...]) -> str:
    """Return a path as one text, as in ``ranking[PI].scores.iae``."""
    return re.sub(r"\.(?=\[)", "", ".".join(path))


def _short(path: tuple[str, ...]) -> tuple[str, ...]:
    for word in ("run", "printed"):
        if len(path) > 1 and path[0] == word:
            path = path[1:]
    return path


def differences(
    first: Any, second: Any, bound: Bound, command: str = "", group: str = ""
) -> Iterator[Difference]:
    """Find where two documents differ, in the order of the first."""
    for path, kind, one, other, size in _differing(first, second, bound, ()):
        yield Difference(command, group, path, kind, one, other, size)


_Found = tuple[tuple[str, ...], str, Any, Any, float]


def _differing(first: Any, second: Any, bound: Bound, path: tuple[str, ...]) -> Iterator[_Found]:
    if isinstance(first, dict) and isinstance(second, dict):
        yield from _of_objects(first, second, bound, path)
    elif isinstance(first, list) and isinstance(second, list):
        yield from _of_lists(first, second, bound, path)
    elif _is_number(first) and _is_number(second):
        if size := bound.size(float(first), float(second)):
            yield path, "number", first, second, size
    elif type(first) is not type(second) or first != second:
        number = (_is_number(first) or _is_number(second)) and None in (first, second)
        yield path, "number" if number else "text", first, second, math.inf if number else 0.0


def _of_objects(
    first: dict[str, Any], second: dict[str, Any], bound: Bound, path: tuple[str, ...]
) -> Iterator[_Found]:
    for key in (*first, *(key for key in second if key not in first)):
        here = (*path, key)
        if key not in second:
            yield here, "gone", first[key], ABSENT, 0.0
        elif key not in first:
            yield here, "came", ABSENT, second[key], 0.0
        elif len(here) == 2 and key == "status" and first[key] != second[key]:
            yield here, "status", first[key], second[key], 0.0  # of a step, not of a plant
        else:
            yield from _differing(first[key], second[key], bound, here)


def _of_lists(
    first: list[Any], second: list[Any], bound: Bound, path: tuple[str, ...]
) -> Iterator[_Found]:
    for identity in _IDENTITIES:
        one, other = _named(first, identity), _named(second, identity)
        if one is not None and other is not None:
            yield from _of_objects(one, other, bound, path)
            both = [name[1:-1] for name in one if name in other]
            again = [name[1:-1] for name in other if name in one]
            if both != again:
                yield path, "order", both, again, 0.0
            return
    yield from _of_objects(_numbered(first), _numbered(second), bound, path)


def _named(entries: list[Any], identity: tuple[str, ...]) -> dict[str, Any] | None:
    """Return the objects of a list by name; None where not each has a name of its own."""
    named = {}
    for entry in entries:
        if not isinstance(entry, dict) or not all(isinstance(entry.get(k), str) for k in identity):
            return None
        named[f"[{', '.join(entry[key] for key in identity)}]"] = entry
    return named if len(named) == len(entries) else None


def _numbered(entries: list[Any]) -> dict[str, Any]:
    return {f"[{number}]": entry for number, entry in enumerate(entries)}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
