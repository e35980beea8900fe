"""What the simulation or the scenario leaves open, for which no controller is to blame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from clepsydra.base.remark import Remark


@dataclass(frozen=True)
class Caveat:
    """Why the figures of a run say less than they seem to, or what the scenario asks in vain.

    Parameters
    ----------
    words : Remark
    about : str
        The same in all runs that it is true of, whatever the numbers in its words.
    extent : float
        How far: of several runs the words of the farthest are told.
    seen : bool
        Whether it shows in figures of three digits.
    """

    words: Remark
    about: str
    extent: float = 0.0
    seen: bool = True


def told_once(runs: Iterable[tuple[str, Sequence[Caveat]]]) -> tuple[str, ...]:
    """Return the caveats of several controllers, each once, with whom it is true of.

    Examples
    --------
    >>> coarse, coarser = (Caveat(Remark(f"It is {x} % wrong"), "error", x) for x in (1, 2))
    >>> told_once([("PI", [coarse]), ("PID", [coarser])])
    ('Every controller, most of all PID: It is 2 % wrong.',)
    >>> told_once([("PI", [coarse]), ("PID", [coarser]), ("LQI", [])])
    ('2 of 3 controllers, most of all PID: It is 2 % wrong.',)
    """
    runs = list(runs)
    true_of: dict[str, list[tuple[Caveat, str]]] = {}
    for name, caveats in runs:
        for each in caveats:
            true_of.setdefault(each.about, []).append((each, name))
    said = []
    for found in true_of.values():
        farthest, name = max(found, key=lambda entry: entry[0].extent)
        who = name
        if len(found) > 1:
            some = f"{len(found)} of {len(runs)} controllers"
            who = "Every controller" if len(found) == len(runs) else some
            if len({entry[0].extent for entry in found}) > 1:
                who = f"{who}, most of all {name}"
        said.append(f"{who}: {farthest.words}")
    return tuple(said)
