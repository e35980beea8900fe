"""Rounding to so many significant decimal digits."""

from __future__ import annotations

import math

import numpy as np

#: What is so many decades smaller than the numbers beside it may be what rounding left of zero.
_DECADES = 10


def rounded(value: float, digits: int, size: float = 0.0) -> float:
    """Return a number with so many significant digits, the double nearest to that decimal.

    Parameters
    ----------
    size : float
        Of the numbers beside it: no digit stays ten decades below theirs.

    Examples
    --------
    >>> rounded(2.0 / 3.0, 6), rounded(1234567.8, 6), rounded(-3e-17, 6, 0.1)
    (0.666667, 1234570.0, 0.0)
    """
    if not math.isfinite(value) or value == 0.0:
        return value
    places = digits - 1 - _decade(value)
    if size > 0.0 and math.isfinite(size):
        places = min(places, _DECADES - _decade(size))
    return round(value, places) + 0.0


def rounded_matrix(matrix: np.ndarray, digits: int, sizes: np.ndarray) -> np.ndarray:
    """Return a matrix whose numbers have so many significant digits.

    Parameters
    ----------
    matrix : ndarray [n, m]
    sizes : ndarray [n, m]
        In what unit each number counts; next to the largest share the smallest are nothing.
    """
    shares = np.abs(matrix) / np.where(sizes > 0.0, sizes, 1.0)
    largest = float(np.max(shares, initial=0.0))
    flat = [
        rounded(float(value), digits, largest * float(size))
        for value, size in zip(matrix.ravel(), sizes.ravel(), strict=True)
    ]
    return np.array(flat).reshape(matrix.shape)


def _decade(value: float) -> int:
    return int(f"{value:.16e}".partition("e")[2])
