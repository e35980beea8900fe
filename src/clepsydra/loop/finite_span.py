"""The width of a range that something is a share of."""

from __future__ import annotations

import math

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.process.process import Process


def finite_span(process: Process, signal: Signal) -> float:
    """Return the width of the range of a signal.

    Raises
    ------
    InputError
        The range is infinite or empty.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> finite_span(process, process.signal("level_1"))
    10.0
    """
    span = signal.span
    if not (math.isfinite(span) and span > 0.0):
        raise InputError(
            f"{process.name}, {signal.name}",
            f"a range from {signal.low:g} to {signal.high:g} {signal.unit}",
            "a finite range with its low end below its high end",
            "give the sensor a range",
        )
    return span
