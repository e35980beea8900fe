"""Mean and variance that have the same bits in whatever order their parts arrive."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: Every finite double is a whole number of 2^-UNIT: the last bit of the smallest, by `frexp`.
UNIT = 1126
#: So many values at once: sums of their halves, of up to 37 bits, stay far within 63 bits.
_BLOCK = 1 << 20
_HALF = 27
_MASK = (1 << _HALF) - 1


@dataclass(frozen=True)
class ExactSum:
    """Sums of values and of their squares, without any rounding.

    A sum of doubles depends on their order, and one of rounded sums of chunks on how draws were
    divided among workers. Here both sums are whole numbers: a double is a whole number of 2^-1126,
    its square one of 2^-2252, and Python's integers have no end. Adding them is exact, so any order
    of merging gives the same bits, and the mean and the variance are rounded once, at the end; no
    chunk needs to wait for the one before it. Nothing cancels either, as n Σx² − (Σx)² would in
    doubles.

    Attributes
    ----------
    count : int
        How many values, infinite ones included.
    total, squares : int
        Sums over the finite ones, in units of 2^-1126 and 2^-2252.
    above, below : int
        How many are ∞ and −∞.

    Examples
    --------
    >>> parts = [ExactSum.of(np.array(part)) for part in ([1e100, 1.0], [-1e100, 3.0])]
    >>> both = parts[1].merged(parts[0])
    >>> both.mean, ExactSum.of(np.array([1.0, 2.0, 4.0])).variance
    (1.0, 2.3333333333333335)
    """

    count: int
    total: int
    squares: int
    above: int = 0
    below: int = 0

    @classmethod
    def of(cls, values: np.ndarray) -> ExactSum:
        """Return the sums of values [n], which are numbers or infinite."""
        values = np.asarray(values, dtype=float)
        total = squares = 0
        finite = values[np.isfinite(values)]
        for start in range(0, len(finite), _BLOCK):
            more, more_squares = _sums(finite[start : start + _BLOCK])
            total, squares = total + more, squares + more_squares
        above, below = (int(np.count_nonzero(values == end)) for end in (math.inf, -math.inf))
        return cls(len(values), total, squares, above, below)

    def merged(self, other: ExactSum) -> ExactSum:
        """Return the sums of both."""
        return ExactSum(
            self.count + other.count,
            self.total + other.total,
            self.squares + other.squares,
            self.above + other.above,
            self.below + other.below,
        )

    def of_finite(self) -> ExactSum:
        """Return the sums of the finite values alone: of the loops that did not break."""
        return ExactSum(self.count - self.above - self.below, self.total, self.squares)

    @property
    def mean(self) -> float:
        """The mean, correctly rounded; infinite where a value is, and not a number of no values."""
        if self.count == 0 or (self.above and self.below):
            return math.nan
        if self.above or self.below:
            return math.inf if self.above else -math.inf
        return self.total / (self.count << UNIT)

    @property
    def variance(self) -> float:
        """The variance with n − 1, correctly rounded.

        It is not a number of fewer than two values or where one is infinite.
        """
        if self.count < 2 or self.above or self.below:
            return math.nan
        scaled = self.count * self.squares - self.total**2
        try:
            return scaled / (self.count * (self.count - 1) << 2 * UNIT)
        except OverflowError:
            return math.inf


def _sums(values: np.ndarray) -> tuple[int, int]:
    """Return the sums of finite values and of their squares, in units."""
    fractions, exponents = np.frexp(values)
    # From -1073 to 1024; a stable sort of 16 bits is done digit by digit.
    order = np.argsort(exponents.astype(np.int16), kind="stable")
    whole = np.ldexp(fractions, 53).astype(np.int64)[order]
    exponents = exponents[order].astype(np.int64)
    starts = np.flatnonzero(np.diff(exponents, prepend=exponents[0] - 1))
    shifts = [int(exponent) - 53 + UNIT for exponent in exponents[starts]]
    total = _shifted(_added(whole, starts), shifts)
    high, low = np.abs(whole) >> _HALF, np.abs(whole) & _MASK
    twice = [2 * shift for shift in shifts]
    squares = (
        (_shifted(_added(high * high, starts), twice) << 2 * _HALF)
        + (_shifted(_added(high * low, starts), twice) << _HALF + 1)
        + _shifted(_added(low * low, starts), twice)
    )
    return total, squares


def _added(whole: np.ndarray, starts: np.ndarray) -> list[int]:
    """Return sums of whole numbers from each start to the next, by halves lest one overflows."""
    high = np.add.reduceat(whole >> _HALF, starts)
    low = np.add.reduceat(whole & _MASK, starts)
    return [(int(above) << _HALF) + int(rest) for above, rest in zip(high, low, strict=True)]


def _shifted(parts: list[int], shifts: list[int]) -> int:
    return sum(part << shift for part, shift in zip(parts, shifts, strict=True))
