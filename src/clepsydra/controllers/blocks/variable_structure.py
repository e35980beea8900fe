"""Variable-structure anti-windup: an integral that lets the excess die away while it saturates."""

from __future__ import annotations

import casadi as ca

#: So close to a limit, as a share of the range, an output counts as cut off there. An integral
#: that is taken up at a limit asks for that limit but for rounding, which must decide nothing;
#: in single precision this is some hundred roundings.
_AT_LIMIT = 1e-5


def cut_off(asked: ca.SX, applied: ca.SX, low: ca.SX, high: ca.SX) -> ca.SX:
    """Return whether an output is not what was asked for, or stands at a limit.

    Parameters
    ----------
    asked, applied, low, high : casadi.SX
        In the unit of the output.

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

    u_n ≠ u_s and e (u_n − ū) > 0, with ū half-way between the limits. The increment has the
    sign of the error times that of the gain, so that it holds for gains of either sign.

    Parameters
    ----------
    increment, unlimited, middle : casadi.SX
        Δt K/Ti e, u_n and ū, in one unit.
    cut : casadi.SX
        Whether u_n ≠ u_s, see `cut_off`.

    Examples
    --------
    Asked for 12 where 10 is the limit and 5 the middle, with the error pushing up, then down:

    >>> at = ca.DM(12.0), ca.DM(1), ca.DM(5.0)
    >>> bool(winds_up(ca.DM(0.1), *at)), bool(winds_up(ca.DM(-0.1), *at))
    (True, False)
    """
    return ca.logic_and(cut, increment * (unlimited - middle) > 0)


def variable_structure(
    integral: ca.SX,
    increment: ca.SX,
    unlimited: ca.SX,
    limited: ca.SX,
    cut: ca.SX,
    middle: ca.SX,
    share: ca.SX,
) -> ca.SX:
    """Return the next integral by the variable-structure rule.

    While it winds up (`winds_up`) the integral takes nothing of the error and gives back
    α Δt (u_n − u_s), so that the excess dies away with the rate α; else it integrates as ever.

    Parameters
    ----------
    integral, increment, unlimited, limited, middle : casadi.SX
        I, Δt K/Ti e, u_n, u_s and ū, in one unit.
    cut : casadi.SX
        Whether u_n ≠ u_s, see `cut_off`.
    share : casadi.SX
        α Δt, at most 1 [1].

    References
    ----------
    A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent integrator windup,
    IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451, doi 10.1109/41.915424.

    Examples
    --------
    >>> numbers = [ca.DM(value) for value in (7.0, 0.1, 12.0, 10.0, 1, 5.0, 0.25)]
    >>> float(variable_structure(*numbers))
    6.5
    """
    winds = winds_up(increment, unlimited, cut, middle)
    return ca.if_else(winds, integral - share * (unlimited - limited), integral + increment)


def share_of_excess(rate: ca.SX, time_step: ca.SX) -> ca.SX:
    """Return min(α Δt, 1): more than the excess would overshoot the limit.

    Parameters
    ----------
    rate, time_step : casadi.SX
        α [1/s] and Δt [s].

    Examples
    --------
    >>> [float(share_of_excess(ca.DM(0.5), ca.DM(step))) for step in (1.0, 4.0)]
    [0.5, 1.0]
    """
    return ca.fmin(rate * time_step, 1)
