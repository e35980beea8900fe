"""How hard a controller may push: the room that the inputs' ranges leave."""

from __future__ import annotations

import math
from collections.abc import Iterable

from clepsydra.design.applicability import NotApplicable
from clepsydra.process.process import Process

#: The setpoint step that must not saturate the input, as a share of the measurement's range.
DESIGN_STEP = 0.1


def room(low: float, high: float, value: float) -> float:
    """Return the distance from a value to the nearer limit, at least a tenth of the range.

    Examples
    --------
    >>> room(0.0, 10.0, 3.0), room(0.0, 10.0, 9.8)
    (3.0, 1.0)
    """
    return max(min(value - low, high - value), 0.1 * (high - low))


def check_ranges(
    process: Process, outputs: Iterable[str], inputs: Iterable[str], method: str
) -> None:
    """Refuse signals with an open range: limits and design steps are read off the ranges.

    Raises
    ------
    NotApplicable
        A measurement or an input has no finite range.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.base.signal import Signal
    >>> process = SimpleNamespace(signal={"level": Signal("level", "V")}.__getitem__)
    >>> check_ranges(process, ["level"], [], "SIMC")
    Traceback (most recent call last):
        ...
    clepsydra.design.applicability.NotApplicable: SIMC is not applicable: level has no finite \
range; give it one.
    """
    for name in (*outputs, *inputs):
        signal = process.signal(name)
        if not (math.isfinite(signal.low) and math.isfinite(signal.high)):
            raise NotApplicable(method, f"{name} has no finite range; give it one")


def largest_proportional_gain(process: Process, output: str, input_name: str, at: float) -> float:
    """Return the gain at which a setpoint step of a tenth of the range just uses up the room.

    Parameters
    ----------
    process : Process
    output, input_name : str
        The measurement and the input of the loop.
    at : float
        The input at the operating point [input unit].

    Returns
    -------
    float
        [input unit / measurement unit]

    Examples
    --------
    A pump of 0 to 10 V at 3 V and a sensor of 0 to 10 V: 3 V of room for a step of 1 V.

    >>> from types import SimpleNamespace
    >>> from clepsydra.base.signal import Signal
    >>> signals = {"level": Signal("level", "V", low=0, high=10),
    ...            "pump": Signal("pump", "V", low=0, high=10)}
    >>> process = SimpleNamespace(signal=signals.__getitem__)
    >>> largest_proportional_gain(process, "level", "pump", 3.0)
    3.0
    """
    measurement, manipulated = process.signal(output), process.signal(input_name)
    free = room(manipulated.low, manipulated.high, at)
    return free / (DESIGN_STEP * (measurement.high - measurement.low))
