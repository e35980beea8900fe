"""The six designs on the true chain, with the inflow between the limits of the catalogue."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.papers.contest import Contest, Contests
from clepsydra.papers.eight_tanks.six_designs import SIX, chain, designed

#: Ours: what 0.04 m³/min, the document's standard deviation of the inflow, makes of the level [m].
STEP = 0.123
_DURATION = 4.0 * 3600.0  # [s]
WORDS = (
    "The six Smith predictors of section 6 on the true chain of eight tanks, with the printed "
    "gain. The document names no size of a step and no limit of the inflow: both are ours, and "
    "none of its designs meets the limit."
)


def contests() -> Contests:
    """Return the setpoint step of section 6."""
    return {"Every minute": _contest}


def _contest() -> Contest:
    point = chain().operating_point
    (feed,) = point.process.inputs
    limits = {"feed.low_limit": feed.low, "feed.high_limit": feed.high}
    published = {}
    for choice in SIX:
        free = designed(choice.penalty, (choice.pole,))
        published[f"{choice.figure}, {choice.label}"] = replace(free, values=free.values | limits)
    targets = {"level_8": point.as_dict()["level_8"] + STEP}
    return Contest(chain(), targets, _DURATION, published)
