"""The share of draws in which something happened, and how sure it is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal

import numpy as np

from clepsydra.base.errors import InputError

#: How often an interval of a report holds what it is about.
LEVEL = 0.95


@dataclass(frozen=True)
class Share:
    """A share of draws with its interval.

    Attributes
    ----------
    count, of : int
        In how many of the draws it happened, and how many there are.
    low, high : float
        The interval of the probability, between 0 and 1.

    Examples
    --------
    >>> print(share_of(0, 10_000))
    0 of 10,000 draws, at most 0.04 %
    >>> print(share_of(320, 10_000))
    3.2 % of 10,000 draws (2.9 to 3.6 %)
    >>> print(share_of(200, 200))
    200 of 200 draws, at least 98 %
    """

    count: int
    of: int
    low: float
    high: float

    @property
    def value(self) -> float:
        """The share itself, between 0 and 1."""
        return self.count / self.of

    def __str__(self) -> str:
        draws = f"{self.of:,} draws"
        decimals = max(0, -math.floor(math.log10(100.0 * (self.high - self.low))))
        if self.count == 0:
            return f"0 of {draws}, at most {_outward(100.0 * self.high, decimals):f} %"
        if self.count == self.of:
            most = _outward(100.0 * (1.0 - self.low), decimals)
            return f"{self.of:,} of {draws}, at least {100 - most:f} %"
        # No bound of what did happen, and once did not, is rounded to "never" or "always".
        nearest = 100.0 * min(self.low, 1.0 - self.high)
        decimals = max(decimals, -math.floor(math.log10(nearest)))
        value, low, high = (
            f"{100.0 * share:.{decimals}f}" for share in (self.value, self.low, self.high)
        )
        return f"{value} % of {draws} ({low} to {high} %)"


def share_of(count: int, of: int, level: float = LEVEL) -> Share:
    """Return the share of draws in which something happened, with its Wilson interval.

    Parameters
    ----------
    count, of : int
        In how many of the draws it happened, and how many there are, at least 1.
    level : float
        How often the interval is to hold the probability, between 0 and 1.

    Raises
    ------
    InputError
        There are no draws, or it happened in more of them than there are.

    Examples
    --------
    >>> share = share_of(3, 100)
    >>> round(share.low, 4), round(share.high, 4)
    (0.0103, 0.0845)
    """
    low, high = wilson_interval(np.array(count), np.array(of), level)
    return Share(int(count), int(of), float(low), float(high))


def wilson_interval(
    counts: np.ndarray, of: np.ndarray, level: float = LEVEL
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower and upper bounds of many shares at once.

    Wilson's interval inverts the normal test of a share and, unlike "share plus or minus two
    standard deviations", holds also where a share is near 0 or 1 (E. B. Wilson, J. Am. Stat. Assoc.
    22, 1927, doi:10.1080/01621459.1927.10502953). The bound at a share of 0 or 1 is exactly that.

    Parameters
    ----------
    counts, of : ndarray
        As for `share_of`; shapes that broadcast.

    Examples
    --------
    >>> low, high = wilson_interval(np.array([0, 50]), np.array(100))
    >>> low.round(3), high.round(3)
    (array([0.   , 0.404]), array([0.037, 0.596]))
    """
    from scipy.special import ndtri

    counts, of = np.asarray(counts), np.asarray(of)
    if np.any(of < 1) or np.any(counts < 0) or np.any(counts > of):
        raise InputError(
            "share of draws",
            f"{counts} of {of}",
            "at least one draw, and a count between none and all of them",
            "count again",
        )
    square = float(ndtri(0.5 + 0.5 * level)) ** 2
    middle = counts + 0.5 * square
    half = np.sqrt(square * (counts * ((of - counts) / of) + 0.25 * square))
    low = (middle - half) / (of + square)  # exactly 0 at 0: the root of a square is the number
    high = np.where(counts == of, 1.0, (middle + half) / (of + square))
    return low, high


def _outward(percent: float, decimals: int) -> Decimal:
    """Return a bound rounded up, with one decimal more where that would add a tenth to it."""
    for places in (decimals, decimals + 1):
        bound = Decimal(percent).quantize(Decimal(1).scaleb(-places), ROUND_CEILING)
        if float(bound) <= 1.1 * percent:
            break
    return bound
