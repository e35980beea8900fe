"""Anti-windup: what an integrator does while what it asks for is not what is applied."""

from __future__ import annotations

from typing import Literal, get_args

import casadi as ca

from clepsydra.base.arguments import check_choice
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.validity import time_step_of
from clepsydra.controllers.blocks.variable_structure import (
    cut_off,
    share_of_excess,
    variable_structure,
)
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


def check_anti_windup(anti_windup: str) -> None:
    """Refuse a name that stands for no way of anti-windup.

    Raises
    ------
    InputError
    """
    check_choice("anti_windup", anti_windup, get_args(AntiWindup))


def next_in_force(anti_windup: str, s: Symbols, limited: ca.SX) -> ca.SX:
    """Return the next integral of what had its say, under one way of anti-windup.

    Parameters
    ----------
    anti_windup : str
        One of `IN_WORDS`.
    s : mapping
        integral_used in this sample, proportional (the rest of what is asked for) and increment,
        in the unit of the output; low_limit, high_limit, time_step [s], and tracking_time [s] or
        saturation_rate [1/s], where the anti-windup needs them. For variable structure also cut,
        whether something is cut off, and middle, where the limits alone do not tell.
    limited : casadi.SX
        What was applied.

    Examples
    --------
    Asked for 12 where 10 is the limit, with an error that asks for still more:

    >>> given = dict(integral_used=7, proportional=5, increment=1)
    >>> s = {name: ca.DM(value) for name, value in given.items()}
    >>> float(next_in_force("conditional_integration", s, ca.DM(10)))
    7.0
    """
    integral, increment = s["integral_used"], s["increment"]
    asked = integral, increment, s["proportional"] + integral, limited
    if anti_windup == "none":
        return integral + increment
    if anti_windup == "clamping":
        return clamping(integral, increment, s["low_limit"], s["high_limit"])
    if anti_windup == "conditional_integration":
        return conditional_integration(*asked)
    time_step, _ = time_step_of(s)
    if anti_windup == "back_calculation":
        return back_calculation(*asked, tracking_share(time_step, s["tracking_time"]))
    low, high = s["low_limit"], s["high_limit"]
    cut = s["cut"] if "cut" in s else cut_off(*asked[2:], low, high)
    middle = s["middle"] if "middle" in s else 0.5 * (low + high)
    return variable_structure(*asked, cut, middle, share_of_excess(s["saturation_rate"], time_step))


def conditional_integration(
    integral: ca.SX, increment: ca.SX, unlimited: ca.SX, limited: ca.SX
) -> ca.SX:
    """Return the next integral by conditional integration.

    An increment that pushes further into saturation, (unlimited − limited)·increment > 0,
    is left out; all others are taken.

    Parameters
    ----------
    integral, increment, unlimited, limited : casadi.SX
        In the unit of the output.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3.

    Examples
    --------
    >>> numbers = ca.DM(3.0), ca.DM(0.5), ca.DM(12.0), ca.DM(10.0)
    >>> float(conditional_integration(*numbers))
    3.0
    """
    pushes_further = (unlimited - limited) * increment > 0
    return ca.if_else(pushes_further, integral, integral + increment)


def back_calculation(
    integral: ca.SX, increment: ca.SX, unlimited: ca.SX, limited: ca.SX, share: ca.SX
) -> ca.SX:
    """Return the next integral by back-calculation: I + ΔI + share·(limited − unlimited).

    Parameters
    ----------
    integral, increment, unlimited, limited : casadi.SX
        In the unit of the output.
    share : casadi.SX
        Share of the excess that is taken back in one sample, time step / tracking time, [1].

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3.

    Examples
    --------
    >>> numbers = ca.DM(3.0), ca.DM(0.5), ca.DM(12.0), ca.DM(10.0), ca.DM(0.25)
    >>> float(back_calculation(*numbers))
    3.0
    """
    return integral + increment + share * (limited - unlimited)


def clamping(integral: ca.SX, increment: ca.SX, low: ca.SX, high: ca.SX) -> ca.SX:
    """Return the next integral, which does not leave the limits of what it moves.

    Many a vendor's block does this. (Some tools call conditional integration clamping.) An
    integral that a change of mode or gain put beyond a limit only comes back from there, so
    that the change stays without a bump.

    Parameters
    ----------
    integral, increment, low, high : casadi.SX
        In the unit of the output.

    References
    ----------
    A. Visioli, Practical PID Control, Springer 2006, chapter 3,
    doi 10.1007/1-84628-586-0_3.

    Examples
    --------
    >>> float(clamping(ca.DM(9.8), ca.DM(0.5), ca.DM(0.0), ca.DM(10.0)))
    10.0
    """
    return limit(integral + increment, ca.fmin(low, integral), ca.fmax(high, integral))


def tracking_share(time_step: ca.SX, tracking_time: ca.SX) -> ca.SX:
    """Return min(time step / tracking time, 1): a share above one would overshoot the limit.

    Parameters
    ----------
    time_step, tracking_time : casadi.SX
        [s]; the time step is above zero, so that nothing is divided by zero.

    Examples
    --------
    >>> float(tracking_share(ca.DM(1.0), ca.DM(4.0))), float(tracking_share(ca.DM(9.0), ca.DM(4.0)))
    (0.25, 1.0)
    """
    return time_step / ca.fmax(tracking_time, time_step)
