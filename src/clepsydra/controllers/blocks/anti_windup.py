"""Anti-windup: what an integrator does while its output is limited."""

from __future__ import annotations

from typing import Literal, get_args

import casadi as ca

from clepsydra.base.errors import InputError

AntiWindup = Literal["back_calculation", "conditional_integration"]


def check_anti_windup(anti_windup: str) -> None:
    """Refuse a name that stands for no way of anti-windup.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_anti_windup("none")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: anti_windup: got 'none', expected one of back_calculation, \
conditional_integration; correct the name.
    """
    known = get_args(AntiWindup)
    if anti_windup not in known:
        raise InputError(
            "anti_windup", anti_windup, f"one of {', '.join(known)}", "correct the name"
        )


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
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, section 3.5.

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
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, section 3.5.

    Examples
    --------
    >>> numbers = ca.DM(3.0), ca.DM(0.5), ca.DM(12.0), ca.DM(10.0), ca.DM(0.25)
    >>> float(back_calculation(*numbers))
    3.0
    """
    return integral + increment + share * (limited - unlimited)


def tracking_share(time_step: ca.SX, tracking_time: ca.SX) -> ca.SX:
    """Return min(time step / tracking time, 1): a share above one would overshoot the limit.

    Parameters
    ----------
    time_step, tracking_time : casadi.SX
        [s]

    Examples
    --------
    >>> float(tracking_share(ca.DM(1.0), ca.DM(4.0))), float(tracking_share(ca.DM(9.0), ca.DM(4.0)))
    (0.25, 1.0)
    """
    return ca.fmin(1, time_step / tracking_time)
