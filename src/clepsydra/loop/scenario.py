"""A scenario: what happens to a loop, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.scores.segment import Segment as Segment


@dataclass(frozen=True)
class Scenario:
    """Setpoints, disturbances and measurement noise on the grid of the samples.

    Parameters
    ----------
    sampling_period : float
        [s]
    setpoints : ndarray [samples, controlled]
    disturbances : ndarray [samples, disturbances]
    noise : ndarray [samples, measurements]
        Added to each measurement, in its unit.
    segments : tuple of Segment
        In order of time; they do not overlap.
    seed : int
        Of the noise.

    Examples
    --------
    Two setpoints for a minute, the first of which steps after 10 s:

    >>> setpoints = np.array([[6.0, 5.0]] * 10 + [[6.5, 5.0]] * 50)
    >>> scenario = Scenario(1.0, setpoints, np.zeros((60, 2)), np.zeros((60, 4)),
    ...                     (Segment("setpoint", "level_1", 10.0, 60.0, 0.5),), seed=1)
    >>> scenario.samples, float(scenario.time[-1])
    (60, 59.0)
    """

    sampling_period: float
    setpoints: np.ndarray
    disturbances: np.ndarray
    noise: np.ndarray
    segments: tuple[Segment, ...]
    seed: int

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.setpoints)

    @property
    def duration(self) -> float:
        """From its begin to the end of its last sample [s]."""
        return self.samples * self.sampling_period

    @property
    def time(self) -> np.ndarray:
        """Start of each sample [s]."""
        return np.arange(self.samples) * self.sampling_period
