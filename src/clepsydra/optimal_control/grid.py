"""The blocks in which inputs are sought: one sample each at first, then longer and longer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.pickled_fields import PickledFields

#: So many blocks at first hold one sample each, and the segment of an event has about so many.
SINGLE, BLOCKS = 100, 250


@dataclass(frozen=True)
class Grid(PickledFields):
    """Blocks of samples, in each of which the inputs run on a straight line.

    Parameters
    ----------
    lengths : tuple of int
        Samples in each block.
    period : float
        Sampling period [s].

    Examples
    --------
    >>> grid = Grid((1, 2, 4), period=0.5)
    >>> grid.samples, grid.starts.tolist(), grid.halved().lengths
    (7, [0.0, 0.5, 1.5], (1, 1, 1, 2, 2))
    """

    lengths: tuple[int, ...]
    period: float

    @property
    def blocks(self) -> int:
        """How many blocks there are."""
        return len(self.lengths)

    @property
    def samples(self) -> int:
        """How many samples they hold."""
        return sum(self.lengths)

    @property
    def horizon(self) -> float:
        """From its begin to its end [s]."""
        return self.samples * self.period

    @cached_property
    def durations(self) -> np.ndarray:
        """How long each block lasts [s]."""
        return self.period * np.array(self.lengths, float)

    @cached_property
    def starts(self) -> np.ndarray:
        """When each block begins [s]."""
        return np.concatenate([[0.0], np.cumsum(self.durations)[:-1]])

    def halved(self) -> Grid:
        """Return the same with each block cut in two, but for those of one sample."""
        halves = ((length - length // 2, length // 2) for length in self.lengths)
        return Grid(tuple(part for pair in halves for part in pair if part), self.period)


def growing_grid(
    samples: int, within: int, period: float, *, single: int = SINGLE, blocks: int = BLOCKS
) -> Grid:
    """Return blocks of one sample that grow from one to the next at a steady rate.

    Parameters
    ----------
    samples : int
        In the horizon.
    within : int
        Samples of the stretch in which there are about so many blocks: a longer horizon has the
        same blocks there, and more of them after it.
    period : float
        Sampling period [s].
    single, blocks : int
        Blocks of one sample at first, and of all in that stretch.

    Examples
    --------
    >>> growing_grid(40, 40, 1.0).blocks, growing_grid(100_000, 100_000, 1.0).blocks
    (40, 250)
    """
    if within <= blocks:
        return Grid((1,) * samples, period)
    slow, fast = 1.0, 2.0
    while fast - slow > 1e-9:
        growth = (slow + fast) / 2
        few = len(_lengths(within, growth, single)) <= blocks
        slow, fast = (slow, growth) if few else (growth, fast)
    return Grid(tuple(_lengths(samples, fast, single)), period)


def _lengths(samples: int, growth: float, single: int) -> list[int]:
    found, length, left = [1] * min(single, samples), 1.0, samples - single
    while left > 0:
        length *= growth
        found.append(min(round(length), left))
        left -= found[-1]
    return found
