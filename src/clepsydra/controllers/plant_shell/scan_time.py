"""Whether a law is called as often as it was designed for."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.controllers.signals import LARGEST_PARAMETER, SHORTEST_TIME
from clepsydra.program.step_law import Symbols


def scan_parameters(sampling_period: float, tolerance: float) -> list[Signal]:
    """Return sampling_period and scan_tolerance.

    Examples
    --------
    >>> [parameter.unit for parameter in scan_parameters(0.1, 0.1)]
    ['s', '1']
    """
    return [
        Signal(
            "sampling_period",
            "s",
            low=SHORTEST_TIME,
            high=LARGEST_PARAMETER,
            initial=sampling_period,
            description="time between two scans that the law was designed for",
        ),
        Signal(
            "scan_tolerance",
            low=0.0,
            high=1.0,
            initial=tolerance,
            description="share of the sampling period by which a scan may be early or late",
        ),
    ]


def scan_time_off(symbols: Symbols, anew: ca.SX) -> ca.SX:
    """Return whether the measured time step differs from the sampling period by too much.

    A time step that is not a number above zero has a bit of its own, and the first scan after a
    start, before which nothing ran, is not judged.

    Parameters
    ----------
    symbols : mapping
        time_step, sampling_period [s] and scan_tolerance [1].
    anew : casadi.SX
        Whether this scan is a start.

    Examples
    --------
    >>> given = {"time_step": 0.12, "sampling_period": 0.1, "scan_tolerance": 0.1}
    >>> bool(scan_time_off({name: ca.DM(value) for name, value in given.items()}, ca.DM(0)))
    True
    """
    step, period = symbols["time_step"], symbols["sampling_period"]
    off = ca.fabs(step - period) > symbols["scan_tolerance"] * period
    return ca.logic_and(ca.logic_and(is_time_step(step), off), ca.logic_not(anew))
