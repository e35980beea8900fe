"""The integral of one output or loop, from one sample to the next."""

from __future__ import annotations

from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import (
    IN_WORDS,
    back_calculation,
    clamping,
    conditional_integration,
    tracking_share,
)
from clepsydra.controllers.blocks.handover import Applied
from clepsydra.controllers.blocks.mode import followed_integral
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.controllers.blocks.variable_structure import (
    cut_off,
    share_of_excess,
    variable_structure,
)
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_NAMES = {
    "back_calculation": "integral_back_calculated",
    "conditional_integration": "integral_conditional",
    "clamping": "integral_clamped",
    "variable_structure": "integral_variable_structure",
    "none": "integral_free",
}
#: `Applied`, as ports.
APPLIED = (
    Signal("applied", description="what was applied, as if asked for"),
    truth("in_force", "what was asked for had its say"),
    truth("follows", "the actuator moves without it, by hand or tracking"),
)
#: What it needs beside the values of the sample.
_LIMITS = Signal("low_limit"), Signal("high_limit")
_OWN_PORTS = {
    "back_calculation": (Signal("time_step", "s"), Signal("tracking_time", "s")),
    "clamping": _LIMITS,
    "variable_structure": (*_LIMITS, Signal("time_step", "s"), Signal("saturation_rate", "1/s")),
}


@cache
def integral(anti_windup: str) -> Block:
    """Return the block of an integral under one way of anti-windup.

    Where the output had its say the integral takes its increment under the anti-windup rule;
    where the actuator moved without it, it follows, so that automatic continues from there;
    else it stays. It is always a number.

    Parameters
    ----------
    anti_windup : {"back_calculation", "conditional_integration", "clamping", \
"variable_structure", "none"}

    Examples
    --------
    Asked for 12 where 10 is the limit, with an error that asks for still more:

    >>> values = dict(integral=7, proportional=5, increment=1, known=1, applied=10, in_force=1,
    ...               follows=0, last_applied=0)
    >>> given = {name: ca.DM(value) for name, value in values.items()}
    >>> float(integral("conditional_integration")("integral", given, {}).outputs["following"])
    7.0
    """
    return Block(
        _NAMES[anti_windup],
        (
            Signal("integral", description="as used in this sample, in the unit of the output"),
            Signal("proportional", description="the rest of what is asked for"),
            Signal("increment", description="what it gains in automatic"),
            truth("known", "the rest was computed from valid signals"),
            *APPLIED,
            Signal("last_applied", description="what was applied in the last sample"),
            *_OWN_PORTS.get(anti_windup, ()),
        ),
        (),
        (Signal("following", description="the integral of the next sample"),),
        lambda s: _equations(s, anti_windup),
        (IN_WORDS[anti_windup],),
    )


def applied_ports(applied: Applied) -> Symbols:
    """Return what became of what was asked for, as ports of `integral`.

    Examples
    --------
    >>> list(applied_ports(Applied(ca.SX(3), ca.SX(1), ca.SX(0))))
    ['applied', 'in_force', 'follows']
    """
    values = applied.value, applied.in_force, applied.follows
    return {signal.name: value for signal, value in zip(APPLIED, values, strict=True)}


def _equations(s: Symbols, anti_windup: str) -> Equations:
    followed = followed_integral(
        s["integral"], s["applied"], s["last_applied"], s["proportional"], s["known"]
    )
    elsewhere = ca.if_else(s["follows"], followed, s["integral"])
    following = ca.if_else(s["in_force"], _in_force(s, anti_windup), elsewhere)
    # An increment beyond the range of numbers is not taken.
    return Equations({}, {"following": ca.if_else(is_number(following), following, s["integral"])})


def _in_force(s: Symbols, anti_windup: str) -> ca.SX:
    before, increment = s["integral"], s["increment"]
    unlimited = s["proportional"] + before
    if anti_windup == "conditional_integration":
        return conditional_integration(before, increment, unlimited, s["applied"])
    if anti_windup == "clamping":
        return clamping(before, increment, s["low_limit"], s["high_limit"])
    if anti_windup == "none":
        return before + increment
    step = ca.if_else(is_time_step(s["time_step"]), s["time_step"], 1)
    if anti_windup == "variable_structure":
        low, high = s["low_limit"], s["high_limit"]
        cut = cut_off(unlimited, s["applied"], low, high)
        share = share_of_excess(s["saturation_rate"], step)
        found = variable_structure(
            before, increment, unlimited, s["applied"], cut, 0.5 * (low + high), share
        )
        return ca.if_else(is_number(found), found, before + increment)
    share = tracking_share(step, s["tracking_time"])
    return back_calculation(before, increment, unlimited, s["applied"], share)
