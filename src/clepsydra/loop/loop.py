"""A loop: a process under a controller, and its runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.signal import Signal
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.wiring import controller_name
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.trajectories import Trajectories
from clepsydra.loop.alarms import alarm_signals
from clepsydra.loop.closed_loop import closed_loop, loop_inputs
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.law_begin import loop_begin
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.loop.loop_state import LoopState, loop_state
from clepsydra.loop.motion_block import recorded_signals, steps_told
from clepsydra.loop.run import Run
from clepsydra.loop.run_cost import weigh_run
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.shown_levels import shown_levels
from clepsydra.loop.step_size import (
    FEWEST_REFINEMENT,
    LARGEST_REFINEMENT,
    TOLERANCE,
    Solver,
    check_solver,
    refined,
)
from clepsydra.loop.stepped_loop import stepped_loop
from clepsydra.loop.wired_loop import WiredLoop
from clepsydra.program.precision import Precision, in_single_arithmetic
from clepsydra.scores.plant_flows import forced_flows


class Loop(WiredLoop):
    """A process under a controller, and its runs.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("quadruple-tank")
    >>> loop = Loop(cl.design.simc(plant), plant.linear)
    >>> run = loop.run(default_scenario(plant.linear))
    >>> round(float(run.true_measurement("level_1")[659] - run.true_measurement("level_1")[0]), 3)
    1.0
    """

    def run(
        self,
        scenario: Scenario,
        *,
        solver: Solver = "kernel",
        substeps: int | None = None,
        precision: Precision = "double",
    ) -> Run:
        """Simulate the loop in a scenario.

        Parameters
        ----------
        scenario : Scenario
            On the sampling period of the process.
        solver : {"kernel", "reference"}
            The compiled kernel with RK4 (a law in Python stands beside it, sample by sample), or
            CVODES with the law evaluated by CasADi and switches located by SciPy's DOP853.
        substeps : int, optional
            RK4 steps in a sampling period; chosen from the fastest eigenvalue if omitted.
        precision : {"double", "single"}
            Of the controller alone: "single" is a PLC that computes in REAL, with the bits of the C
            that is exported in single precision (see
            `clepsydra.program.precision.in_single_arithmetic`), and always runs in the kernel.

        Raises
        ------
        InputError
            The scenario has another sampling period, or signals that the process lacks; the
            solver is unknown; or a number of the law is outside single precision.
        """
        self.check(scenario)
        check_solver(solver)
        count = self.substeps if substeps is None else substeps
        weigh_run(self.process, scenario.samples, count, checked=False, solver=solver)
        return self._run(scenario, count, solver, precision)

    def _run(
        self,
        scenario: Scenario,
        count: int,
        solver: Solver = "kernel",
        precision: Precision = "double",
    ) -> Run:
        if precision == "single":
            law = in_single_arithmetic(self.controller.program())
            told = {controller_name(each.name): each.initial for each in law.parameters}
            kernel = Kernel(
                closed_loop(
                    self.process, self.controller, substeps=count,
                    constant=self.fixed(scenario), alarms=True, law=law,
                ),
                fuse=self.fuse,
            )  # fmt: skip
            (run,) = self._by_kernel(scenario, kernel, [count], told, rounded=True)
            return run
        if solver == "reference" or isinstance(self.controller.law, PythonLaw):
            found, final = stepped_loop(self, scenario, count, solver)
            steps = 0 if solver == "reference" else count
            return self._collect(scenario, found, final, substeps=steps)
        (run,) = self._by_kernel(scenario, self._kernel(scenario, count), [count], {})
        return run

    def run_checked(
        self, scenario: Scenario, largest: int = LARGEST_REFINEMENT, made: Iterable[Run] = ()
    ) -> Run:
        """Simulate, estimate the error by halving the step, and refine until it is small.

        The estimate is on the safe side, see `clepsydra.loop.step_size.refined`, and a fraction
        of each state's range; the steps are halved until it is below 1e-6, `largest` times as
        many have been tried, or a sampling period would hold more than 10,000. The run with the
        smallest step is returned, which is no longer than that of the run from whose end it goes
        on. Some runs may be `made` already, see `clepsydra.loop.several_loops`.
        """
        first = self.first_count(scenario)
        self.check(scenario)
        weigh_run(self.process, scenario.samples, first)
        known = {run.substeps: run for run in made}

        def run(count: int) -> Run:
            if count not in known:
                alone = known or not self.side_by_side
                wanted = [count] if alone else [count, 2 * count, 4 * count]
                known.update(zip(wanted, self.runs(scenario, wanted), strict=True))
            return known[count]

        found, estimate = refined(self.process, run, first, TOLERANCE, largest)
        return replace(found, error_estimate=estimate)

    def first_count(self, scenario: Scenario) -> int:
        """Return the steps in a sampling period with which an estimate of the error begins."""
        begins = 1 if scenario.begin is None else scenario.begin.substeps // FEWEST_REFINEMENT
        return max(self.substeps, begins)

    def runs(self, scenario: Scenario, counts: Sequence[int]) -> list[Run]:
        """Simulate with each of several numbers of steps in a sampling period.

        They run side by side where they can, in the kernel that any estimate of the error takes:
        a run in another scenario is then made without compiling another one.
        """
        if not self.side_by_side:
            return [self._run(scenario, count) for count in counts]
        told = steps_told(self.process.sampling_period, counts)
        return self._by_kernel(scenario, self.refining_kernel(scenario), counts, told)

    def refining_kernel(self, scenario: Scenario) -> Kernel:
        """Return the kernel of runs that are told their steps; loops of one law have one."""
        return self._kernel(scenario, self.substeps, adjustable=True)

    @property
    def side_by_side(self) -> bool:
        """Whether runs with different steps can stand side by side."""
        return not (isinstance(self.controller.law, PythonLaw) or self.process.motion.delays)

    def _kernel(self, scenario: Scenario, substeps: int, *, adjustable: bool = False) -> Kernel:
        fixed = self.fixed(scenario)
        return loop_kernel(
            self.process, self.controller, fixed, substeps, adjustable=adjustable, fuse=self.fuse
        )

    def fixed(self, scenario: Scenario) -> dict[str, float]:
        """Return the inputs of the loop that a scenario says nothing of, at rest."""
        given = self.inputs_of(scenario)
        return {name: value for name, value in self.at_rest().items() if name not in given}

    def _by_kernel(
        self,
        scenario: Scenario,
        kernel: Kernel,
        counts: Sequence[int],
        told: Mapping[str, ArrayLike],
        *,
        rounded: bool = False,
    ) -> list[Run]:
        """Return a run for each number of steps in a sampling period, made side by side."""
        state, rings = loop_begin(self, scenario, counts[0])
        if rounded:  # as a controller in single precision holds them
            own = {controller_name(entry.name) for entry in self.controller.law.state}
            state |= {name: float(np.float32(state[name])) for name in own}
        result = kernel.run(
            scenario.samples,
            inputs=self.inputs_of(scenario),
            state=state,
            rings=rings,
            parameters={**self.law_parameters(), **told},
            turns=max(counts),
        )
        return [self.run_of(scenario, result, place, count) for place, count in enumerate(counts)]

    def run_of(self, scenario: Scenario, result: Trajectories, place: int, substeps: int) -> Run:
        """Return one run of several that a kernel made."""
        program = result.program
        rows = np.ascontiguousarray(result.record_of(place).T)
        computed = {signal.name: row for signal, row in zip(program.outputs, rows, strict=True)}
        names = (entry.name for entry in program.state)
        found = dict(zip(names, result.final_state[:, place].tolist(), strict=True))
        held = {name: content[place] for name, content in result.rings().items()}
        inputs = {u.name: float(computed[u.name][-1]) for u in self.process.inputs}
        final = loop_state(self.process, self.controller, found, inputs, held, substeps)
        return self._collect(scenario, computed, final, substeps=substeps)

    def _collect(
        self,
        scenario: Scenario,
        computed: dict[str, np.ndarray],
        final: LoopState,
        *,
        substeps: int,
    ) -> Run:
        process = self.process
        statuses = [f"{name}.status" for name in self.controller.manipulated]
        given = self.inputs_of(scenario)
        setpoints = [f"{name}.setpoint" for name in process.controlled]
        signals = (
            *process.state,
            *process.measurements,
            *(s for s in loop_inputs(process) if s.name in setpoints),
            *process.inputs,
            *(Signal(name, kind="integer") for name in statuses),
            *(each.signal for each in inner_setpoints(self.controller, process)),
            *process.disturbances,
            *recorded_signals(process),
            *alarm_signals(process),
        )
        known = given | computed
        values = {s.name: np.asarray(known[s.name], float) for s in signals}
        values |= shown_levels(process, values)
        running = forced_flows(process, scenario.time, values)
        # What a controller moves is its command; what comes from elsewhere is what runs.
        values |= {d.name: running[d.name] for d in process.disturbances if d.name in running}
        return Run(
            process=process,
            controller=self.controller,
            scenario=scenario,
            time=scenario.time,
            signals=signals,
            values=values,
            error_estimate=None,
            substeps=substeps,
            final_state=final,
        )
