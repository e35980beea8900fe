"""What stands between a signal and the terms of a loop: filters, and shapes of the error."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca


def gap_error(error: ca.SX, gap: ca.SX, gap_gain: ca.SX) -> ca.SX:
    """Return the error, which acts by a share only within a gap around the setpoint.

    g e for |e| ≤ γ, and e − (1 − g) γ sign(e) beyond, so that it has no jump.

    `error`, `gap`: e and γ [measurement unit]; `gap_gain`: g [1], 0 for a dead zone.

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

    `error`, `scale`: [measurement unit]; at |e| = scale the gain is the nominal one. A scale that
    is not above zero leaves the error as it is.

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


class FilteredDerivative(NamedTuple):
    """A derivative and the next value of the filtered signal that it keeps.

    `rate` [signal unit / s]; `filtered` [signal unit].
    """

    rate: ca.SX
    filtered: ca.SX


def filtered_derivative(
    signal: ca.SX, filtered: ca.SX, filter_time: ca.SX, time_step: ca.SX
) -> FilteredDerivative:
    """Return the derivative of a signal behind a first-order filter, s/(1 + s Tf).

    Backward differences: x_f⁺ = x_f + Δt/(Tf + Δt) (x − x_f), and the rate is
    (x − x_f)/(Tf + Δt), which is defined for a filter time of zero too.

    `signal`, `filtered`: x, and x_f after the last sample [signal unit]; `filter_time`,
    `time_step`: Tf at or above zero and Δt above zero [s].

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 13.

    Examples
    --------
    Without a filter it is the difference quotient:

    >>> found = filtered_derivative(ca.DM(5.0), ca.DM(3.0), ca.DM(0.0), ca.DM(0.5))
    >>> float(found.rate), float(found.filtered)
    (4.0, 5.0)
    """
    rate = (signal - filtered) / (filter_time + time_step)
    return FilteredDerivative(rate, filtered + time_step * rate)
