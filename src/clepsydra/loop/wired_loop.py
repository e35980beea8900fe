"""A process and a controller with the wires between them, at rest: what every run needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.arguments import require_type
from clepsydra.base.conversion import Conversion
from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import check_signals, controller_name
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.closed_loop import free_inputs, loop_inputs, wire_conversions
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process


@dataclass(frozen=True)
class WiredLoop:
    """A process under a controller, starting at rest at the operating point of its model.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Of the process at an operating point; its fastest eigenvalue sets the integration
        step. Its outputs do not count.
    fuse : bool
        Whether kernels of the loop fuse multiply-adds, where the processor does: without, the same
        bits come from every processor.

    Raises
    ------
    InputError
        The model has no operating point, the controller names signals that the process
        lacks, or the process is sampled too slowly to be simulated.
    """

    controller: Controller
    model: LinearModel
    fuse: bool = True

    def __post_init__(self) -> None:
        given = self.controller
        check_signals(
            given.measurements, given.setpoints, given.manipulated, given.name, self.process
        )
        substeps_for(self.model)

    @property
    def point(self) -> OperatingPoint:
        """Where the loop starts at rest."""
        return operating_point_of(self.model)

    @property
    def process(self) -> Process:
        """The process."""
        return self.point.process

    @property
    def substeps(self) -> int:
        """RK4 steps in a sampling period, from the fastest eigenvalue."""
        return substeps_for(self.model)

    def check(self, scenario: Scenario) -> None:
        """Refuse a scenario that is none of this process, see `run`."""
        require_type(
            scenario, Scenario, "scenario", "a Scenario", "make one, for example default_scenario"
        )
        process = self.process
        if scenario.sampling_period != process.sampling_period:
            raise InputError(
                "scenario, sampling period", f"{scenario.sampling_period} s",
                f"the sampling period of {process.name}, {process.sampling_period} s",
                "make the scenario for this process",
            )  # fmt: skip
        for what, table, width in (
            ("setpoints", scenario.setpoints, len(process.controlled)),
            ("disturbances", scenario.disturbances, len(process.disturbances)),
            ("noise", scenario.noise, len(process.measurements)),
        ):
            if table.shape != (scenario.samples, width):
                raise InputError(
                    f"scenario, {what}", list(table.shape), f"[{scenario.samples}, {width}]",
                    f"give one column for each of the {width} signals",
                )  # fmt: skip

    def inputs_of(self, scenario: Scenario) -> dict[str, np.ndarray]:
        """Return the inputs of the closed loop in a scenario by name [samples]."""
        process = self.process
        return {
            **{f"{n}.setpoint": scenario.setpoints[:, i] for i, n in enumerate(process.controlled)},
            **{d.name: scenario.disturbances[:, i] for i, d in enumerate(process.disturbances)},
            **{f"{y.name}.noise": scenario.noise[:, i] for i, y in enumerate(process.measurements)},
        }

    def initial_state(self) -> dict[str, float]:
        """Return the initial state of the closed loop by name: everything at rest."""
        return {
            **motion_at_rest(self.point),
            **{controller_name(k): v for k, v in self.controller.initial_state.items()},
        }

    def law_parameters(self) -> dict[str, float]:
        """Return the parameters of the step law by their names in the closed loop."""
        return {controller_name(k): v for k, v in self.controller.values.items()}

    def at_rest(self) -> dict[str, float]:
        """Return the inputs of the closed loop at the operating point, in automatic."""
        at = self.point.as_dict()
        every = (*loop_inputs(self.process), *free_inputs(self.controller))
        values = {signal.name: signal.initial for signal in every}
        values |= {f"{name}.setpoint": at[name] for name in self.process.controlled}
        values |= {d.name: at[d.name] for d in self.process.disturbances}
        for u in self.process.inputs:
            values |= {f"{u.name}.manual": at[u.name], f"{u.name}.tracking": at[u.name]}
        return values

    def law_inputs(self, now: Mapping[str, ArrayLike]) -> np.ndarray:
        """Return the inputs of the step law from the loop's signals by name.

        Parameters
        ----------
        now : mapping
            Signal to its value, or to that in each of several cases [cases].

        Returns
        -------
        ndarray [m] or [m, cases]
        """
        wires = self.controller.input_wires
        given = {name: self._passed(name, np.asarray(now[wire])) for name, wire in wires.items()}
        given["time_step"] = np.asarray(self.process.sampling_period)
        inputs = [given[signal.name] for signal in self.controller.law.inputs]
        return np.array(np.broadcast_arrays(*inputs))

    def told_by_law(self, outputs: np.ndarray) -> dict[str, float]:
        """Return the loop's signals by name from the outputs of the step law."""
        wires = self.controller.output_wires
        return {
            wires[signal.name]: self._passed(signal.name, float(value))
            for signal, value in zip(self.controller.law.outputs, outputs, strict=True)
        }

    def _passed(self, name: str, value: Any) -> Any:
        return self._ways[name](value) if name in self._ways else value

    @cached_property
    def _ways(self) -> dict[str, Conversion]:
        return wire_conversions(self.controller, self.process)
