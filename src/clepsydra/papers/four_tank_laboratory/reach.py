"""How many runs reach a printed number, how far it is from all, and which numbers of runs decide.

The report shows one run. Its number is one of ours where runs lie on either side of it, and none of
ours where it is far from all; what is between is left open, so that no seed decides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: So many of 128 runs on either side of a number, or more, make it one of theirs. Of a number
#: beyond which one run in forty lies, 7 or more of 128 would do so in 4.2 % of all cases.
ENOUGH = 7
#: And more than so many standard deviations from their mean make it none of theirs. Of a normal
#: distribution one run in 31600 lies beyond them, and of 128 runs any in 0.4 % of all cases. The
#: printed numbers that are nearest to it lie 3.0 and 4.6 off, which 128 runs tell within 0.3.
FAR = 4.0
#: Ranks of 128 runs, from 1, between which their true median lies in 96 % of all cases.
MEDIAN_RANKS = (53, 76)


@dataclass(frozen=True)
class Reach:
    """How runs lie beside a printed number."""

    above: int  # as large as the number, or larger
    below: int
    mean: float
    deviation: float

    @classmethod
    def of(cls, values: np.ndarray, printed: float) -> Reach:
        """Compare runs with a number.

        Examples
        --------
        >>> Reach.of(np.array([1.0, 2.0, 3.0]), 8.0)
        Reach(above=0, below=3, mean=2.0, deviation=1.0)
        """
        above = int(np.sum(values >= printed))
        # A level that is not back before the next pour is back at no time, and no number is far.
        with np.errstate(invalid="ignore"):
            mean, deviation = float(values.mean()), float(values.std(ddof=1))
        return cls(above, len(values) - above, mean, deviation)

    @property
    def holds(self) -> bool:
        """Whether the number is one of theirs."""
        return min(self.above, self.below) >= ENOUGH

    def off(self, printed: float) -> float:
        """Return by how many standard deviations a number lies above their mean, or below."""
        return (printed - self.mean) / self.deviation if np.isfinite(self.deviation) else 0.0


def far_from_all(runs: list[Reach], printed: float) -> bool:
    """Return whether a number is none of any of these runs, and on the same side of all.

    Examples
    --------
    >>> near, far = Reach(0, 9, mean=2.0, deviation=2.0), Reach(0, 9, mean=2.0, deviation=1.0)
    >>> far_from_all([far], 8.0), far_from_all([far, near], 8.0), far_from_all([far], -8.0)
    (True, False, True)
    """
    off = [each.off(printed) for each in runs]
    return min(off) > FAR or max(off) < -FAR


def median_interval(values: np.ndarray) -> tuple[float, float]:
    """Return the runs between which the median of all runs lies, so that no seed decides."""
    ordered = np.sort(values)
    low, high = (float(ordered[rank - 1]) for rank in MEDIAN_RANKS)
    return low, high


def surely_larger(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return where other is larger, 1, and where not, 0; nan where intervals [2, …] overlap.

    Examples
    --------
    >>> low, high = np.array([[1.0, 1.0, 5.0], [2.0, 2.0, 6.0]]), np.array([[3.0, 1.5, 1.0]] * 2)
    >>> surely_larger(low, high)
    array([ 1., nan,  0.])
    """
    return np.where(other[0] > one[1], 1.0, np.where(other[1] <= one[0], 0.0, np.nan))
