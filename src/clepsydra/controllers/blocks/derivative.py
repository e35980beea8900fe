"""The filtered derivative of a signal."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca


class FilteredDerivative(NamedTuple):
    """A derivative and the next value of the filtered signal that it keeps.

    Parameters
    ----------
    rate : casadi.SX
        [signal unit / s]
    filtered : casadi.SX
        [signal unit]
    """

    rate: ca.SX
    filtered: ca.SX


def filtered_derivative(
    signal: ca.SX, filtered: ca.SX, filter_time: ca.SX, time_step: ca.SX
) -> FilteredDerivative:
    """Return the derivative of a signal behind a first-order filter, s/(1 + s Tf).

    Backward differences: x_f⁺ = x_f + Δt/(Tf + Δt) (x − x_f), and the rate is
    (x − x_f)/(Tf + Δt), which is defined for a filter time of zero too.

    Parameters
    ----------
    signal, filtered : casadi.SX
        x, and x_f after the last sample [signal unit].
    filter_time, time_step : casadi.SX
        Tf at or above zero and Δt above zero [s].

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
