"""What a delay holds, kept for integration steps of another length."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clepsydra.loop.motion_block import RING_PARTS, ring_name

Array = NDArray[np.float64]


class DelayContent(NamedTuple):
    """A delayed quantity as a parabola in each integration step, the oldest first [steps].

    Parameters
    ----------
    start, mean, end : ndarray
    """

    start: Array
    mean: Array
    end: Array

    def over(self, steps: int) -> DelayContent:
        """Return the same over another number of steps: split exactly, or joined by their means.

        Examples
        --------
        A quantity that rises from 0 to 1 on a straight line:

        >>> rising = DelayContent(*(np.array([value]) for value in (0.0, 0.5, 1.0)))
        >>> rising.over(2).mean.tolist(), rising.over(2).over(1).end.tolist()
        ([0.25, 0.75], [1.0])
        """
        if steps == len(self.start):
            return self
        common = math.lcm(steps, len(self.start))
        return self._split(common // len(self.start))._joined(common // steps)

    def _split(self, parts: int) -> DelayContent:
        if parts == 1:
            return self
        middle = (6.0 * self.mean - self.start - self.end) / 4.0  # by Simpson's rule

        def at(fraction: Array) -> Array:
            rest = 1.0 - fraction
            return (
                self.start[:, None] * (rest * (1.0 - 2.0 * fraction))
                + middle[:, None] * (4.0 * fraction * rest)
                + self.end[:, None] * (fraction * (2.0 * fraction - 1.0))
            )

        edges = np.arange(parts + 1) / parts
        first, half, last = (at(each) for each in (edges[:-1], edges[:-1] + 0.5 / parts, edges[1:]))
        return DelayContent(
            first.ravel(), ((first + 4.0 * half + last) / 6.0).ravel(), last.ravel()
        )

    def _joined(self, steps: int) -> DelayContent:
        if steps == 1:
            return self
        start, mean, end = (part.reshape(-1, steps) for part in self)
        return DelayContent(start[:, 0], mean.mean(axis=1), end[:, -1])

    def slopes(self, step: float) -> tuple[Array, Array]:
        """Return how fast it changes at the start and at the end of each step [1/s]."""
        middle = (6.0 * self.mean - self.start - self.end) / 4.0
        rising = (4.0 * middle - 3.0 * self.start - self.end) / step
        leaving = (3.0 * self.end + self.start - 4.0 * middle) / step
        return rising, leaving


def delay_content(delay: str, rings: Mapping[str, Array]) -> DelayContent | None:
    """Return what a delay holds of the rings of a state; None where they say nothing of it."""
    names = [ring_name(delay, part) for part in RING_PARTS]
    if names[0] not in rings:
        return None
    return DelayContent(*(np.asarray(rings[name], float) for name in names))
