"""How hard the loops of a process may push before their inputs meet a limit."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.control_authority import DESIGN_STEP, control_authority

if TYPE_CHECKING:
    from clepsydra.linear.operating_point import OperatingPoint
    from clepsydra.process.process import Process


def control_authorities(point: OperatingPoint, inputs: Iterable[str]) -> np.ndarray:
    """Return how hard inputs may be pushed from an operating point [their units].

    Examples
    --------
    >>> import clepsydra as cl
    >>> control_authorities(cl.load("quadruple-tank").linear.point, ["pump_1", "pump_2"])
    array([3., 3.])
    """
    at, signal = point.as_dict(), point.process.signal
    return np.array([control_authority(signal(name), at[name]) for name in inputs])


def check_ranges(process: Process, outputs: Iterable[str], inputs: Iterable[str]) -> None:
    """Refuse signals with an open range: limits and design steps are read off the ranges.

    Raises
    ------
    NotApplicable
        A measurement or an input has no finite range.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> process = SimpleNamespace(signal={"level": Signal("level", "V")}.__getitem__)
    >>> check_ranges(process, ["level"], [])
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: level has no finite range; give it one.
    """
    for name in (*outputs, *inputs):
        if not math.isfinite(process.signal(name).span):
            raise NotApplicable(f"{name} has no finite range; give it one")


def largest_proportional_gain(measurement: Signal, manipulated: Signal, at: float) -> float:
    """Return the gain at which a setpoint step of a tenth of the range just uses up the input.

    Parameters
    ----------
    measurement, manipulated : Signal
        Of the loop.
    at : float
        The input at the operating point [input unit].

    Returns
    -------
    float
        [input unit / measurement unit]

    Examples
    --------
    A pump of 0 to 10 V at 3 V and a sensor of 0 to 10 V: 3 V of room for a step of 1 V.

    >>> level = Signal("level", "V", low=0.0, high=10.0)
    >>> largest_proportional_gain(level, Signal("pump", "V", low=0.0, high=10.0), 3.0)
    3.0
    """
    return control_authority(manipulated, at) / (DESIGN_STEP * measurement.span)
