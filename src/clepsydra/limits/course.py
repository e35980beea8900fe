"""A course that an optimisation found: contents and inputs over its grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.optimal_control.grid import Grid


@dataclass(frozen=True, eq=False)
class Course:
    """Contents at the collocation points, and inputs at both ends of the blocks.

    Parameters
    ----------
    grid : Grid
    shares : ndarray [3]
        Where in a block the collocation points are, the last at its end.
    contents : ndarray [contents, 3 blocks]
        Scaled.
    first, last : ndarray [inputs, blocks]
        Inputs where a block begins and where it ends, shares of their range.
    index : float
        What was minimised [s].
    """

    grid: Grid
    shares: np.ndarray
    contents: np.ndarray
    first: np.ndarray
    last: np.ndarray
    index: float

    def input_samples(self, samples: int) -> np.ndarray:
        """Return the inputs held in each sample: those of the line in its middle [inputs, n]."""
        times = (np.arange(samples) + 0.5) * self.grid.period
        starts, durations = self.grid.starts, self.grid.durations
        block = np.searchsorted(starts, times, side="right") - 1
        share = (times - starts[block]) / durations[block]
        return self.first[:, block] + share * (self.last - self.first)[:, block]
