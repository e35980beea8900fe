"""Many candidates of one controller simulated side by side, scored while they run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import controller_name
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.lane_status import STEP_BOUND, LaneStatus, lane_status
from clepsydra.loop.law_begin import batch_begin, loop_begin
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import LARGEST_REFINEMENT, MOST_SUBSTEPS
from clepsydra.program.program import Program
from clepsydra.studies.tuning.resting_states import RestingStates


class BatchScores(NamedTuple):
    """The scores by "score[signal]", and what happened, a `LaneStatus`, of each candidate."""

    scores: dict[str, np.ndarray]
    status: np.ndarray


class BatchEvaluation:
    """One compiled kernel that runs a controller's law with many values of its parameters.

    The candidates are its lanes, so that what they share is read once. No trajectory is stored.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point where the scenario begins.
    names : sequence of str
        Running scores, see `clepsydra.loop.running_scores.RunningScores`.

    Raises
    ------
    InputError
        The scenario is of another process, or a score is unknown.

    Examples
    --------
    Twice the gain brings the IAE of a step of 0.1 V down from 0.74 V s to 0.39 V s:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> at_rest = np.array([[plant.point.as_dict()[y] for y in controller.setpoints]])
    >>> setpoints = np.repeat(at_rest, 200, axis=0) + [0.1, 0.0]
    >>> step = Scenario(1.0, setpoints, np.zeros((200, 2)), np.zeros((200, 4)), (), 1)
    >>> batch = BatchEvaluation(controller, plant.linear, step, ["iae[level_1]"])
    >>> gains = {"level_1.proportional_gain": np.array([3.0, 6.0])}
    >>> batch.run(gains).scores["iae[level_1]"].round(2)
    array([0.74, 0.39])
    """

    def __init__(
        self, controller: Controller, model: LinearModel, scenario: Scenario, names: Sequence[str]
    ) -> None:
        self.loop = Loop(controller, model)
        self.resting = RestingStates(self.loop)
        self._scores = RunningScores(self.loop.process, tuple(names))
        self._samples, self._scenario = scenario.samples, scenario
        self.loop.check(scenario)
        given = self.loop.inputs_of(scenario) | self._scores.inputs_of(scenario)
        # What never moves is folded into the program: no noise, no load, no step.
        constant = {
            name: float(given[name][0]) if name in given else value
            for name, value in self.loop.at_rest().items()
            if name not in given or np.all(given[name] == given[name][0])
        }
        self._inputs = {name: value for name, value in given.items() if name not in constant}
        self._compile(constant)

    def _compile(self, constant: Mapping[str, float]) -> None:
        """Make the program, with steps that are not too long for the controller itself.

        A candidate for which they are too long has that in its status.
        """
        process, count = self.loop.process, self.loop.substeps
        most = min(LARGEST_REFINEMENT * count, MOST_SUBSTEPS)
        while True:
            self._kernel = loop_kernel(
                process, self.loop.controller, constant, count, scores=self._scores
            )
            self._begin = loop_begin(self.loop, self._scenario, count)
            if not self.run({}).status[0] & LaneStatus.STEP_TOO_LONG:
                return
            if 2 * count > most:
                raise InputError(
                    f"tuning, {self.loop.controller.name}, integration",
                    f"{count} steps in a sampling period of {process.sampling_period:g} s",
                    f"steps so short that no state is wrong by {100.0 * STEP_BOUND:g} % of its "
                    "range at the start of the search",
                    "start from a calmer controller, or shorten the sampling period",
                )
            count *= 2

    @property
    def program(self) -> Program:
        """What runs, by the name of its own controller: others may share the kernel."""
        return replace(self._kernel.program, name=self.loop.controller.name)

    def run(self, values: Mapping[str, np.ndarray]) -> BatchScores:
        """Return the scores of every candidate.

        Parameters
        ----------
        values : dict
            Parameters of the law to their values [candidates]; the others are the controller's.
            Its initial state follows them where the law rests elsewhere with them.
        """
        begin = self._scenario.begin
        starts: Mapping[str, ArrayLike] = (
            self.resting.at(values)
            if begin is None
            else batch_begin(self.loop, self._scenario, begin, values)
        )
        state, rings = self._begin
        result = self._kernel.run(
            self._samples,
            inputs=self._inputs,
            parameters=self.loop.law_parameters() | _of_controller(values),
            state=state | _of_controller(starts),
            rings=rings,
        )
        return BatchScores(self._scores.read(result), lane_status(result, self.loop.process))


def _of_controller(values: Mapping[str, ArrayLike]) -> dict[str, ArrayLike]:
    return {controller_name(name): value for name, value in values.items()}
