"""How many runs reach a printed number, and which numbers of runs decide.

The report shows one run. Its number is one of ours where runs lie on either side of it, and none of
ours where all lie on one side; how many are far enough from a hair is a matter of the binomial law.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.papers.printed import PrintedNumber

#: So many of 128 runs on either side of a number, or more, make it one of theirs; none on one of
#: its sides make it none of theirs; and what is between is left open. Of a number beyond which one
#: run in forty lies, 0 of 128 would do so in 3.9 % of all cases, and 7 or more in 4.2 %.
ENOUGH = 7
#: Ranks of 128 runs, from 1, between which their true median lies in 96 % of all cases.
MEDIAN_RANKS = (53, 76)


@dataclass(frozen=True)
class Reach:
    """How many runs are no larger than a printed number, and how many no smaller."""

    lower: int
    higher: int

    @classmethod
    def of(cls, values: np.ndarray, number: PrintedNumber) -> Reach:
        """Count the runs on either side of a number; those that round to it are on both.

        Examples
        --------
        >>> Reach.of(np.array([1.0, 2.04, 3.0]), PrintedNumber(2.0, 0.05))
        Reach(lower=2, higher=2)
        """
        low, high = number.value - number.half_unit, number.value + number.half_unit
        return cls(int(np.sum(values <= high)), int(np.sum(values >= low)))

    @property
    def runs(self) -> int:
        """The runs that lie as far as the number, on the side where fewer do."""
        return min(self.lower, self.higher)

    @property
    def holds(self) -> bool:
        """Whether the number is one of theirs."""
        return self.runs >= ENOUGH

    def fails_like(self, other: Reach) -> bool:
        """Whether the number is none of these runs and none of others, on the same side."""
        return self.lower == other.lower == 0 or self.higher == other.higher == 0


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
