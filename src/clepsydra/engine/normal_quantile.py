"""Normal deviates from random bits, by + − × ÷ that round once and a table made of them.

Nothing here is a library's function, so the same bits give the same deviates on every machine, and
in a page, where `page/sources/live/noise.ts` computes the same in the same order.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import ldexp

import numpy as np

#: Pieces between two powers of 2, and the degree of their polynomials.
_PIECES, _DEGREE = 8, 7
#: The smallest share of the distribution beyond a deviate, as a power of 2: half of 2⁻⁵³.
SMALLEST = -54
#: The deviate that the centre of the smallest piece lies beyond, and its slope over the share.
_FARTHEST = 8.285149113161363, -2017804525852002.2
#: Terms of the exponential that give a double between centres, whose ratio is 19/17 at most.
_TERMS = 10
#: Bits of a share that number its piece, counted from that of the smallest.
SHIFT = 49
#: The bits of a double below its exponent: as many choose a share.
SIGNIFICANT = (1 << 52) - 1
_FIRST = (1023 + SMALLEST) * _PIECES


def normal_deviates(words: np.ndarray) -> np.ndarray:
    """Return a normal deviate for each word of 64 random bits: the first is the sign.

    The next 52 bits choose the middle of one of as many equal shares of half the distribution,
    and the deviate is what this share lies beyond, within 10⁻⁸; the largest is 8.3.

    Parameters
    ----------
    words : ndarray of uint64 [n]

    Examples
    --------
    A quarter of the values lie beyond 0.6745:

    >>> normal_deviates(np.array([1 << 62, 3 << 62], np.uint64)).round(4)
    array([ 0.6745, -0.6745])
    """
    numbers = ((words >> 11) & SIGNIFICANT).view(np.int64)
    shares = (numbers + 0.5) * ldexp(2.0, SMALLEST)
    piece = (shares.view(np.int64) >> SHIFT) - _FIRST
    centre, *rising = quantile_table()
    shares -= centre[piece]
    deviates = rising[-1][piece]
    for coefficient in rising[-2::-1]:
        deviates *= shares
        deviates += coefficient[piece]
    return np.negative(deviates, out=deviates, where=words >> 63 != 0)


@cache
def quantile_table() -> np.ndarray:
    """Return the table of the deviate w that a share q of the distribution lies beyond.

    Each column is a piece of q: its centre, and the coefficients of w by rising powers of the
    distance from it. With φ the density, dw/dq = −1/φ(w), therefore d²w/dq² = w (dw/dq)², which
    gives each coefficient of a Taylor series from those before. The series of a piece leads to
    the centre of the next larger one, where the slope has grown by exp of half the difference of
    w². From the far end inward, an error in the share is the smaller beside it the farther it has
    come.

    Returns
    -------
    ndarray [2 + degree, pieces]

    References
    ----------
    G. Steinbrecher and W. T. Shaw, Quantile mechanics, European Journal of Applied Mathematics
    19, 2008, 87-112, doi:10.1017/S0956792508007341.
    """
    centres = [
        ldexp(1.0 + (2 * piece + 1) / (2 * _PIECES), power)
        for power in range(SMALLEST, -1)
        for piece in range(_PIECES)
    ]
    deviate, slope = _FARTHEST
    pieces = [_series(deviate, slope)]
    for before, centre in pairwise(centres):
        *lower, reached = pieces[-1]
        for coefficient in reversed(lower):
            reached = reached * (centre - before) + coefficient
        logarithm, growth = (reached - deviate) * (reached + deviate) / 2.0, 1.0
        for term in range(_TERMS, 0, -1):
            growth = 1.0 + growth * logarithm / term
        deviate, slope = reached, slope * growth
        pieces.append(_series(deviate, slope))
    table = np.array([centres, *zip(*pieces, strict=True)])
    table.flags.writeable = False
    return table


def _series(deviate: float, slope: float) -> list[float]:
    """Return the Taylor coefficients of w, by w'' = w (w')².

    Sums are loops: the built-in `sum` rounds otherwise from Python 3.12 on.
    """
    series, slopes, squares = [deviate, slope], [slope], list[float]()
    for n in range(_DEGREE - 1):
        square = curvature = 0.0
        for k in range(n + 1):
            square += slopes[k] * slopes[n - k]
        squares.append(square)
        for k in range(n + 1):
            curvature += series[k] * squares[n - k]
        slopes.append(curvature / (n + 1))
        series.append(slopes[-1] / (n + 2))
    return series
