"""A scenario: what happens to a loop, sample by sample."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.noise import Noise
from clepsydra.loop.profile import Change, profiles_of
from clepsydra.scores.segment import Segment as Segment

if TYPE_CHECKING:
    from clepsydra.loop.begin import Begin


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
    begin : Begin or None
        Where the loop begins; None at rest at its operating point.
    noises : tuple of Noise
        What the noise of measurements, and that in the disturbances, is made of; none where it was
        given by its values.
    quiet_disturbances : ndarray [samples, disturbances] or None
        The disturbances without their noise; None where that is not known to be apart.
    """

    sampling_period: float
    setpoints: np.ndarray
    disturbances: np.ndarray
    noise: np.ndarray
    segments: tuple[Segment, ...]
    seed: int
    begin: Begin | None = None
    noises: tuple[Noise, ...] = ()
    quiet_disturbances: np.ndarray | None = None

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.setpoints)

    @property
    def duration(self) -> float:
        """From its begin to the end of its last sample [s]."""
        return self.samples * self.sampling_period

    def sample_of(self, segment: Segment) -> int:
        """Return the first sample of a segment."""
        return min(round(segment.start / self.sampling_period), self.samples - 1)

    def settled_sample_of(self, segment: Segment) -> int:
        """Return the first sample from which the signal of a segment stays where it is."""
        reached = round((segment.start + segment.over) / self.sampling_period)
        return min(reached, self.samples - 1)

    @property
    def time(self) -> np.ndarray:
        """Start of each sample [s]."""
        return np.arange(self.samples) * self.sampling_period


def scenario_of_changes(
    point: OperatingPoint,
    changes: Iterable[Change],
    samples: int,
    segments: tuple[Segment, ...] = (),
    seed: int = 1,
    begin: Begin | None = None,
) -> Scenario:
    """Return exactly these changes of setpoints and disturbances, without noise.

    Setpoints and disturbances stand where the point has them until they change, wherever it begins.

    Raises
    ------
    InputError
        The changes of a signal are not in order, or do not end within the samples.

    Examples
    --------
    >>> import clepsydra as cl
    >>> changes = [Change("level_1", 7.0, 2.0, 2.0)]
    >>> scenario_of_changes(cl.load("quadruple-tank").point, changes, 4).setpoints[:, 0].round(1)
    array([6.1, 6.1, 7. , 7. ])
    """
    process, at = point.process, point.as_dict()
    loads = [signal.name for signal in process.disturbances]
    before = {name: at[name] for name in (*process.controlled, *loads)}
    profiles = profiles_of(changes, before, process.sampling_period, samples)
    setpoints, disturbances = (
        np.array([profiles[name] for name in names]).reshape(len(names), samples).T
        for names in (process.controlled, loads)
    )
    noise = np.zeros((samples, len(process.measurements)))
    period = process.sampling_period
    return Scenario(period, setpoints, disturbances, noise, segments, seed, begin)
