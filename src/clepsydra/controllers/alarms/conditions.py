"""Alarms on a measurement, on its deviation from the setpoint, and on its rate of change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.alarms.timing import ACTIVE, DELAYS, KEPT, ROUNDING, WATCHED, timed
from clepsydra.controllers.blocks.filters import filtered_derivative
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, value_or_zero
from clepsydra.controllers.signals import GOOD, PV, SP, amount, signed
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

LIMIT = signed("limit", "{measurement}", "alarm limit of {measurement}")
DEADBAND = amount(
    "deadband", "{measurement}", "how far {measurement} comes back before the alarm returns"
)
RATE_LIMIT = amount("limit", "{measurement}/s", "alarm limit of the rate of {measurement}")
RATE_DEADBAND = amount(
    "deadband", "{measurement}/s", "how far the rate comes back before the alarm returns"
)
FILTER_TIME = amount("filter_time", "s", "time of the filter of the rate")
_ASKED = (LIMIT.port, DEADBAND.port, *DELAYS)


def _beyond(s: Symbols, value: ca.SX) -> ca.SX:
    """Return whether a value is at the limit or above; in alarm, whether it has not come back.

    A limit or a deadband that is no number is passed by whatever value: that is to be seen.
    """
    return ca.logic_not(value < s["limit"] - ca.if_else(s["was_active"], s["deadband"], 0))


def _high(s: Symbols) -> Equations:
    return timed(s, _beyond(s, s["pv"]), ca.logic_and(s["good"], is_number(s["pv"])))


def _low(s: Symbols) -> Equations:
    back = s["limit"] + ca.if_else(s["was_active"], s["deadband"], 0)
    present = ca.logic_not(s["pv"] > back)
    return timed(s, present, ca.logic_and(s["good"], is_number(s["pv"])))


def _deviation(s: Symbols) -> Equations:
    known = all_of([s["good"], is_number(s["pv"]), is_number(s["sp"])])
    deviation = ca.fabs(s["pv"] - s["sp"])
    found = timed(s, _beyond(s, deviation), known)
    return replace(found, intermediates={"deviation": deviation, **found.intermediates})


def _rate(s: Symbols) -> Equations:
    known = ca.logic_and(s["good"], is_number(s["pv"]))
    timely = ca.logic_and(known, is_time_step(s["time_step"]))
    value, measured = value_or_zero(s["pv"], known), s["measured"]
    step = ca.if_else(is_time_step(s["time_step"]), s["time_step"], 1)
    before = ca.if_else(measured, s["filtered"], value)
    moved = filtered_derivative(value, before, s["filter_time"], step)
    rate = ca.fabs(moved.rate)
    found = timed(s, _beyond(s, rate), known)
    state = {
        "measured": ca.logic_or(measured, timely),
        "filtered": ca.if_else(timely, moved.filtered, s["filtered"]),
        **found.next_state,
    }
    return replace(found, next_state=state, intermediates={"rate": rate, **found.intermediates})


def _block(
    name: str,
    words: str,
    equations: Callable[[Symbols], Equations],
    further: tuple[Signal, ...] = (),
    asked: tuple[Signal, ...] = _ASKED,
    state: tuple[Signal, ...] = (),
) -> Block:
    inputs = (PV.port, GOOD.port, *further, *asked)
    return Block(name, inputs, (*state, *KEPT), (ACTIVE, WATCHED), equations, (words,), (ROUNDING,))


@cache
def high_alarm() -> Block:
    """Return the block of an alarm at a limit and above, high or high-high.

    References
    ----------
    ANSI/ISA-18.2-2016, Management of Alarm Systems for the Process Industries; IEC 62682.

    Examples
    --------
    At 8.1 above a limit of 8, and at 7.9 within the deadband of 0.2:

    >>> kept = {"pending": ca.DM(0), "pending_time": ca.DM(0)}
    >>> given = dict(good=1, limit=8, deadband=0.2, on_delay=0, off_delay=0, time_step=1)
    >>> for pv, active in ((8.1, 0), (7.9, 1), (7.7, 1)):
    ...     inputs = {name: ca.DM(value) for name, value in {**given, "pv": pv}.items()}
    ...     found = high_alarm()("level_1_high", inputs, {**kept, "was_active": ca.DM(active)})
    ...     print(pv, bool(found.outputs["active"]))
    8.1 True
    7.9 True
    7.7 False
    """
    return _block("high_alarm", "Alarm where a measurement is at a limit or above.", _high)


@cache
def low_alarm() -> Block:
    """Return the block of an alarm at a limit and below, low or low-low."""
    return _block("low_alarm", "Alarm where a measurement is at a limit or below.", _low)


@cache
def deviation_alarm() -> Block:
    """Return the block of an alarm on how far a measurement is from its setpoint, on either side.

    Examples
    --------
    >>> given = dict(pv=4, good=1, sp=5.5, limit=1, deadband=0, on_delay=0, off_delay=0,
    ...              time_step=1)
    >>> kept = dict.fromkeys(["was_active", "pending", "pending_time"], ca.DM(0))
    >>> found = deviation_alarm()("level_1_deviation",
    ...                           {name: ca.DM(value) for name, value in given.items()}, kept)
    >>> float(found.intermediates["deviation"]), bool(found.outputs["active"])
    (1.5, True)
    """
    words = "Alarm where a measurement is as far from its setpoint as a limit, or farther."
    return _block("deviation_alarm", words, _deviation, (SP.port,))


@cache
def rate_alarm() -> Block:
    """Return the block of an alarm on how fast a measurement changes, up or down.

    The rate is that of the measurement behind a filter of first order, by backward differences;
    without a filter time it is the difference of two scans over the time between them.
    """
    asked = (RATE_LIMIT.port, RATE_DEADBAND.port, *DELAYS, FILTER_TIME.port)
    state = (
        truth("measured", "there was a measurement"),
        Signal("filtered", description="the measurement behind the filter"),
    )
    words = "Alarm where a measurement changes as fast as a limit, or faster."
    return _block("rate_alarm", words, _rate, asked=asked, state=state)
