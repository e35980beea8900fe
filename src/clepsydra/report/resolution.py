"""Below what a number says nothing, and is shown as 0: the one place where that is decided."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.base.signal import Signal

#: Said in a report below the tables that show 0 for less.
RESOLUTION_WORDS = (
    "0 stands for less than a millionth of a signal's range, or of a step, which no transmitter "
    "tells from nothing; of an integral, for less than a billionth of the range adds up to in the "
    "whole run."
)

#: Share of a signal's range that a deviation has to reach before its digits mean anything: the
#: integration aims at it, and a transmitter of 16 bits has steps fifteen times as large.
DEVIATION = 1e-6
#: The same of the mean of what is integrated: a short transient adds up to little, and counts.
INTEGRAND = 1e-9
#: What of a value, or of a gain beside the others of its matrix, is only the computer's rounding.
ROUNDING = 1e-9


def settled(value: float, least: float) -> float:
    """Return a value, or 0 where it is smaller than the least that says something.

    Parameters
    ----------
    value, least : float
        In the same unit; a `least` that is not finite lets every value pass.

    Examples
    --------
    >>> settled(1.04e-12, 1e-4), settled(-3.0, 1e-4)
    (0.0, -3.0)
    """
    return 0.0 if math.isfinite(least) and abs(value) < least else value


def settled_reading(signal: Signal, value: float) -> float:
    """Return a value of a signal [SI] without what is only rounding beside its range.

    Examples
    --------
    >>> settled_reading(Signal("pump", "V", low=0.0, high=10.0), 1e-12)
    0.0
    """
    return settled(value, ROUNDING * signal.span)


def settled_gains(
    gains: np.ndarray, rows: Sequence[Signal], columns: Sequence[Signal]
) -> np.ndarray:
    """Return gains [SI] with 0 for those that are rounding beside the largest of them.

    They are compared in shares of the ranges of their rows and columns; a signal without a range
    counts as it is.

    Parameters
    ----------
    gains : ndarray [rows, columns]
    rows, columns : sequence of Signal

    Examples
    --------
    >>> pump, level = Signal("pump", "V", low=0.0, high=10.0), Signal("level", "m", low=0.0, high=1)
    >>> settled_gains(np.array([[2.0, 3e-15]]), [pump], [level, level])
    array([[2., 0.]])
    """
    sizes = np.outer([1.0 / _width(s) for s in rows], [_width(s) for s in columns])
    shares = np.abs(gains) * sizes
    return np.where(shares < ROUNDING * np.max(shares, initial=0.0), 0.0, gains)


def _width(signal: Signal) -> float:
    return signal.span if 0.0 < signal.span < math.inf else 1.0
