"""Models and settings of a loop in words, in units that a reader sets or compares."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.designs.gain_units import percent_gain

if TYPE_CHECKING:
    from clepsydra.designs.loops.pairing import PairedLoop
    from clepsydra.designs.models.delayed_lags import DelayedLags
    from clepsydra.designs.models.ultimate_point import UltimatePoint


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


def by_pair(loops: Iterable[PairedLoop], words: Iterable[str]) -> str:
    """Return what is said of each pair."""
    return "; ".join(f"{loop.pair}: {said}" for loop, said in zip(loops, words, strict=True))


def model_words(model: DelayedLags, loop: PairedLoop, more: str = "") -> str:
    """Return the slope, the lag and the delay of a model, what more there is before the delay."""
    lag = model.time_constant
    said = "integrating" if math.isinf(lag) else f"time constant {time_text(lag)}"
    first = f"{slope(model.slope, loop.output, loop.input)}, {said}"
    return f"{first}{more}, delay {time_text(model.delay)}"


def ultimate_words(point: UltimatePoint, loop: PairedLoop) -> str:
    """Return an ultimate point in words."""
    ultimate = gain(point.gain, loop.output, loop.input)
    return f"ultimate gain {ultimate}, ultimate period {time_text(point.period)}"
