"""Integrals: how they go on while what they ask for is not what is applied (anti-windup)."""

from __future__ import annotations

from typing import Literal

import casadi as ca

from clepsydra.controllers.blocks.ports import Applied
from clepsydra.controllers.blocks.validity import is_number, limit, time_step_of
from clepsydra.program.step_law import Symbols

AntiWindup = Literal["back_calculation", "conditional_integration", "clamping", "none"]

#: What a reader is told of each.
IN_WORDS: dict[str, str] = {
    "back_calculation": "back-calculation: the integral follows what was applied",
    "conditional_integration": "conditional integration: stops where it would push on into a limit",
    "clamping": "clamping: the integral is kept within the output's limits",
    "variable_structure": "variable structure: while the error pushes on into a limit, the "
    "integral lets the excess die away",
    "none": "none",
}
#: What the integral of each is called in the names of blocks.
WINDING_NAMES = {
    "back_calculation": "back_calculated",
    "conditional_integration": "conditional",
    "clamping": "clamped",
    "variable_structure": "variable_structure",
    "none": "free",
}
#: So close to a limit, as a share of the range, an output counts as cut off there. An integral
#: that is taken up at a limit asks for that limit but for rounding, which must decide nothing;
#: in single precision this is some hundred roundings.
_AT_LIMIT = 1e-5


def tracking_share(time_step: ca.SX, tracking_time: ca.SX) -> ca.SX:
    """Return min(time step / tracking time, 1): a share above one would overshoot the limit.

    Both are times [s], the time step above zero, so that nothing is divided by zero.

    Examples
    --------
    >>> float(tracking_share(ca.DM(1.0), ca.DM(4.0))), float(tracking_share(ca.DM(9.0), ca.DM(4.0)))
    (0.25, 1.0)
    """
    return time_step / ca.fmax(tracking_time, time_step)


def cut_off(asked: ca.SX, applied: ca.SX, low: ca.SX, high: ca.SX) -> ca.SX:
    """Return whether an output is not what was asked for, or stands at a limit.

    Examples
    --------
    >>> ends = ca.DM(0.0), ca.DM(10.0)
    >>> [bool(cut_off(ca.DM(u), ca.DM(min(u, 10.0)), *ends)) for u in (12.0, 10.0 - 1e-15, 9.0)]
    [True, True, False]
    """
    reach = _AT_LIMIT * (high - low)
    at_limit = ca.logic_or(asked <= low + reach, asked >= high - reach)
    return ca.logic_or(asked != applied, at_limit)


def winds_up(increment: ca.SX, unlimited: ca.SX, cut: ca.SX, middle: ca.SX) -> ca.SX:
    """Return whether what is asked for is cut off and the error pushes on, away from the middle.

    u_n ≠ u_s and e (u_n − ū) > 0, with ū half-way between the limits. The increment Δt K/Ti e has
    the sign of the error times that of the gain, so that it holds for gains of either sign.

    Examples
    --------
    Asked for 12 where 10 is the limit and 5 the middle, with the error pushing up, then down:

    >>> at = ca.DM(12.0), ca.DM(1), ca.DM(5.0)
    >>> bool(winds_up(ca.DM(0.1), *at)), bool(winds_up(ca.DM(-0.1), *at))
    (True, False)
    """
    return ca.logic_and(cut, increment * (unlimited - middle) > 0)


