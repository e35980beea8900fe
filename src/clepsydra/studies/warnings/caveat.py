"""What the simulation or the scenario leaves open, for which no controller is to blame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from clepsydra.base.words import listed

#: So many controllers are named.
_NAMED = 3


@dataclass(frozen=True)
class Caveat:
    """Why the figures of a run say less than they seem to, or what the scenario asks in vain.

    Parameters
    ----------
    words : str
        A sentence, with what to do.
    about : str
        The same in all runs that it is true of, whatever the numbers in its words.
    extent : float
        How far: of several runs the words of the farthest are told.
    seen : bool
        Whether it shows in figures of three digits.
    """

    words: str
    about: str
    extent: float = 0.0
    seen: bool = True


def told_once(runs: Iterable[tuple[str, Sequence[Caveat]]]) -> tuple[str, ...]:
    """Return the caveats of several controllers, each once, with whom it is true of.

    Parameters
    ----------
    runs : iterable of (name, caveats)

    Examples
    --------
    >>> coarse, coarser = (Caveat(f"It is {x} % wrong.", "error", x) for x in (1, 2))
    >>> told_once([("PI", [coarse]), ("PID", [coarser])])
    ('Every controller: It is 2 % wrong.',)
    >>> told_once([("PI", [coarse]), ("PID", [])])
    ('PI: It is 1 % wrong.',)
    """
    runs = list(runs)
    farthest: dict[str, Caveat] = {}
    names: dict[str, list[str]] = {}
    for name, caveats in runs:
        for each in caveats:
            names.setdefault(each.about, []).append(name)
            if each.extent >= farthest.setdefault(each.about, each).extent:
                farthest[each.about] = each
    return tuple(f"{_who(names[about], len(runs))}: {c.words}" for about, c in farthest.items())


def _who(names: Sequence[str], of: int) -> str:
    if len(names) == of > 1:
        return "Every controller"
    more = len(names) - _NAMED
    return listed([*names[:_NAMED], f"{more} more"] if more > 0 else list(names))
