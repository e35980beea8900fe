"""Models and settings of a loop in words, in units that a reader sets or compares."""

from __future__ import annotations

import math

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.designs.gain_units import percent_gain


def lag(time_constant: float) -> str:
    """Return a time constant, or that there is none.

    Examples
    --------
    >>> lag(62.4), lag(math.inf)
    ('time constant 62.4 s', 'integrating')
    """
    return (
        "integrating" if math.isinf(time_constant) else f"time constant {time_text(time_constant)}"
    )


def gain(value: float, output: Signal, manipulated: Signal) -> str:
    """Return a controller's gain in percent of the input per percent of the output.

    Examples
    --------
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> pump = Signal("pump", "V", low=0.0, high=10.0)
    >>> gain(4.0, level, pump)
    '2 %/%'
    """
    return f"{percent_gain(value, output, manipulated):.3g} %/%"


def slope(value: float, output: Signal, manipulated: Signal) -> str:
    """Return how fast an output moves, in percent of it per percent of the input.

    Parameters
    ----------
    value : float
        [output unit / (input unit · s)]
    output, manipulated : Signal
        With finite ranges.

    Examples
    --------
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> pump = Signal("pump", "V", low=0.0, high=10.0)
    >>> slope(0.001, level, pump)
    'slope 0.12 %/% a minute'
    """
    in_shares = percent_gain(value, manipulated, output)
    if abs(in_shares) >= 0.01:
        return f"slope {in_shares:.3g} %/% a second"
    return f"slope {60.0 * in_shares:.3g} %/% a minute"
