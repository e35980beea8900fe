"""One controller over many plants side by side, scored while they run, event by event."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError
from clepsydra.controllers.wiring import controller_name
from clepsydra.engine.batch_noise import BatchNoise, InputNoise
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.threads import available_threads
from clepsydra.engine.trajectories import Trajectories
from clepsydra.loop.closed_loop import closed_loop, true_name
from clepsydra.loop.lane_status import STEP_BOUND, LaneStatus, lane_status
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import LARGEST_REFINEMENT, MOST_SUBSTEPS
from clepsydra.loop.stretches import stretches_of
from clepsydra.loop.with_noise import quiet_disturbances
from clepsydra.process.process import Process

Array = NDArray[np.float64]

#: What tells that a run with these integration steps is no result.
_AGAIN = LaneStatus.STEP_TOO_LONG | LaneStatus.NOT_A_NUMBER


@dataclass(frozen=True, eq=False)
class BatchRun:
    """What came of a controller over many plants.

    Parameters
    ----------
    folds : dict
        Fold of a score to what it came to in each part of each stretch [parts, plants].
    status : ndarray of int [plants]
        A `LaneStatus` each.
    substeps : ndarray of int [plants]
        Integration steps in a sampling period.
    final_state : dict
        State of the loop by name to what it is at the end [plants].
    """

    folds: dict[str, Array]
    status: NDArray[np.int64]
    substeps: NDArray[np.int64]
    final_state: dict[str, Array]

    def broken(self) -> NDArray[np.bool_]:
        """Tell which ended, or were at any time, in a state that is no number [plants]."""
        return (self.status & LaneStatus.NOT_A_NUMBER) != 0

    def put(self, places: NDArray[np.int64], other: BatchRun) -> None:
        """Put what came of some plants where they belong."""
        for name, values in other.folds.items():
            self.folds[name][:, places] = values
        for name, row in other.final_state.items():
            self.final_state[name][places] = row
        self.status[places], self.substeps[places] = other.status, other.substeps


class LoopBatch:
    """A controller on plants that differ in their numbers, in one scenario.

    Each begins where `ManyPlants` has it, its law without a bump. The scenario runs in parts
    (`stretches_of`), in each of which the scores begin anew; no trajectory is stored. The
    integration step is that with which no state of the controller's own plant is wrong by a
    thousandth of its range (`clepsydra.loop.lane_status`); a plant for which it is too long runs
    again with half of it.

    Parameters
    ----------
    loop : Loop
        On the plant from which the others differ.
    scenario : Scenario
        Of all. Where a disturbance differs from plant to plant its course is moved by that.
    names : sequence of str
        Running scores, see `clepsydra.loop.running_scores.RunningScores`.

    Raises
    ------
    InputError
        The scenario is of another process, a score is unknown, or the plant itself cannot be
        simulated with as many integration steps as are allowed.

    Examples
    --------
    A first tank that is twice as wide makes the IAE of a step of 0.1 V 2.2 times as large:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.profile import Change
    >>> from clepsydra.loop.scenario import scenario_of_changes
    >>> plant = cl.load("quadruple-tank")
    >>> step = scenario_of_changes(plant.point, [Change("level_1", 6.23, 1.0, 1.0)], 200)
    >>> batch = LoopBatch(Loop(cl.design.simc(plant), plant.measured), step, ["iae[level_1]"])
    >>> rest = (np.tile(each[:, None], 2) for each in (plant.point.state, plant.point.inputs))
    >>> plants = ManyPlants(plant.point, *rest, {"tank_1.area": np.array([28e-4, 56e-4])})
    >>> batch.run(plants).folds["iae[level_1]"].sum(axis=0).round(2)
    array([0.73, 1.62])
    """

    def __init__(self, loop: Loop, scenario: Scenario, names: Sequence[str]) -> None:
        loop.check(scenario)
        self.loop, self.scenario = loop, scenario
        self.scores = RunningScores(loop.process, tuple(names))
        self.stretches = stretches_of(scenario)
        self._noise = _noise_of(loop.process, scenario)
        quiet = _without(scenario, loop.process)
        self._given = loop.inputs_of(quiet) | self.scores.inputs_of(quiet)

    def run(self, plants: ManyPlants) -> BatchRun:
        """Return the scores of every plant."""
        count = self.substeps
        found = self._run(plants, count)
        while 2 * count <= self._most:
            again = np.flatnonzero(found.status & _AGAIN)
            if not len(again):
                break
            count *= 2
            found.put(again, self._run(plants.chosen(again), count))
        return found

    def trajectories(self, plants: ManyPlants, every: int) -> dict[str, Array]:
        """Return what controlled measurements and inputs do, without noise [plants, records].

        Records are of samples 0, every, 2 every, …
        """
        process = self.loop.process
        inputs = self._inputs(plants)
        constant = self._constant(inputs)
        moving = {name: values for name, values in inputs.items() if name not in constant}
        own = tuple(name for name, values in moving.items() if values.ndim == 2)
        program = closed_loop(
            process, self.loop.controller, substeps=self.substeps, constant=constant, readings=True
        )
        moving = {n: v for n, v in moving.items() if n in {s.name for s in program.inputs}}
        result = Kernel(program, individual=own, fuse=self.loop.fuse).run(
            self.scenario.samples,
            inputs=moving,
            parameters=self._parameters(plants),
            state=plants.begin(self.loop, self.scenario),
            every=every,
            noise=self._noise_from(plants),
        )
        shown = {y: true_name(process.signal(y)) for y in process.controlled}
        shown |= {u.name: u.name for u in process.inputs}
        return {name: result.output(output) for name, output in shown.items()}

    def scores_of(self, run: BatchRun, name: str) -> Array:
        """Return a score over the whole scenario, then in each stretch [1 + stretches, plants].

        It is infinite where the run broke.
        """
        folds = [run.folds[fold] for fold in self.scores.folds(name)]
        stops = np.cumsum([len(stretch.parts) - 1 for stretch in self.stretches])
        spans = [(0, int(stops[-1])), *pairwise([0, *stops.tolist()])]
        found = np.array(
            [self.scores.joined(name, [rows[a:b] for rows in folds]) for a, b in spans]
        )
        found[:, run.broken()] = np.inf
        return found

    @property
    def operations(self) -> int:
        """Operations of a sample of one plant, about."""
        loop = self.loop
        program = closed_loop(loop.process, loop.controller, substeps=loop.substeps)
        return Kernel(program, record=False).operations

    @cached_property
    def substeps(self) -> int:
        """Integration steps in a sampling period with which every plant begins."""
        point, count = self.loop.point, self.loop.substeps
        own = ManyPlants(point, point.state[:, None], point.inputs[:, None])
        while self._run(own, count).status[0] & LaneStatus.STEP_TOO_LONG:
            if 2 * count > self._most:
                period = self.loop.process.sampling_period
                raise InputError(
                    f"batch, {self.loop.controller.name}, integration",
                    f"{count} steps in a sampling period of {period:g} s",
                    f"steps so short that no state is wrong by {100.0 * STEP_BOUND:g} % of its "
                    "range",
                    "take a calmer controller, or shorten the sampling period",
                )
            count *= 2
        return count

    @property
    def _most(self) -> int:
        return min(LARGEST_REFINEMENT * self.loop.substeps, MOST_SUBSTEPS)

    def _run(self, plants: ManyPlants, count: int) -> BatchRun:
        if not plants.count:
            parts = sum(len(stretch.parts) - 1 for stretch in self.stretches)
            none = np.zeros(0, np.int64)
            return BatchRun({n: np.zeros((parts, 0)) for n in self.scores.starts}, none, none, {})
        process, scores = self.loop.process, self.scores
        inputs = self._inputs(plants)
        constant = self._constant(inputs)
        moving = {name: values for name, values in inputs.items() if name not in constant}
        own = tuple(name for name, values in moving.items() if values.ndim == 2)
        kernel = loop_kernel(
            process, self.loop.controller, constant, count, scores=scores, individual=own,
            fuse=self.loop.fuse,
        )  # fmt: skip
        folds: dict[str, list[Array]] = {name: [] for name in self.scores.starts}
        for result in self._parts(kernel, plants, moving):
            for name, rows in folds.items():
                rows.append(result.state(name))
        names = (entry.name for entry in result.program.state)
        return BatchRun(
            {name: np.array(rows) for name, rows in folds.items()},
            lane_status(result, process),
            np.full(plants.count, count),
            dict(zip(names, result.final_state, strict=True)),
        )

    def _parts(
        self, kernel: Kernel, plants: ManyPlants, inputs: Mapping[str, Array]
    ) -> Iterator[Trajectories]:
        """Run part after part, each from where the last one ended, with scores at their start."""
        parameters, threads = self._parameters(plants), available_threads()
        state = plants.begin(self.loop, self.scenario)
        spans = [span for stretch in self.stretches for span in stretch.spans]
        parts = [
            (stop - first, {name: values[..., first:stop] for name, values in inputs.items()})
            for first, stop in spans
        ]
        samples, moving = parts[0]
        noise = self._noise_from(plants)
        job = kernel.prepare(
            samples, inputs=moving, parameters=parameters, state=state, noise=noise
        )
        yield (result := job.run(threads))
        for samples, moving in parts[1:]:
            job = job.following(result, samples, moving, self.scores.starts)
            yield (result := job.run(threads))

    def _constant(self, inputs: Mapping[str, Array]) -> dict[str, float]:
        """Return the inputs of the loop that never move, and are the same in all plants."""
        return {
            name: float(inputs[name][0]) if name in inputs else value
            for name, value in self.loop.at_rest().items()
            if name not in inputs or (inputs[name].ndim == 1 and np.ptp(inputs[name]) == 0.0)
            if name not in self._noise
        }

    def _parameters(self, plants: ManyPlants) -> dict[str, ArrayLike]:
        settings = {controller_name(name): row for name, row in plants.settings.items()}
        found: dict[str, ArrayLike] = {**self.loop.law_parameters(), **settings}
        found |= {s.name: s.initial for s in plants.process.parameters}
        return {**found, **plants.parameters}

    def _noise_from(self, plants: ManyPlants) -> BatchNoise | None:
        """Return the noise of plants; None where there is none."""
        if not self._noise:
            return None
        numbers = 0 if plants.numbers is None else plants.numbers
        return BatchNoise(self._noise, self.scenario.seed, numbers)

    def _inputs(self, plants: ManyPlants) -> dict[str, Array]:
        """Return the inputs of the loop by name, [samples] or [plants, samples]."""
        given = {name: np.asarray(values, float) for name, values in self._given.items()}
        loads = {
            d.name: v
            for d, v in zip(plants.process.disturbances, plants.point.disturbances, strict=True)
        }
        for name, column in plants.disturbances.items():
            given[name] = given[name] + (column - loads[name])[:, None]
        return given


def _noise_of(process: Process, scenario: Scenario) -> dict[str, InputNoise]:
    """Return the noise of each input of a loop that has some."""
    measured = {signal.name for signal in process.measurements}
    return {
        f"{each.signal}.noise" if each.signal in measured else each.signal: InputNoise(
            each.stream, each.deviation, each.first, each.count
        )
        for each in scenario.noises
    }


def _without(scenario: Scenario, process: Process) -> Scenario:
    """Return a scenario without the noise that a kernel makes."""
    noise, noisy = scenario.noise.copy(), {each.signal for each in scenario.noises}
    for column, signal in enumerate(process.measurements):
        if signal.name in noisy:
            noise[:, column] = 0.0
    return replace(scenario, noise=noise, disturbances=quiet_disturbances(scenario))
