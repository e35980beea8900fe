"""A lead-lag element."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca


class LeadLag(NamedTuple):
    """The output of a lead-lag element, and its state.

    Parameters
    ----------
    value, lagged : casadi.SX
        [signal unit]
    """

    value: ca.SX
    lagged: ca.SX


def lead_lag(signal: ca.SX, lagged: ca.SX, lead: ca.SX, lag: ca.SX, time_step: ca.SX) -> LeadLag:
    """Return (1 + lead s)/(1 + lag s) of a signal, by backward differences.

    z⁺ = z + Δt/(Tlag + Δt) (x − z), and the output is z⁺ + Tlead (x − z)/(Tlag + Δt). Times at
    or below zero count as zero; a lead without lag is the difference quotient.

    Parameters
    ----------
    signal, lagged : casadi.SX
        x, and z after the last sample [signal unit].
    lead, lag, time_step : casadi.SX
        [s], the time step above zero.

    Examples
    --------
    Equal lead and lag cancel, whatever the signal did before:

    >>> found = lead_lag(ca.DM(5.0), ca.DM(2.0), ca.DM(30.0), ca.DM(30.0), ca.DM(1.0))
    >>> round(float(found.value), 12)
    5.0
    """
    rate = (signal - lagged) / (ca.fmax(0, lag) + time_step)
    following = lagged + time_step * rate
    return LeadLag(following + ca.fmax(0, lead) * rate, following)
