"""Other pours than ours: on what a recovery hangs, since the report prints none.

It prints neither how much water was poured in nor how fast. The runs have 25 % of a tank within a
second; here are a smaller pour and two larger ones, of which the largest just stays below the
level at which the simulator stops the pumps. They are without noise, which costs one run each.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from clepsydra.base.words import listed
from clepsydra.papers.four_tank_laboratory.controllers import Kind
from clepsydra.papers.four_tank_laboratory.readings import Reading
from clepsydra.papers.four_tank_laboratory.set_ups import SET_UPS, SetUp
from clepsydra.papers.four_tank_laboratory.simulator import (
    POURED_LEVEL,
    SCORES,
    Definition,
    runs,
)

#: [cm]
OTHERS = (3.0, 9.0, 12.0)
#: Whose pour it is, behind its size.
OURS = "(ours; the report prints neither how much nor how fast)"
_TANKS = (1, 2)


def recovery(set_up: SetUp, kind: Kind, tank: int, poured: float, definition: Definition) -> float:
    """Return how long tank 1 or 2 takes to be back after a pour [cm] into it, without noise [s].

    Examples
    --------
    >>> from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM
    >>> within_5_percent, _ = SCORES["recovery"]
    >>> few = recovery(MINIMUM, "decentralised", 1, 3.0, within_5_percent)
    >>> few < recovery(MINIMUM, "decentralised", 1, 12.0, within_5_percent)
    True
    """
    found = runs(set_up, kind, "percent", noise="none", poured=poured)
    (value,) = found.scored("recovery", tank, definition)
    return float(value)


def recoveries_in_words(set_up: SetUp, kind: Kind, tanks: tuple[int, ...], beside: str) -> str:
    """Return what pours of other sizes make of a recovery, to within either band.

    `beside` tells with what holes and lag they run, and without noise.
    """
    sizes = sorted((*OTHERS, POURED_LEVEL))
    told = []
    for definition in SCORES["recovery"]:
        within = definition.words.removeprefix("until back ").partition(" for good")[0]
        of_tanks = [
            f"tank {tank} "
            + listed([f"{recovery(set_up, kind, tank, size, definition):.3g}" for size in sizes])
            for tank in tanks
        ]
        told.append(f"{within} {', '.join(of_tanks)} s")
    return (
        f"It hangs on the pour, and mostly grows with it: after "
        f"{listed([f'{size:g}' for size in sizes])} cm it is, with {beside}, "
        f"{'; '.join(told)}."
    )


def other_pours(kind: Kind) -> dict[Reading | str, np.ndarray]:
    """Return the recoveries after each other pour, by words for it, [2, set-up, tank] [s].

    They stand there twice, as what they lie between.
    """
    found: dict[Reading | str, np.ndarray] = {}
    for poured, definition in product(OTHERS, SCORES["recovery"]):
        values = [
            recovery(set_up, kind, tank, poured, definition)
            for set_up, tank in product(SET_UPS, _TANKS)
        ]
        words = f"{poured:g} cm poured, without noise, taken {definition}"
        found[words] = np.tile(np.reshape(values, (2, 2)), (2, 1, 1))
    return found


#: What claims about recoveries are judged by beside the other readings.
POURS_IN_WORDS = (
    f"{POURED_LEVEL:g} cm poured, or without noise {listed([f'{size:g}' for size in OTHERS])} cm"
)
