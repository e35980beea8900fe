"""A sketch of very many scores: quantiles of a stated relative error, in little memory.

It is DDSketch (C. Masson, J. E. Rim, H. K. Lee, PVLDB 12(12), 2019, doi:10.14778/3352063.3352135):
counts of buckets, each so narrow that any value in it is within the relative error of what stands
for them all. Counts are whole numbers, so sketches merge exactly: any order, any number of workers,
the same counts.

Buckets are even steps between a power of two and the next, not in the logarithm itself: the bucket
of a double is then its own leading bits, which no processor's logarithm rounds differently at an
edge, and one shift finds it. That takes 1.5 times as many buckets as logarithms would. Buckets are
never joined to save memory, since what is lost then depends on the order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError

#: Of a quantile, beside the score that really has its place.
RELATIVE_ERROR = 1e-3
#: Bits of a double behind its leading one, and the exponent of the smallest normal one.
_MANTISSA = 52
_LEAST_EXPONENT = -1022


@dataclass(frozen=True, eq=False)
class Sketch:
    """Counts of scores in buckets.

    A bucket takes 16 bytes, and only those with a score in them are there: for an error of 0.1 % at
    most 1,701 a decade, so 163 kB for scores over six decades, however many there are.

    Attributes
    ----------
    steps : int
        The power of two that is the number of buckets between a power of two and the next.
    buckets : ndarray of int64 [k]
        Their numbers, ascending as the values: 0 is zero, negative ones are below it.
    counts : ndarray of int64 [k]
        How many scores each has, 1 at least.

    Examples
    --------
    >>> sketch = Sketch.of(np.array([-1.0, 0.0, 3.0, 700.0, np.inf]))
    >>> [round(sketch.at(place), 3) for place in range(1, 6)]
    [-1.001, 0.0, 3.002, 700.5, inf]
    """

    steps: int
    buckets: np.ndarray
    counts: np.ndarray

    @classmethod
    def of(cls, scores: np.ndarray, relative_error: float = RELATIVE_ERROR) -> Sketch:
        """Return the sketch of scores [n], which are numbers or infinite.

        Parameters
        ----------
        relative_error : float
            Of what stands for a score, at most; between 1e-6 and 0.1. What is below 2.2e-308, the
            smallest normal double, is as far off as that would be.

        Raises
        ------
        InputError
            The relative error is not in its range.
        """
        return cls.of_steps(scores, steps_for(relative_error))

    @classmethod
    def of_steps(cls, scores: np.ndarray, steps: int) -> Sketch:
        """Return the sketch of scores with so many steps, as `steps_for` gives them."""
        bits = np.asarray(scores, dtype=float).view(np.int64)
        sizes = bits & np.int64(0x7FFF_FFFF_FFFF_FFFF)
        numbers = np.where(sizes == 0, 0, (sizes >> np.int64(_MANTISSA - steps)) + 1)
        return cls(steps, *np.unique(np.where(bits < 0, -numbers, numbers), return_counts=True))

    @property
    def count(self) -> int:
        """How many scores there are."""
        return int(self.counts.sum())

    @property
    def relative_error(self) -> float:
        """What `at` is off by, at most."""
        return 1.0 / (2.0 ** (self.steps + 1) + 1.0)

    def merged(self, *others: Sketch) -> Sketch:
        """Return the sketch of all their scores; they have the same relative error."""
        every = (self, *others)
        if any(each.steps != self.steps for each in every):
            raise ValueError("sketches with different relative errors do not merge")
        buckets, place = np.unique(
            np.concatenate([each.buckets for each in every]), return_inverse=True
        )
        counts = np.zeros(len(buckets), dtype=np.int64)
        np.add.at(counts, place, np.concatenate([each.counts for each in every]))
        return Sketch(self.steps, buckets, counts)

    def at(self, place: int) -> float:
        """Return the score at a place of the ascending order, counted from 1."""
        found = int(np.searchsorted(np.cumsum(self.counts), place))
        number = int(self.buckets[found])
        if number == 0:
            return 0.0
        low = float(np.int64((abs(number) - 1) << (_MANTISSA - self.steps)).view(float))
        if math.isinf(low):
            return math.copysign(low, number)
        normal = low >= math.ldexp(1.0, _LEAST_EXPONENT)
        half = math.ldexp(0.5, (math.frexp(low)[1] - 1 if normal else _LEAST_EXPONENT) - self.steps)
        # As far, relatively, from one edge of the bucket as from the other.
        return math.copysign(low + half * (low / (low + half) if normal else 1.0), number)


def steps_for(relative_error: float) -> int:
    """Return how many times the span of a power of two is halved for a relative error.

    Examples
    --------
    >>> steps_for(0.001), steps_for(0.01)
    (9, 6)
    """
    if not 1e-6 <= relative_error <= 0.1:
        raise InputError(
            "relative error of quantiles", relative_error, "between 1e-6 and 0.1", "as 0.001"
        )
    return max(1, math.ceil(math.log2((1.0 / relative_error - 1.0) / 2.0)))
