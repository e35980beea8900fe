"""The drawn plants under the case's controller, and the same draws as a case of the other ways."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

import clepsydra as cl
from benchmarks.case import NOMINAL, Case, equilibrium
from benchmarks.with_clepsydra import ABSOLUTE_ERRORS, case_controller, name_of
from clepsydra.engine.white_noise import seed_of
from clepsydra.interface.robustness import loops_of
from clepsydra.linear.equilibria import Equilibria
from clepsydra.loop.with_noise import with_noise
from clepsydra.scores.score import SCORES
from clepsydra.studies.robustness.drawn_loops import DrawnLoops

LEVELS = ("level_1", "level_2")
#: Every parameter of the process within so much of its value, as in the case.
UNCERTAINTY = {"default": "5 %"}
#: One setpoint after the other, so that each step is an event with scores of its own; the first
#: drives pump 1 into its upper limit.
STEPS = (("level_1", "+2.5 V", "100 s"), ("level_2", "+1 V", "500 s"))


@dataclass(frozen=True, eq=False)
class Problem:
    """So many draws, scored by IAE, with noise on every measurement or none.

    Parameters
    ----------
    quiet, noisy : DrawnLoops
    draws : int
    """

    quiet: DrawnLoops
    noisy: DrawnLoops
    draws: int

    @property
    def numbers(self) -> np.ndarray:
        """The numbers of the draws."""
        return np.arange(1, self.draws + 1)

    @property
    def deviation(self) -> float:
        """Of the noise of each controlled measurement [V]."""
        (found,) = {each.deviation for each in self.noisy.scenario.noises if each.signal in LEVELS}
        return found

    def run(self, loops: DrawnLoops) -> None:
        """Find what comes of all draws, chunk by chunk, and keep nothing."""
        for _ in loops.draw_many(self.numbers):
            pass

    def sums(self, loops: DrawnLoops, numbers: np.ndarray | None = None) -> np.ndarray:
        """Return the case's sums of absolute errors of some draws, or all [2, draws]."""
        if ABSOLUTE_ERRORS.key not in SCORES:
            ABSOLUTE_ERRORS.registered()
        names = tuple(f"{ABSOLUTE_ERRORS.key}[{level}]" for level in LEVELS)
        summing = replace(loops, names=names)
        chosen = _chunks(loops, self.numbers if numbers is None else numbers)
        found = [summing.draw(chunk).scores for chunk in chosen]
        return np.hstack([[each[name][0] for name in names] for each in found])

    def equilibria(self, values: Mapping[str, np.ndarray]) -> Equilibria:
        """Return where the draws rest."""
        return self.quiet.plants.rest(self.numbers, values)

    def values(self) -> dict[str, np.ndarray]:
        """Return what varies of the draws."""
        return self.quiet.plants.values(self.numbers)

    def case(self, values: Mapping[str, np.ndarray], rest: Equilibria) -> Case:
        """Return the same draws for the other ways."""
        loops = self.quiet
        rows = []
        for entry in NOMINAL:
            name = name_of(entry)
            if entry.startswith("outlet_area"):  # a hole and its discharge, as one number
                row = values[name] * values[name.replace(".area", ".discharge")]
            elif name.startswith("controller."):
                row = np.full(self.draws, loops.controller.values[name.removeprefix("controller.")])
            else:
                row = values[name]
            rows.append(row)
        gains = [values[f"{level}.gain"] for level in LEVELS]
        individual = np.array([*gains, *rest.state, *rest.inputs])
        setpoints = np.ascontiguousarray(loops.scenario.setpoints)
        return Case(np.array(rows), setpoints, equilibrium(), individual)

    def noise(self, numbers: np.ndarray) -> np.ndarray:
        """Return the noise of some draws at the controlled measurements [samples, 2, draws]."""
        scenario = self.noisy.scenario
        columns = {each.signal: each for each in scenario.noises}
        rows = [
            [columns[level].values(seed_of(scenario.seed, number)) for level in LEVELS]
            for number in numbers.tolist()
        ]
        return np.transpose(np.array(rows), (2, 1, 0))


def _chunks(loops: DrawnLoops, numbers: np.ndarray) -> list[np.ndarray]:
    return np.split(numbers, range(loops.chunk, len(numbers), loops.chunk))


def problem(draws: int, samples: int) -> Problem:
    """Return so many draws of so many samples."""
    plant = cl.load("quadruple-tank")
    steps = [cl.step(name, size, at=at) for name, size, at in STEPS]
    loops = loops_of(
        case_controller(), plant, steps, uncertainty=UNCERTAINTY, duration=f"{samples} s", seed=1
    )
    quiet = replace(loops, names=tuple(f"iae[{level}]" for level in LEVELS))
    noisy = replace(quiet, scenario=with_noise(quiet.scenario, plant.process))
    return Problem(quiet, noisy, draws)
