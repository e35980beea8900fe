"""Collocation with three points of Radau's in each block: order five, and stiffly accurate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.optimal_control.grid import Grid

#: Collocation points in a block: Radau's, the last of which is its end.
POINTS = 3


@dataclass(frozen=True)
class Collocation:
    """The numbers of a method of three points in each block of a grid.

    L. T. Biegler, Nonlinear Programming, SIAM, 2010, chapter 10, doi 10.1137/1.9780898719383.

    Parameters
    ----------
    grid : Grid

    Examples
    --------
    The polynomial t³ over a block of two seconds is met without an error:

    >>> rule = Collocation(Grid((2,), period=1.0))
    >>> time = rule.times
    >>> rates = np.hstack([0.0, time**3]) @ np.array(rule.differences) / rule.durations
    >>> bool(np.allclose(rates, 3.0 * time**2)), round(float(rule.parts_of_time @ time**3), 9)
    (True, 4.0)
    """

    grid: Grid

    @cached_property
    def shares(self) -> np.ndarray:
        """Where in a block the points are, the last at its end [3]."""
        return np.array(ca.collocation_points(POINTS, "radau"))

    @cached_property
    def _coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        slopes, _, quadrature = ca.collocation_coeff(self.shares.tolist())
        return np.array(slopes), np.array(quadrature).ravel()

    @property
    def quadrature(self) -> np.ndarray:
        """What each point weighs in an integral over a block of one second [3]."""
        return self._coefficients[1]

    @property
    def columns(self) -> int:
        """How many points there are in all blocks."""
        return POINTS * self.grid.blocks

    @cached_property
    def times(self) -> np.ndarray:
        """When the points are [s]."""
        return point_times(self.grid, self.shares)

    @cached_property
    def durations(self) -> np.ndarray:
        """How long the block of each point lasts [s]."""
        return np.repeat(self.grid.durations, POINTS)

    @cached_property
    def parts_of_time(self) -> np.ndarray:
        """How long each point stands for [s]."""
        return np.outer(self.grid.durations, self.quadrature).ravel()

    @cached_property
    def ramp(self) -> np.ndarray:
        """The share of a block's way at its points; 0 in one of one sample, which is held."""
        long = np.array(self.grid.lengths) > 1
        return (long[:, None] * self.shares).ravel()

    @cached_property
    def differences(self) -> ca.DM:
        """The matrix from values at the begin and the points to slopes times duration."""
        slopes, blocks = self._coefficients[0], self.grid.blocks
        found = ca.DM(1 + self.columns, self.columns)
        for b in range(blocks):
            at = POINTS * b
            found[at : at + POINTS + 1, at : at + POINTS] = slopes
        return found

    @cached_property
    def error_weights(self) -> tuple[np.ndarray, float]:
        """What the error at each point weighs in an integral, and the first error of all [s].

        It is the trapezoidal rule over the ends of blocks of one sample, as runs are scored, and
        Radau's quadrature in longer ones.
        """
        weights, first = np.zeros(self.columns), 0.0
        for b, (length, duration) in enumerate(
            zip(self.grid.lengths, self.grid.durations, strict=True)
        ):
            if length > 1:
                weights[POINTS * b : POINTS * (b + 1)] += duration * self.quadrature
                continue
            weights[POINTS * (b + 1) - 1] += duration / 2
            if b:
                weights[POINTS * b - 1] += duration / 2
            else:
                first = duration / 2
        return weights, first

    def along(self, blocks: Sequence[int], weights: np.ndarray) -> ca.DM:
        """Return the matrix from values of some blocks to their points, weighted."""
        found = ca.DM(len(blocks), self.columns)
        for row, b in enumerate(blocks):
            for column in range(POINTS * b, POINTS * (b + 1)):
                found[row, column] = weights[column]
        return found

    def earlier(self, delay: float) -> tuple[ca.DM, np.ndarray]:
        """Return the matrix from values at the points to those one delay earlier.

        Beside it stands at which points that was before the begin.
        """
        grid = self.grid
        taken, before = ca.DM(self.columns, self.columns), np.zeros(self.columns)
        for column, time in enumerate(self.times - delay):
            if time <= 0.0:
                before[column] = 1.0
                continue
            b = int(np.searchsorted(grid.starts, time, side="left")) - 1
            share = (time - grid.starts[b]) / grid.durations[b]
            taken[POINTS * b : POINTS * (b + 1), column] = self._lagrange(share)
        return taken, before

    def _lagrange(self, share: float) -> np.ndarray:
        """Return the weights of the values at the points of a block for a place in it."""
        found = np.ones(POINTS)
        for i, at in enumerate(self.shares):
            for j, other in enumerate(self.shares):
                if i != j:
                    found[i] *= (share - other) / (at - other)
        return found

    @cached_property
    def samples(self) -> np.ndarray:
        """In which sample each point is; the end of a block is in its last."""
        within = np.minimum(self.times, self.grid.horizon)
        found = np.ceil(within / self.grid.period - 1e-6).astype(int) - 1
        return np.clip(found, 0, self.grid.samples - 1)


def point_times(grid: Grid, shares: np.ndarray) -> np.ndarray:
    """Return when the collocation points of a grid are [s]."""
    return (grid.starts[:, None] + grid.durations[:, None] * shares).ravel()
