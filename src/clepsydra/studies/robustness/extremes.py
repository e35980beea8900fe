"""The least and the largest of scores, and the draws that gave them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.studies.robustness.quantiles import require_ordered


@dataclass(frozen=True)
class Extreme:
    """A score that none exceeds, and the number of the draw that gave it; of several the lowest.

    Examples
    --------
    >>> Extremes.of(np.array([2.0, 5.0, 5.0])).worst()
    Extreme(value=5.0, draw=1)
    """

    value: float
    draw: int


@dataclass(frozen=True)
class Extremes:
    """The least and the largest of scores.

    Examples
    --------
    >>> early = Extremes.of(np.array([2.0, 5.0]))
    >>> late = Extremes.of(np.array([1.0, 5.0]), np.array([100, 101]))
    >>> late.merged(early)
    Extremes(least=Extreme(value=1.0, draw=100), largest=Extreme(value=5.0, draw=1))
    """

    least: Extreme
    largest: Extreme

    @classmethod
    def of(cls, scores: np.ndarray, draws: np.ndarray | None = None) -> Extremes:
        """Return those of scores.

        Parameters
        ----------
        scores : ndarray [draws]
            Infinite where a loop broke.
        draws : ndarray of int [draws], optional
            The number of each draw, in any order; 0, 1, 2, … without it.

        Raises
        ------
        InputError
            There are no scores, or one is not a number.
        """
        scores = np.asarray(scores, dtype=float)
        if not len(scores):
            raise InputError("scores", Finding("none"), "one at least", "draw some")
        require_ordered(scores)
        numbers = np.arange(len(scores)) if draws is None else np.asarray(draws)
        return cls(*(_first(scores, numbers, value) for value in (scores.min(), scores.max())))

    def merged(self, other: Extremes) -> Extremes:
        """Return those of two sets of draws together."""
        return Extremes(
            min(self.least, other.least, key=lambda found: (found.value, found.draw)),
            min(self.largest, other.largest, key=lambda found: (-found.value, found.draw)),
        )

    def worst(self, larger_is_better: bool = False) -> Extreme:
        """Return the worst score and its draw."""
        return self.least if larger_is_better else self.largest


def _first(scores: np.ndarray, numbers: np.ndarray, value: float) -> Extreme:
    return Extreme(float(value) + 0.0, int(numbers[scores == value].min()))
