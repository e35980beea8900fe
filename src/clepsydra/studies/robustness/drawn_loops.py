"""One controller over drawn plants: any draw alone, or many in chunks."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clepsydra import __version__
from clepsydra.base.errors import Finding, InputError
from clepsydra.controllers.controller import Controller
from clepsydra.engine.host import host
from clepsydra.engine.threads import side_by_side
from clepsydra.engine.white_noise import seed_of
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.begin import begin_from
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_batch import LoopBatch
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.with_noise import quiet_disturbances, with_other_noise
from clepsydra.program.program import Program
from clepsydra.scores.segment import Segment
from clepsydra.studies.robustness.drawn_plants import NumberedPlants
from clepsydra.studies.robustness.drawn_scores import DrawnScores, drawn_scores, judged_names

Array = NDArray[np.float64]

#: The mean of the scores of a yardstick over it.
ERROR = "error"
#: Draws that run side by side, and samples of all of them together, about. What comes of a draw
#: depends on neither.
_FEWEST, _MOST, _SAMPLES = 256, 8192, 2**25
#: Numbers in the courses of disturbances that differ from draw to draw, of which two copies are
#: made in each thread.
_COURSES = 2**22


@dataclass(frozen=True, eq=False)
class DrawnLoops:
    """A controller over drawn plants in one scenario.

    Parameters
    ----------
    controller : Controller
    scenario : Scenario
        On the plant of the point, which every draw gets.
    plants : NumberedPlants
    names : tuple of str
        Running scores, see `clepsydra.loop.running_scores.RunningScores`.
    yardstick : mapping
        Some of these scores to what counts as 1 of each: then there is a score `ERROR` too, the
        mean of them over it.
    fuse : bool
        Whether multiply-adds are fused; as this processor does if left out. Draws without are the
        same, bit for bit, on every processor.

    Examples
    --------
    Draw 7 alone is draw 7 of many:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.studies.robustness.drawn_plants import DrawnPlants
    >>> plant = cl.load("three-tanks")
    >>> plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty)
    >>> scenario, names = default_scenario(plant.linear), ("iae[level_3]",)
    >>> loops = DrawnLoops(cl.design.simc(plant), scenario, plants, names)
    >>> many = loops.draw(np.arange(20)).scores["iae[level_3]"]
    >>> alone = loops.draw(np.array([7])).scores["iae[level_3]"]
    >>> bool(np.all(alone[:, 0] == many[:, 7]))
    True
    """

    controller: Controller
    scenario: Scenario
    plants: NumberedPlants
    names: tuple[str, ...]
    yardstick: Mapping[str, float] = field(default_factory=dict)
    fuse: bool = field(default_factory=lambda: host().fuses)

    def __getstate__(self) -> dict[str, Any]:
        """Return what it was made of; what follows is found anew where it arrives."""
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        return given | {"plants": replace(self.plants)}

    @cached_property
    def chunk(self) -> int:
        """Draws that are worth running side by side."""
        scenario, plants = self.scenario, self.plants
        loads = {signal.name for signal in plants.point.process.disturbances}
        courses = len(loads & plants.values(np.array([0])).keys())
        fitting = _SAMPLES // (scenario.samples * self._batch.substeps)
        if courses:  # of which each draw has an array of its own
            fitting = min(fitting, _COURSES // (scenario.samples * courses))
        return int(np.clip(2 ** int(np.log2(max(fitting, 1))), _FEWEST, _MOST))

    @property
    def operations(self) -> int:
        """What a draw takes, in operations of its kernel."""
        batch = self._batch
        return batch.operations * self.scenario.samples

    @property
    def events(self) -> tuple[Segment | None, ...]:
        """What happens in each stretch that has scores of its own; None between events."""
        return tuple(stretch.segment for stretch in self._batch.stretches)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each score [SI, or that of its definition]."""
        units = self._batch.scores.units
        return {ERROR: "1"} | {name: units[name] for name in self.names}

    @cached_property
    def digest(self) -> str:
        """What tells these draws from any others."""
        plants, scenario = self.plants, self.scenario
        said = [
            repr(self._program), plants.pairing, plants.said(), self.names, dict(self.yardstick),
            sorted(self.controller.values.items()),
            sorted(self.controller.initial_state.items()), __version__,
            [repr(part) for part in scenario.segments], self.fuse,
        ]  # fmt: skip
        digest = hashlib.sha256(json.dumps(said).encode())
        point = plants.point
        moves = (scenario.setpoints, scenario.disturbances, scenario.noise)
        own = point.process.parameter_values
        for array in (point.state, point.inputs, point.disturbances, own, *moves):
            digest.update(np.ascontiguousarray(array, dtype=float).tobytes())
        return digest.hexdigest()

    def draw(self, numbers: NDArray[np.int64]) -> DrawnScores:
        """Return what comes of the draws of some numbers, side by side."""
        values = self.plants.values(numbers)
        rest = self.plants.rest(numbers, values)
        run = self._batch.run(self.plants.plants(numbers, values, rest))
        found = drawn_scores(self._batch, self.names, numbers, rest, run)
        if self.yardstick:
            found.scores[ERROR] = mean_error(found, self.yardstick)[None]
        return found

    def draw_many(self, numbers: NDArray[np.int64]) -> Iterator[DrawnScores]:
        """Yield what comes of chunks of draws, one after the other."""
        chunks = (
            numbers[first : first + self.chunk] for first in range(0, len(numbers), self.chunk)
        )
        return side_by_side(self.draw, chunks)

    def run(self, number: int) -> Run:
        """Return the run of one draw, with its trajectories.

        Raises
        ------
        InputError
            The draw has no admissible steady state.
        """
        numbers = np.array([number])
        values = self.plants.values(numbers)
        rest = self.plants.rest(numbers, values)
        if not rest.feasible[0]:
            raise InputError(
                "draw", number, "one with an admissible steady state",
                f"choose another: {rest.reasons[rest.reason[0]]}",
            )  # fmt: skip
        batch = self._batch
        found = batch.run(self.plants.plants(numbers, values, rest))
        point = self._point(values, rest.state[:, 0], rest.inputs[:, 0])
        levels, settings = (
            {name: float(column[0]) for name, column in each(numbers).items()}
            for each in (self.plants.levels, self.plants.settings)
        )
        begin = begin_from(point, "rest", given=levels, controller_start="bumpless")
        loads = point.disturbances - self.plants.point.disturbances
        moved = quiet_disturbances(self.scenario) + loads
        quiet = replace(self.scenario, begin=begin, quiet_disturbances=moved)
        scenario = with_other_noise(quiet, point.process, seed_of(quiet.seed, number))
        own = replace(self.controller, values={**self.controller.values, **settings})
        loop = Loop(own, linearise(point), self.fuse)
        return loop.run(scenario, substeps=int(found.substeps[0]))

    def trajectories(self, numbers: NDArray[np.int64], every: int) -> dict[str, Array]:
        """Return what the controlled measurements and inputs of some draws do [draws, records].

        Of a draw without an admissible steady state it is not a number. Records are of samples 0,
        every, 2 every, …
        """
        values = self.plants.values(numbers)
        rest = self.plants.rest(numbers, values)
        found = self._batch.trajectories(self.plants.plants(numbers, values, rest), every)
        whole = {}
        for name, rows in found.items():
            whole[name] = np.full((len(numbers), rows.shape[1]), np.nan)
            whole[name][rest.feasible] = rows
        return whole

    def _point(self, values: Mapping[str, Array], state: Array, inputs: Array) -> OperatingPoint:
        nominal = self.plants.point
        own = {name: float(column[0]) for name, column in values.items()}
        process = nominal.process
        loads = zip(process.disturbances, nominal.disturbances.tolist(), strict=True)
        disturbances = np.array([own.get(signal.name, value) for signal, value in loads])
        return OperatingPoint.at(process.with_parameters(own), state, inputs, disturbances)

    @property
    def _program(self) -> Program:
        """One sample of the loop."""
        loop = self._batch.loop
        return closed_loop(loop.process, self.controller, substeps=self._batch.substeps)

    @cached_property
    def _batch(self) -> LoopBatch:
        if self.fuse and not host().fuses:
            raise InputError(
                "draws", Finding("a processor that fuses no multiply-adds"),
                "one that does, as was asked for", "ask for draws without",
            )  # fmt: skip
        loop = Loop(self.controller, linearise(self.plants.point), self.fuse)
        judged = judged_names(loop.process)
        return LoopBatch(loop, self.scenario, tuple(dict.fromkeys((*self.names, *judged))))


def mean_error(drawn: DrawnScores, yardstick: Mapping[str, float]) -> Array:
    """Return the mean of some scores of the whole run, each over what counts as 1 of it [draws]."""
    shares = [drawn.scores[name][0] / one for name, one in yardstick.items()]
    total = shares[0]
    for share in shares[1:]:
        total = total + share
    return np.asarray(total / len(shares))
