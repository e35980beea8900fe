"""A run: the named trajectories of one loop in one scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.engine.many_points import at_many_points
from clepsydra.loop.loop_state import LoopState
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process

if TYPE_CHECKING:
    import pandas
    import xarray


@dataclass(frozen=True)
class Run:
    """What one closed loop did in one scenario.

    Parameters
    ----------
    process : Process
    controller : Controller
    scenario : Scenario
    time : ndarray [samples]
        Start of each sample [s].
    signals : tuple of Signal
        One for each trajectory.
    values : dict
        Name to trajectory [samples], in the signal's SI unit: every state "tank_1.level",
        measurement "level_1" (as the controller gets it), setpoint "level_1.setpoint", manipulated
        variable "pump_1" (held during the sample), status "pump_1.status", disturbance
        "inflow_1"; of a cascade the setpoint of an inner loop, "flow_1.inner_setpoint".
    error_estimate : float or None
        Of the error of the integration, as a fraction of the state's range, see
        `clepsydra.loop.step_size`; None where it was not asked for.
    substeps : int
        RK4 steps in one sample; 0 for the reference solver.
    final_state : LoopState
        Where it stands after its last sample, from which another run can go on.

    Examples
    --------
    The first setpoint step of the quadruple tank ends 1 V higher:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant))
    >>> level = run.true_measurement("level_1")
    >>> round(float(level[659] - level[0]), 3), run.to_pandas()["pump_1"].size == run.time.size
    (1.0, True)
    """

    process: Process
    controller: Controller
    scenario: Scenario
    time: np.ndarray
    signals: tuple[Signal, ...]
    values: dict[str, np.ndarray]
    error_estimate: float | None
    substeps: int
    final_state: LoopState

    def true_measurement(self, name: str) -> np.ndarray:
        """Return what a sensor without noise, resolution and limits would read [samples]."""
        position = [y.name for y in self.process.measurements].index(name)
        states = np.array([self.values[x.name] for x in self.process.state])
        return at_many_points(self.process.measure, [states, self.process.parameter_values])[
            position
        ]

    def limits(self, name: str) -> tuple[float, float]:
        """Return between which values an input can move: the narrower of actuator and controller.

        Parameters
        ----------
        name : str
            Of the input.
        """
        signal = self.process.signal(name)
        if name not in self.controller.manipulated:
            return signal.low, signal.high
        own = owners(self.controller.law.outputs, "out")[self.controller.manipulated.index(name)]
        values = self.controller.values
        low = max(signal.low, values.get(path(own, "low_limit"), -math.inf))
        high = min(signal.high, values.get(path(own, "high_limit"), math.inf))
        # Limits that leave no room are none that a signal could stand between.
        return (low, high) if low < high else (signal.low, signal.high)

    @property
    def samples(self) -> int:
        """How many sampling periods it lasts."""
        return self.scenario.samples

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with one row a sample, indexed by time [s], one column a signal."""
        import pandas

        return pandas.DataFrame(self.values, index=pandas.Index(self.time, name="time"))

    def to_xarray(self) -> xarray.Dataset:
        """Return a dataset over time [s]; each variable carries its unit and description."""
        about = {"process": self.process.name, "controller": self.controller.name}
        return dataset(self.signals, self.values, self.time, about)


def dataset(
    signals: Sequence[Signal],
    values: Mapping[str, np.ndarray],
    time: np.ndarray,
    about: Mapping[str, str],
) -> xarray.Dataset:
    """Return trajectories over time [s] with their units and descriptions."""
    import xarray

    variables = {
        signal.name: (
            "time",
            values[signal.name],
            {"units": signal.unit, "long_name": signal.description or signal.name},
        )
        for signal in signals
    }
    coordinates = {"time": ("time", time, {"units": "s"})}
    return xarray.Dataset(variables, coords=coordinates, attrs=dict(about))
