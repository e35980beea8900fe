"""The trajectories of a run, as its scores read them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from clepsydra.scores.marks import samples_of
from clepsydra.scores.plant import PlantTrajectories
from clepsydra.scores.segment import Segment
from clepsydra.scores.trajectory import FloatArray


@dataclass(frozen=True, eq=False)
class ScoredRun:
    """The trajectories of a run as its scores read them.

    Parameters
    ----------
    time : ndarray [n]
        Start of each sample [s].
    setpoints : mapping
        Controlled variable y to its setpoint [n].
    outputs : mapping
        The same names to the true trajectory [n], without measurement noise.
    inputs : mapping
        Manipulated variable u to its trajectory [n], held during each sample.
    input_limits : mapping
        The same names to (low, high).
    segments : sequence of Segment
        What happened when.
    measured : mapping, optional
        The names of the setpoints to what the controller got [n], with noise.
    plant : PlantTrajectories
        What the run says of pumps and tanks, see `clepsydra.scores.plant`.
    followed : collection of str, optional
        The controlled variables whose setpoints the controller follows; all if omitted. A
        controller that starts and stops pumps at levels follows none.
    movable : mapping
        Manipulated variable u to the limits between which the controller moves it, where these
        are narrower than `input_limits`: the time in saturation is that at them.
    inner : mapping
        Measurement of an inner loop to its setpoint [n] and the limits of that.
    """

    time: FloatArray
    setpoints: Mapping[str, FloatArray]
    outputs: Mapping[str, FloatArray]
    inputs: Mapping[str, FloatArray]
    input_limits: Mapping[str, tuple[float, float]]
    segments: Sequence[Segment] = ()
    measured: Mapping[str, FloatArray] | None = None
    plant: PlantTrajectories = field(default_factory=PlantTrajectories)
    followed: Collection[str] | None = None
    movable: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    inner: Mapping[str, tuple[FloatArray, float, float]] = field(default_factory=dict)

    @property
    def noise(self) -> list[slice]:
        """The samples of the segments in which nothing but noise is."""
        return self._of_kind("noise")

    @property
    def loads(self) -> list[slice]:
        """The samples in which loads act."""
        return self._of_kind("load")

    @cached_property
    def _samples(self) -> dict[Segment, slice]:
        """The samples of each segment, the one at its stop included, found once for all scores."""
        return {segment: samples_of(self.time, segment) for segment in self.segments}

    def _of_kind(self, kind: str) -> list[slice]:
        return [samples_of(self.time, s, with_stop=False) for s in self.segments if s.kind == kind]

    def limits(self, name: str) -> tuple[float, float]:
        """Return the limits between which a manipulated variable is moved."""
        return self.movable.get(name, self.input_limits[name])

    def of_range(self, score: Callable[..., float], name: str) -> float | None:
        """Return a score of a manipulated variable in its range; None where that is open."""
        low, high = self.input_limits[name]
        return score(self.time, self.inputs[name], low, high) if math.isfinite(high - low) else None

    def worst(
        self, score: Callable[..., float], responses: Iterable[tuple[Any, ...]], *more: float
    ) -> float | None:
        """Return the largest score of some responses; None where there is none."""
        return max((score(*response, *more) for response in responses), default=None)

    def steps(
        self, name: str, *, measured: bool = False
    ) -> list[tuple[FloatArray, FloatArray, float, float]]:
        """Return time, output, and setpoint before and after, of each setpoint step followed."""
        seen = self.measured if measured else self.outputs
        if seen is None or (self.followed is not None and name not in self.followed):
            return []
        found = []
        for segment in self._own_steps(name):
            samples = self._samples[segment]
            target = float(self.setpoints[name][samples.start])
            start = target - segment.size
            found.append((self.time[samples], seen[name][samples], start, target))
        return found

    def _own_steps(self, name: str) -> list[Segment]:
        return [s for s in self.segments if (s.kind, s.signal) == ("setpoint", name)]

    def largest_step(self, name: str) -> float:
        """Return the size of the largest setpoint step [signal unit]; 0 where there is none."""
        return max((abs(segment.size) for segment in self._own_steps(name)), default=0.0)

    def responses(
        self, name: str, kinds: Collection[str] = ("setpoint", "load")
    ) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
        """Return time, setpoint and output in each step's segment."""
        cuts = [samples for segment, samples in self._samples.items() if segment.kind in kinds]
        setpoint, output = self.setpoints[name], self.outputs[name]
        return [(self.time[cut], setpoint[cut], output[cut]) for cut in cuts]

    def load_responses(self, name: str) -> list[tuple[FloatArray, FloatArray, float]]:
        """Return time, output and setpoint of each load step."""
        return [(t, y, float(r[0])) for t, r, y in self.responses(name, ("load",))]

    def noise_deviation(self, name: str) -> float:
        """Return the standard deviation of what the measurement adds, where there is noise.

        A scenario may have its noise in a segment of its own; the steps are then judged by it.
        """
        if self.measured is None:
            return 0.0
        noise = self.measured[name] - self.outputs[name]
        parts = np.concatenate([noise[at] for at in self.noise]) if self.noise else noise
        return float(np.std(parts)) if np.all(np.isfinite(parts)) else 0.0
