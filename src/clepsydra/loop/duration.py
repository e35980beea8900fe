"""Lengths of time: read from words, and rounded up to pretty numbers."""

from __future__ import annotations

import math

from clepsydra.base.errors import InputError
from clepsydra.base.units import to_si
from clepsydra.base.words import TIME_UNITS

_PRETTY = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
#: Shares of a sampling period by which a time may miss a sample and still count as on it.
_ON_SAMPLE = 1e-9


def pretty_duration(least: float) -> float:
    """Return a length of time [s], not below `least` [s], that is a pretty number in its unit.

    Examples
    --------
    >>> pretty_duration(544.0)  # ten minutes
    600.0
    """
    length, most = next((length, most) for _, length, most in TIME_UNITS if least <= most)
    count = least / length
    power = 10.0 ** math.floor(math.log10(count))
    pretty = next(p * power for p in _PRETTY if p * power >= count * (1.0 - _ON_SAMPLE))
    return min(length * pretty, most)  # three minutes, hours or days are pretty as well


def read_duration(text: object, place: str) -> float:
    """Read a length of time such as "20 min" [s].

    Raises
    ------
    InputError
        It is none, or not above zero.

    Examples
    --------
    >>> read_duration("20 min", "--duration")
    1200.0
    """
    duration = to_si(text, "s", place)
    if duration <= 0.0:
        raise InputError(place, text, "a time above 0 s", "write it as in '20 min'")
    return duration


def samples_before(time: float, period: float) -> int:
    """Return how many samples begin before a time [s]: the place of the first one at it or later.

    Examples
    --------
    >>> samples_before(0.3, 0.1), samples_before(0.31, 0.1)
    (3, 4)
    """
    return math.ceil(time / period - _ON_SAMPLE * max(1.0, time / period))
