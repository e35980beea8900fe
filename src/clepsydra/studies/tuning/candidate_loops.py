"""What the linear loops of candidates are worth, each looked at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.designs.sampled.sampled_loop import SampledLoop, SampledLoops
from clepsydra.designs.sampled.sensitivity_peaks import sensitivity_peaks
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.studies.tuning.memory import Memory
from clepsydra.studies.tuning.objective import Limits
from clepsydra.studies.tuning.search_space import SearchSpace

#: Of so many candidates the peak of one is looked for, before those that can still have less.
_LOOKED_FOR = 12
#: By this share a peak may be told lower than it is.
_ROUNDING = 1e-6


class CandidateLoops:
    """The sampled loops of candidates at points of a space.

    Parameters
    ----------
    space : SearchSpace
    model : LinearModel
        At the operating point where a scenario begins.
    limits : Limits
    memory : Memory
        Where max|S| is kept.
    """

    def __init__(
        self, space: SearchSpace, model: LinearModel, limits: Limits, memory: Memory
    ) -> None:
        self.sampled = SampledLoops(space.controller, model)
        self._space, self._limits, self._memory = space, limits, memory
        self._period = operating_point_of(model).process.sampling_period
        self._modes: dict[bytes, tuple[float, float]] = {}
        self._angles: list[float] = []

    def sensitivities(self, points: np.ndarray) -> np.ndarray:
        """Return max|S| of all loops together at points [n, p]; infinite if unstable."""
        known = self._memory.sensitivities
        keys = [point.tobytes() for point in points]
        new = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
        peaks = np.full(len(new), np.inf)
        for places, loops in self._loops([*new.values()]):
            peaks[places], angles = sensitivity_peaks(loops)
            self._angles += angles[np.isfinite(angles)].tolist()
        known.update(zip(new, peaks.tolist(), strict=True))
        return np.array([known[key] for key in keys])

    def falling_sensitivities(self, points: np.ndarray) -> np.ndarray:
        """Return max|S| at points [n, p]; infinite also where it is no lower than at one before.

        The peaks of a few and a look at all others where those stand spare most of the search.
        """
        known = self._memory.sensitivities
        new = np.flatnonzero([point.tobytes() not in known for point in points])
        left = np.delete(new, np.s_[::_LOOKED_FOR])
        found = np.full(len(points), np.inf)
        first = np.delete(np.arange(len(points)), left)
        found[first] = self.sensitivities(points[first])
        if self._angles:
            lowest = np.minimum.accumulate(found)
            left = left[self._can_be_below(lowest[left], points[left])]
        found[left] = self.sensitivities(points[left])
        return found

    def decay_times(self, points: np.ndarray) -> np.ndarray:
        """Return in which time the slowest mode at points [n, p] comes down to a hundredth [s]."""
        return self._swinging(points)[1] * self._period

    def rooms(self, points: np.ndarray, sensitivity_limit: float) -> np.ndarray:
        """Return the room to the limits of the linear loops [n, limits], as shares.

        It is below 0 beyond a limit. Of max|S| that of 1/S is told, since it goes to zero, not to
        infinity, where a loop gets unstable.
        """
        found, limits = [], self._limits
        if math.isfinite(sensitivity_limit):
            found.append(sensitivity_limit / self.sensitivities(points) - 1.0)
        if limits.damping > 0.0:
            found.append(self._swinging(points)[0] / limits.damping - 1.0)
        if math.isfinite(limits.rest):
            left = 1.0 - self.decay_times(points) / limits.rest
            found.append(np.maximum(-1.0, left))
        return np.reshape(found, (len(found), len(points))).T

    def _swinging(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the least damping ratio, below 0 if unstable, and the decay in samples [n]."""
        known = self._modes
        keys = [point.tobytes() for point in points]
        new = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
        modes = [(-1.0, math.inf)] * len(new)
        for places, loops in self._loops([*new.values()]):
            for place, loop in zip(places, map(SampledLoop, *loops), strict=True):
                modes[place] = loop.damping, loop.decay
        known.update(zip(new, modes, strict=True))
        damping, decay = np.reshape([known[key] for key in keys], (-1, 2)).T
        return damping, decay

    def _can_be_below(self, bounds: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return at which points [n, p] max|S| can be below a bound [n], by |S| at one angle."""
        can = np.zeros(len(points), bool)
        for places, loops in self._loops([*points]):
            stable = loops.are_stable
            angles = np.full((np.count_nonzero(stable), 1), np.median(self._angles))
            gains = np.linalg.svd(loops.among(stable).response(angles), compute_uv=False)[:, 0, 0]
            can[places[stable]] = gains < bounds[places[stable]] * (1.0 + _ROUNDING)
        return can

    def _loops(self, points: Sequence[np.ndarray]) -> list[tuple[np.ndarray, SampledLoop]]:
        """Return which of the points [p] have loops, and stacks of these."""
        if not points:
            return []
        columns = self._space.values_at(np.array(points))
        usable = np.flatnonzero(np.all([np.isfinite(each) for each in columns.values()], axis=0))
        values = {name: column[usable] for name, column in columns.items()}
        stacks = self.sampled.each({**self._space.controller.values, **values})
        return [(usable[places], loops) for places, loops in stacks]
