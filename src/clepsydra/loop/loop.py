"""A loop: a process under a controller, and its runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.reference import LawEvaluation, ReferenceIntegrator
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.closed_loop import closed_loop, controller_name, loop_inputs
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process

Solver = Literal["kernel", "reference"]

#: The error that a run may have, as a fraction of the state's range, before its step is halved.
_TOLERANCE = 1e-6
_LARGEST_REFINEMENT = 64


@dataclass(frozen=True)
class Loop:
    """A process under a controller, starting at rest at an operating point.

    Parameters
    ----------
    process : Process
    controller : Controller
    point : OperatingPoint
    model : LinearModel
        At that point; its fastest eigenvalue sets the integration step.
    """

    process: Process
    controller: Controller
    point: OperatingPoint
    model: LinearModel

    @property
    def substeps(self) -> int:
        """RK4 steps in a sampling period, from the fastest eigenvalue."""
        return substeps_for(self.model.A, self.process.sampling_period)

    def run(
        self, scenario: Scenario, *, solver: Solver = "kernel", substeps: int | None = None
    ) -> Run:
        """Simulate the loop in a scenario.

        Parameters
        ----------
        scenario : Scenario
            On the sampling period of the process.
        solver : {"kernel", "reference"}
            The compiled kernel with RK4, or CVODES with the law evaluated by CasADi.
        substeps : int, optional
            RK4 steps in a sampling period; chosen from the fastest eigenvalue if omitted.

        Raises
        ------
        InputError
            The scenario has another sampling period, or signals that the process lacks.
        """
        self._check(scenario)
        if solver == "reference":
            return self._collect(scenario, self._by_reference(scenario), substeps=0)
        count = self.substeps if substeps is None else substeps
        return self._collect(scenario, self._by_kernel(scenario, count), substeps=count)

    def run_checked(self, scenario: Scenario) -> Run:
        """Simulate, estimate the error by halving the step, and refine until it is small.

        The estimate is the largest difference between the two runs, as a fraction of each
        state's range; the steps are halved until it is below 1e-6, or 64 times as many
        have been tried. The run with the smaller step is returned.
        """
        count = self.substeps
        coarse = self.run(scenario, substeps=count)
        while True:
            fine = self.run(scenario, substeps=2 * count)
            estimate = self._difference(coarse, fine)
            count *= 2
            if estimate <= _TOLERANCE or count >= _LARGEST_REFINEMENT * self.substeps:
                return replace(fine, error_estimate=estimate)
            coarse = fine

    def _difference(self, coarse: Run, fine: Run) -> float:
        spans = {
            signal.name: signal.high - signal.low
            for signal in self.process.state
            if np.isfinite(signal.high - signal.low)
        }
        return max(
            float(np.max(np.abs(coarse.values[name] - fine.values[name])) / span)
            for name, span in spans.items()
        )

    def _check(self, scenario: Scenario) -> None:
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

    def _inputs(self, scenario: Scenario) -> dict[str, np.ndarray]:
        process = self.process
        return {
            **{f"{n}.setpoint": scenario.setpoints[:, i] for i, n in enumerate(process.controlled)},
            **{d.name: scenario.disturbances[:, i] for i, d in enumerate(process.disturbances)},
            **{f"{y.name}.noise": scenario.noise[:, i] for i, y in enumerate(process.measurements)},
        }

    def _by_kernel(self, scenario: Scenario, substeps: int) -> dict[str, np.ndarray]:
        given = self._inputs(scenario)
        constant = {s.name: s.initial for s in loop_inputs(self.process) if s.name not in given}
        program = closed_loop(self.process, self.controller, substeps=substeps, constant=constant)
        result = Kernel(program).run(
            scenario.samples,
            inputs=given,
            state=self.initial_state(),
            parameters={controller_name(k): v for k, v in self.controller.values.items()},
        )
        return {signal.name: result.output(signal.name)[0] for signal in program.outputs}

    def initial_state(self) -> dict[str, float]:
        """Return the initial state of the closed loop by name: everything at rest."""
        return {
            **{x.name: float(v) for x, v in zip(self.process.state, self.point.state, strict=True)},
            **{controller_name(k): v for k, v in self.controller.initial_state.items()},
        }

    def _by_reference(self, scenario: Scenario) -> dict[str, np.ndarray]:
        process, controller, law = self.process, self.controller, self.controller.law
        at_rest = {s.name: s.initial for s in loop_inputs(process)}
        parameters = process.parameter_values
        scale = max(x.high for x in process.state)
        advance = ReferenceIntegrator(process.dynamics, process.sampling_period, scale)
        evaluation = LawEvaluation(
            law,
            np.array([controller.values[p.name] for p in law.parameters]),
            np.array([controller.initial_state[x.name] for x in law.state]),
        )
        names = [u.name for u in process.inputs]
        order = [names.index(name) for name in controller.manipulated]
        state = self.point.state
        rows = []
        for k in range(scenario.samples):
            true = np.array(process.measure(state, parameters)).ravel()
            measured = dict(
                zip((y.name for y in process.measurements), true + scenario.noise[k], strict=True)
            )
            setpoints = dict(zip(process.controlled, scenario.setpoints[k], strict=True))
            outputs = evaluation.step(self._law_inputs(measured, setpoints, at_rest))
            by_name = dict(zip((s.name for s in law.outputs), outputs, strict=True))
            moved = np.empty(len(names))
            statuses = []
            for number, place in enumerate(order, 1):
                moved[place] = by_name[f"manipulated_{number}"]
                statuses.append(by_name[f"status_{number}"])
            rows.append([*state, *measured.values(), *moved, *statuses])
            state = advance(state, moved, scenario.disturbances[k], parameters)
        columns = [
            *(x.name for x in process.state),
            *(y.name for y in process.measurements),
            *names,
            *(f"{name}.status" for name in controller.manipulated),
        ]
        return dict(zip(columns, np.array(rows).T, strict=True))

    def _law_inputs(
        self, measured: dict[str, float], setpoints: dict[str, float], at_rest: dict[str, float]
    ) -> np.ndarray:
        controller = self.controller
        wires = {"time_step": self.process.sampling_period}
        for number, name in enumerate(controller.measurements, 1):
            wires[f"measurement_{number}"] = measured[name]
            wires[f"sensor_{number}"] = at_rest[f"{name}.sensor"]
        for number, name in enumerate(controller.setpoints, 1):
            wires[f"setpoint_{number}"] = setpoints[name]
        for number, name in enumerate(controller.manipulated, 1):
            for what in ("mode", "manual", "tracking"):
                wires[f"{what}_{number}"] = at_rest[f"{name}.{what}"]
        return np.array([wires[signal.name] for signal in controller.law.inputs])

    def _collect(
        self, scenario: Scenario, computed: dict[str, np.ndarray], *, substeps: int
    ) -> Run:
        process = self.process
        statuses = [f"{name}.status" for name in self.controller.manipulated]
        given = self._inputs(scenario)
        setpoints = [f"{name}.setpoint" for name in process.controlled]
        signals = (
            *process.state,
            *process.measurements,
            *(s for s in loop_inputs(process) if s.name in setpoints),
            *process.inputs,
            *(Signal(name, kind="integer") for name in statuses),
            *process.disturbances,
        )
        values = {s.name: computed.get(s.name, given.get(s.name)) for s in signals}
        return Run(
            process=process,
            controller=self.controller,
            scenario=scenario,
            time=scenario.time,
            signals=signals,
            values={name: np.asarray(value) for name, value in values.items()},
            error_estimate=None,
            substeps=substeps,
        )
