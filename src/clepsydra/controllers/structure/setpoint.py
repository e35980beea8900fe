"""Where a loop takes its setpoint from, and how fast it follows it."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.validity import is_number, value_or_zero


@dataclass(frozen=True)
class Setpoint:
    """The setpoint of a loop in this sample.

    Parameters
    ----------
    value : casadi.SX
        Always a number.
    valid : casadi.SX
        Whether the chosen source gave one.
    remote : casadi.SX
        Whether another block or the host computer gives it.
    switched : casadi.SX
        Whether the source changed since the last sample.
    """

    value: ca.SX
    valid: ca.SX
    remote: ca.SX
    switched: ca.SX


def operator_setpoint(raw: ca.SX) -> Setpoint:
    """Return the one setpoint of a simple loop."""
    valid = is_number(raw)
    return Setpoint(value_or_zero(raw, valid), valid, ca.SX(0), ca.SX(0))


def chosen_setpoint(
    local: ca.SX, remote: Asked, source: ca.SX, last_source: ca.SX, working: ca.SX
) -> Setpoint:
    """Return the setpoint of the chosen source; while that fails, the last one.

    Parameters
    ----------
    local : casadi.SX
        What the operator gives.
    remote : Asked
        What another block or the host computer gives.
    source, last_source : casadi.SX
        0 local, 1 remote; now and in the last sample.
    working : casadi.SX
        The setpoint of the last sample.
    """
    is_remote = source == 1
    value = ca.if_else(is_remote, remote.asked, local)
    valid = ca.if_else(
        is_remote, ca.logic_and(remote.usable, is_number(remote.asked)), is_number(local)
    )
    return Setpoint(ca.if_else(valid, value, working), valid, is_remote, source != last_source)


def ramped(value: ca.SX, working: ca.SX, largest_rate: ca.SX, time_step: ca.SX) -> ca.SX:
    """Return a setpoint that moves from the last one no faster than its largest rate.

    Parameters
    ----------
    value, working : casadi.SX
        The setpoint asked for, and that of the last sample [measurement unit].
    largest_rate : casadi.SX
        [measurement unit / s]
    time_step : casadi.SX
        [s]

    Examples
    --------
    >>> float(ramped(ca.DM(5.0), ca.DM(3.0), ca.DM(0.5), ca.DM(2.0)))
    4.0
    """
    step = ca.fmax(largest_rate, 0) * time_step  # a rate below zero would turn the limits round
    return limit(value, working - step, working + step)
