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

    def sensitivities(self, points: np.ndarray) -> np.ndarray:
        """Return max|S| of all loops together at points [n, p]; infinite if unstable."""
        known = self._memory.sensitivities
        keys = [point.tobytes() for point in points]
        new = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
        loops = dict(zip(new, self._loops(list(new.values())), strict=True))
        known.update((key, math.inf) for key, loop in loops.items() if loop is None)
        made = {key: loop for key, loop in loops.items() if loop is not None}
        known.update(zip(made, sensitivity_peaks([*made.values()]), strict=True))
        return np.array([known[key] for key in keys])

    def damping(self, point: np.ndarray) -> float:
        """Return the smallest damping ratio of the loops at one point [p]; below 0 if unstable."""
        return self._swinging(point)[0]

    def decay_time(self, point: np.ndarray) -> float:
        """Return in which time the slowest mode of the loops comes down to a hundredth [s]."""
        return self._swinging(point)[1] * self._period

    def rooms(self, points: np.ndarray, sensitivity_limit: float) -> np.ndarray:
        """Return the room to the limits of the linear loops [n, limits], as shares.

        It is below 0 beyond a limit. Of max|S| that of 1/S is told, since it goes to zero, not to
        infinity, where a loop gets unstable.
        """
        found, limits = [], self._limits
        if math.isfinite(sensitivity_limit):
            found.append(sensitivity_limit / self.sensitivities(points) - 1.0)
        if limits.damping > 0.0:
            found.append(np.array([self.damping(p) / limits.damping - 1.0 for p in points]))
        if math.isfinite(limits.rest):
            left = np.array([1.0 - self.decay_time(p) / limits.rest for p in points])
            found.append(np.maximum(-1.0, left))
        return np.reshape(found, (len(found), len(points))).T

    def _swinging(self, point: np.ndarray) -> tuple[float, float]:
        key = point.tobytes()
        if key not in self._modes:
            (loop,) = self._loops([point])
            self._modes[key] = (-1.0, math.inf) if loop is None else (loop.damping, loop.decay)
        return self._modes[key]

    def _loops(self, points: Sequence[np.ndarray]) -> list[SampledLoop | None]:
        """Return the loop at each point [p]; None where there is no controller."""
        if not points:
            return []
        columns = self._space.values_at(np.array(points))
        usable = np.all([np.isfinite(column) for column in columns.values()], axis=0)
        own, rows = self._space.controller.values, zip(*columns.values(), strict=True)
        return [
            self.sampled.at({**own, **dict(zip(columns, row, strict=True))}) if there_is else None
            for row, there_is in zip(rows, usable, strict=True)
        ]
