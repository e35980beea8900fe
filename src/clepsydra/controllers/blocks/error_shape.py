"""Nonlinear action on the error: a gap, and the squared error."""

from __future__ import annotations

import casadi as ca


def gap_error(error: ca.SX, gap: ca.SX, gap_gain: ca.SX) -> ca.SX:
    """Return the error, which acts by a share only within a gap around the setpoint.

    g e for |e| ≤ γ, and e − (1 − g) γ sign(e) beyond, so that it has no jump.

    Parameters
    ----------
    error, gap : casadi.SX
        e and γ [measurement unit].
    gap_gain : casadi.SX
        g [1], 0 for a dead zone.

    References
    ----------
    F. G. Shinskey, Process Control Systems, 4th edition, McGraw-Hill 1996, chapter 5.

    Examples
    --------
    >>> [round(float(gap_error(ca.DM(e), ca.DM(1.0), ca.DM(0.1))), 3) for e in (0.5, 1, 3, -3)]
    [0.05, 0.1, 2.1, -2.1]
    """
    inside = ca.fmin(gap, ca.fmax(-gap, error))
    return error - (1 - gap_gain) * inside


def squared_error(error: ca.SX, scale: ca.SX) -> ca.SX:
    """Return e |e| / scale: the gain grows with the error.

    Parameters
    ----------
    error, scale : casadi.SX
        [measurement unit]; at |e| = scale the gain is the nominal one. A scale that is not
        above zero leaves the error as it is.

    References
    ----------
    F. G. Shinskey, Process Control Systems, 4th edition, McGraw-Hill 1996, chapter 5.

    Examples
    --------
    >>> [float(squared_error(ca.DM(e), ca.DM(2.0))) for e in (1, 2, -4)]
    [0.5, 2.0, -8.0]
    """
    given = scale > 0
    return error * ca.if_else(given, ca.fabs(error) / ca.if_else(given, scale, 1), 1)
