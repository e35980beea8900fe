"""Section 5: whether the response is faster, by settling and by rise."""

from __future__ import annotations

import operator
from collections.abc import Callable

import numpy as np

from clepsydra.papers.comparison import remark
from clepsydra.papers.four_tank_variable_structure.decoupled import (
    DECOUPLED_READINGS,
    LIMITS,
    READING,
    DecoupledReading,
    at_limit,
    decoupled,
    ranges,
)
from clepsydra.papers.four_tank_variable_structure.readings import (
    CONVENTIONAL,
    OTHERS,
    READINGS,
    UNDECOUPLED,
    USUAL,
    both,
    filled,
    saturating,
)
from clepsydra.papers.four_tank_variable_structure.rig import Filling
from clepsydra.papers.row import Row

_CLAIM = "in the process of the steady state …, the response … is faster"
_TANKS = (1, 2)


def speed() -> list[Row]:
    """Compare settling and rise of both lower levels, after decoupling and without."""
    return [_settling(), _rise()]


def _pair(reading: DecoupledReading) -> tuple[Filling, Filling]:
    return decoupled("variable_structure", reading), decoupled(CONVENTIONAL, reading)


def _where(reading: DecoupledReading, what: str, compares: Callable[[float, float], bool]) -> str:
    """Return the limits at which a time of variable structure compares so for both levels."""
    new, old = (getattr(run, what) for run in _pair(reading))
    holds = [
        all(compares(new(tank, lane), old(tank, lane)) for tank in _TANKS)
        for lane in range(len(LIMITS))
    ]
    return ranges(np.array(holds))


def _settling() -> Row:
    new, old = _pair(DECOUPLED_READINGS[0])
    usual = at_limit(USUAL.limit)
    told = "; ".join(
        f"{reading}: {_where(reading, 'settling', operator.lt)} V" for reading in DECOUPLED_READINGS
    )
    same = _where(DECOUPLED_READINGS[0], "settling", operator.eq)
    plain, limited = filled("variable_structure"), filled(CONVENTIONAL)
    sooner = sum(
        all(plain.settling(tank, lane) < limited.settling(tank, lane) for tank in _TANKS)
        for lane in range(len(READINGS))
    )
    lane = READINGS.index(USUAL)
    return remark(
        "section 5",
        "settling time",
        _CLAIM,
        f"{both(new, 'settling', '.0f', usual)} against {both(old, 'settling', '.0f', usual)}",
        "s",
        reason=f"h1 and h2 to 2 %. {READING} Limits from 4 to 20 V at which both settle sooner: "
        f"{told}. At {same} V with 0.5 V/cm no pump saturates and both are the same, which is no "
        "counter-example. So it holds at every limit with α in ν, and hangs on the gain with α in "
        f"volts. {UNDECOUPLED} both settle sooner in {sooner} of {len(READINGS)} readings "
        f"({OTHERS}), with {USUAL} in {both(plain, 'settling', '.0f', lane)} after "
        f"{both(limited, 'settling', '.0f', lane)} s.",
    )


def _rise() -> Row:
    new, old = _pair(DECOUPLED_READINGS[0])
    usual = at_limit(USUAL.limit)
    slower = _where(DECOUPLED_READINGS[0], "rise", operator.gt)
    lanes = saturating()
    plain, limited = filled("variable_structure"), filled(CONVENTIONAL)
    later = sum(
        all(plain.rise(tank, lane) > limited.rise(tank, lane) for tank in _TANKS) for lane in lanes
    )
    return remark(
        "section 5",
        "rise time",
        _CLAIM,
        f"{both(new, 'rise', '.1f', usual)} against {both(old, 'rise', '.1f', usual)}",
        "s",
        reason="h1 and h2 from 10 to 90 %, before the process that the sentence names: while a "
        "pump saturates the integral is taken back, so that it leaves its limit early and the "
        f"level rises slower. {READING} So it is with limits of {slower} V. The integrals of the "
        f"absolute error are {both(new, 'absolute_error', '.0f', usual)} against "
        f"{both(old, 'absolute_error', '.0f', usual)} cm s. {UNDECOUPLED} it is slower in {later} "
        f"of {len(lanes)} readings in which the pumps saturate.",
    )