def next_in_force(anti_windup: str, s: Symbols, limited: ca.SX) -> ca.SX:
    """Return the next integral of what had its say, under one way of anti-windup.

    `anti_windup`: one of `IN_WORDS`; `s`: integral_used in this sample, proportional (the rest of
    what is asked for) and increment, in the unit of the output; low_limit, high_limit, time_step
    [s], and tracking_time [s] or saturation_rate [1/s], where the anti-windup needs them. For
    variable structure also cut, whether something is cut off, and middle, where the limits alone do
    not tell; `limited`: what was applied.

    References
    ----------
    Back-calculation and conditional integration: K. J. Åström and T. Hägglund, Advanced PID
    Control, ISA 2006, chapter 3. Clamping: A. Visioli, Practical PID Control, Springer 2006,
    chapter 3, doi 10.1007/1-84628-586-0_3 (some tools call conditional integration clamping).
    Variable structure: A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent
    integrator windup, IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451,
    doi 10.1109/41.915424.

    Examples
    --------
    Asked for 12 where 10 is the limit, with an error that asks for still more:

    >>> given = dict(integral_used=7, proportional=5, increment=1, tracking_time=4, time_step=1,
    ...              low_limit=0, high_limit=10, saturation_rate=0.25)
    >>> s = {name: ca.DM(value) for name, value in given.items()}
    >>> {way: float(next_in_force(way, s, ca.DM(10))) for way in IN_WORDS} == {
    ...     "back_calculation": 7.5, "conditional_integration": 7.0, "clamping": 8.0,
    ...     "variable_structure": 6.5, "none": 8.0}
    True
    """
    integral, increment = s["integral_used"], s["increment"]
    unlimited = s["proportional"] + integral
    if anti_windup == "none":
        return integral + increment
    if anti_windup == "clamping":
        # What a change of mode or gain put beyond a limit only comes back from there.
        low, high = ca.fmin(s["low_limit"], integral), ca.fmax(s["high_limit"], integral)
        return limit(integral + increment, low, high)
    if anti_windup == "conditional_integration":
        pushes_further = (unlimited - limited) * increment > 0
        return ca.if_else(pushes_further, integral, integral + increment)
    time_step, _ = time_step_of(s)
    if anti_windup == "back_calculation":
        share = tracking_share(time_step, s["tracking_time"])
        return integral + increment + share * (limited - unlimited)
    low, high = s["low_limit"], s["high_limit"]
    cut = s["cut"] if "cut" in s else cut_off(unlimited, limited, low, high)
    middle = s["middle"] if "middle" in s else 0.5 * (low + high)
    winds = winds_up(increment, unlimited, cut, middle)
    # More than the whole excess would overshoot the limit.
    share = ca.fmin(s["saturation_rate"] * time_step, 1)
    return ca.if_else(winds, integral - share * (unlimited - limited), integral + increment)


def next_integral(
    anti_windup: str, s: Symbols, applied: Applied, *, known: ca.SX, last_applied: ca.SX
) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return the integral of the next sample under one way of anti-windup, and names for it.

    Where the output had its say the integral takes its increment under the anti-windup rule.
    Where the actuator moved without it, it follows, so that automatic continues from there: it is
    what was applied less the rest; while that is unknown (a failed sensor) it moves with the
    output, which leaves the last known rest in force. Else it stays. It is always a number.

    `s`: as for `next_in_force`; `known`: whether the rest was computed from valid signals;
    `last_applied`: what was applied in the last sample.
    """
    before, output = s["integral_used"], applied.applied
    moved_on = before + (output - last_applied)
    followed = ca.if_else(known, output - s["proportional"], moved_on)
    elsewhere = ca.if_else(applied.follows, followed, before)
    following = next_in_force(anti_windup, s, output)
    if anti_windup == "variable_structure":
        following = ca.if_else(is_number(following), following, before + s["increment"])
    following = ca.if_else(applied.in_force, following, elsewhere)
    # An increment beyond the range of numbers is not taken.
    kept = ca.if_else(is_number(following), following, before)
    return kept, {"integral_moved": following, "integral_kept": kept}


def integral_words(anti_windup: str) -> dict[str, str]:
    """Return what a reader is told above the steps of an integral."""
    return {
        "integral_used": "integral, bumpless at a change of settings",
        "integral_moved": f"anti-windup, {IN_WORDS[anti_windup]}; in manual it tracks the output",
        "integral_kept": "not a number: ignored",
    }
