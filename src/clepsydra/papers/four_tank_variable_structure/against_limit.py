"""The filling of Figs. 3 to 6, by conventional and by variable-structure PID."""

from __future__ import annotations

from clepsydra.papers.contest import Contest, Contests
from clepsydra.papers.four_tank_variable_structure.readings import COMPARED
from clepsydra.papers.four_tank_variable_structure.rig import (
    DURATION,
    IN_WORDS,
    TARGET,
    VOLTS_PER_METRE,
    WAYS,
    at_target,
    in_nu,
    in_volts,
)

WORDS = (
    "Empty tanks are filled to the levels of the figures. The document prints no settings: its "
    f"controllers have those of Johansson, from whom it takes the tanks ({IN_WORDS}), after "
    "decoupling by (9), on ν, and without it, on the voltages."
)


def contests() -> Contests:
    """Return the filling."""
    return {"Every 50 ms": _contest}


def _contest() -> Contest:
    published = {
        f"PI on {of}, {WAYS[way]}": made(way)
        for of, made in (("ν", in_nu), ("voltages", in_volts))
        for way in COMPARED
    }
    targets = {f"level_{j}": VOLTS_PER_METRE * level for j, level in enumerate(TARGET, start=1)}
    return Contest(at_target(), targets, DURATION, published, empty=True)
