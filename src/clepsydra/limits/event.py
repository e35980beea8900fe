"""What is asked of the best input: setpoints and loads over a stretch that begins at rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.optimal_control.plant_model import PlantModel
from clepsydra.process.process import Process
from clepsydra.scores.segment import Segment


@dataclass(frozen=True, eq=False)
class Event:
    """A setpoint step, or a ramp, from rest to rest.

    Parameters
    ----------
    segment : Segment
        Where it stands in its scenario.
    outputs : tuple of str
        Measurements whose error counts.
    steps : ndarray [outputs]
        Size that each error is divided by [its unit].
    start, target : OperatingPoint
        Where the plant rests before it and after it.
    setpoints : ndarray [samples, outputs]
        From its first sample on.
    disturbances : ndarray [samples, disturbances]
    bounds : mapping
        Input to the ends between which it may move, where these are narrower than its range [SI].
    overshoot : bool
        Whether the output that steps may go beyond its setpoint.
    """

    segment: Segment
    outputs: tuple[str, ...]
    steps: np.ndarray
    start: OperatingPoint
    target: OperatingPoint
    setpoints: np.ndarray
    disturbances: np.ndarray
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    overshoot: bool = True

    @property
    def process(self) -> Process:
        """The process."""
        return self.start.process

    @property
    def samples(self) -> int:
        """How many samples its segment has."""
        return len(self.setpoints)

    @property
    def sizes(self) -> tuple[tuple[str, float], ...]:
        """Each output, and what its error is divided by [its unit]."""
        return tuple(zip(self.outputs, self.steps.tolist(), strict=True))

    def held(self, values: np.ndarray, samples: int) -> np.ndarray:
        """Return a course over so many samples, which stays where it ends."""
        return values[np.minimum(np.arange(samples), len(values) - 1)]

    def model(self) -> PlantModel:
        """Return the process as the search for the best input sees it."""
        return PlantModel(
            self.start, self.target, self.outputs, self.steps, self.input_bounds(),
            self.disturbances,
        )  # fmt: skip

    def input_bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the lower and the upper ends of the inputs [inputs]."""
        ends = [self.bounds.get(u.name, (u.low, u.high)) for u in self.process.inputs]
        low, high = np.array(ends, float).T
        return low, high


def rest_at(
    point: OperatingPoint, setpoints: Mapping[str, float], disturbances: np.ndarray
) -> OperatingPoint:
    """Return where a plant rests with these setpoints.

    Where there are more inputs than setpoints, the other measurements that fix the operating point
    stay where they are, or else as many inputs stay as are left over.

    Parameters
    ----------
    point : OperatingPoint
        Where it rests now; itself where nothing is asked that it does not do.
    setpoints : mapping
        Controlled measurement to its value [SI].
    disturbances : ndarray [disturbances]

    Raises
    ------
    NoEquilibrium
        It rests nowhere.
    """
    process, at = point.process, point.as_dict()
    loads = dict(zip((d.name for d in process.disturbances), disturbances.tolist(), strict=True))
    if all(at[name] == value for name, value in (loads | dict(setpoints)).items()):
        return point
    others = {name: at[name] for name in process.nominal_outputs if name not in setpoints}
    over = len(process.inputs) - len(setpoints)
    if len(others) == over:
        return find_equilibrium(process, outputs=dict(setpoints) | others, disturbances=loads)
    refusal: NoEquilibrium | None = None
    for kept in combinations([u.name for u in process.inputs], max(over, 0)):
        still = {name: at[name] for name in kept}
        try:
            return find_equilibrium(process, still or None, dict(setpoints), loads)
        except NoEquilibrium as error:
            refusal = refusal or error
    assert refusal is not None
    raise refusal
