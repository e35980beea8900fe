"""Section 5: whether the response is faster, by settling and by rise."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.papers.comparison import remark
from clepsydra.papers.four_tank_variable_structure.decoupled import (
    DECOUPLED_READINGS,
    IN_VOLTS,
    LIMITS,
    READING,
    DecoupledReading,
    at_limit,
    decoupled,
    ranges,
    sooner,
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


def _later(one: float, other: float) -> bool:
    return sooner(other, one)


def _compared(
    reading: DecoupledReading, what: str, compares: Callable[[float, float], bool]
) -> np.ndarray:
    """Return where a time of variable structure compares so, [limits, 2], h1 and h2."""
    new, old = (getattr(run, what) for run in _pair(reading))
    return np.array(
        [
            [compares(new(tank, lane), old(tank, lane)) for tank in _TANKS]
            for lane in range(len(LIMITS))
        ]
    )


def _where(reading: DecoupledReading, what: str, compares: Callable[[float, float], bool]) -> str:
    """Return the limits at which a time of variable structure compares so for both levels."""
    return ranges(np.all(_compared(reading, what, compares), axis=1))


def _settling() -> Row:
    new, old = _pair(DECOUPLED_READINGS[0])
    usual = at_limit(USUAL.limit)
    told = "; ".join(
        f"{reading}: {_where(reading, 'settling', sooner)} V" for reading in DECOUPLED_READINGS
    )
    first = _compared(DECOUPLED_READINGS[0], "settling", sooner)
    in_nu = [each for each in DECOUPLED_READINGS if each.alpha_on == "virtual"]
    assert not any(_compared(each, "settling", _later).any() for each in in_nu)
    free = [old.voltage(pump, at_limit(20.0)).max() for pump in (1, 2)]
    plain, limited = filled("variable_structure"), filled(CONVENTIONAL)
    count = sum(
        all(sooner(plain.settling(tank, lane), limited.settling(tank, lane)) for tank in _TANKS)
        for lane in range(len(READINGS))
    )
    lane = READINGS.index(USUAL)
    return remark(
        "section 5",
        "settling time",
        _CLAIM,
        f"{both(new, 'settling', '.0f', usual)} against {both(old, 'settling', '.0f', usual)}",
        "s",
        reason=f"h1 and h2 to 2 %. {READING} Limits from 4 to 20 V at which both settle sooner, by "
        f"a sampling period or more: {told}. With 0.5 V/cm the pumps ask for {free[0]:.1f} and "
        f"{free[1]:.1f} V at the most, so that h1 alone settles sooner at "
        f"{ranges(first[:, 0] & ~first[:, 1])} V, and above nothing saturates: no counter-example. "
        "So with α in ν neither level settles later at any limit; with α in volts it hangs on the "
        f"gain. {IN_VOLTS} {UNDECOUPLED} both settle sooner in {count} of {len(READINGS)} "
        f"readings ({OTHERS}), with {USUAL} in {both(plain, 'settling', '.0f', lane)} after "
        f"{both(limited, 'settling', '.0f', lane)} s.",
    )


def _rise() -> Row:
    new, old = _pair(DECOUPLED_READINGS[0])
    usual = at_limit(USUAL.limit)
    slower = _where(DECOUPLED_READINGS[0], "rise", _later)
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
