"""The error estimate by step halving: never below the true error, and not far above it."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from random_plants import random_plant

import clepsydra as cl
from clepsydra.loop.open_loop import Simulation, simulate, simulations
from clepsydra.loop.profile import Change
from clepsydra.loop.step_size import MOST_SUBSTEPS, Solver, refined
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

SAMPLES, HOLD = 160, 40
#: Below this share of a range rounding decides, which no step shows.
ROUNDING = 1e-12


def furthest(process: Process, one: Simulation, other: Simulation) -> float:
    """Return the largest difference of two runs, as a share of each state's range."""
    return max(
        float(np.max(np.abs(one.values[s.name] - other.values[s.name])) / s.span)
        for s in process.state
        if np.isfinite(s.span)
    )


def drawn_run(folder: Path, seed: int) -> cl.OpenLoopRun:
    """Return the checked run of a random plant that begins empty, whose pumps jump at random."""
    path = folder / f"plant-{seed}.toml"
    path.write_text(random_plant(seed))
    process, random = load_process(path), np.random.default_rng(1_000_000 + seed)
    times = [k * HOLD * process.sampling_period for k in range(SAMPLES // HOLD)]
    jumps = [
        Change(signal.name, random.choice([0.0, 1.0, *random.uniform(0.0, 1.0, 2)]), time, time)
        for signal in process.inputs
        for time in times
    ]
    duration = SAMPLES * process.sampling_period
    return cl.simulate(cl.Plant(process), None, jumps, duration=duration, start="empty")


def again(run: cl.OpenLoopRun, substeps: int, solver: Solver = "kernel") -> Simulation:
    """Return the same run with another number of steps, or by the reference solver.

    The kernel is that of the run, whose machine code is kept; `test_adjustable_steps.py` compares
    it with a kernel of its own for each number of steps.
    """
    process = run.process
    outside = (*process.inputs, *process.disturbances)
    profiles = {signal.name: run.values[signal.name][:-1] for signal in outside}
    state = {signal.name: float(run.values[signal.name][0]) for signal in process.state}
    if solver == "kernel":
        return simulations(run.plan.point, profiles, state)(substeps)
    return simulate(run.plan.point, profiles, substeps=substeps, state=state, solver=solver)


def truth(run: cl.OpenLoopRun) -> Simulation:
    """Return the run with eight times as many steps, or with the most."""
    return again(run, min(8, MOST_SUBSTEPS // run.substeps) * run.substeps)


def ratio(run: Simulation, true: Simulation) -> float:
    """Return estimate / true error."""
    error = furthest(run.process, run, true)
    return run.error_estimate / error if error > ROUNDING else np.inf


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Return a function: seed → the checked run of a random plant, and the truth."""

    @cache
    def runs(seed: int) -> tuple[cl.OpenLoopRun, Simulation]:
        run = drawn_run(tmp_path_factory.mktemp("plants"), seed)
        return run, truth(run)

    return runs


#: Of one or two tanks, with a weir, an outlet above the floor, a curve, a rate or a trip each.
SMALL = (11, 14, 30, 35, 48, 118, 120, 121, 142, 157)


@pytest.mark.thorough
@pytest.mark.parametrize("first", range(0, 200, 10))
def test_the_estimate_covers_the_true_error_of_random_plants_with_corners(first, tmp_path):
    """Two hundred plants of one to five tanks."""
    runs = (drawn_run(tmp_path, seed) for seed in range(first, first + 10))
    assert min(ratio(run, truth(run)) for run in runs) > 1.0


@pytest.mark.sampled
@pytest.mark.parametrize("seed", SMALL)
def test_the_estimate_covers_the_true_error_of_a_few(drawn, seed):
    assert ratio(*drawn(seed)) > 1.0


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [seed for seed in SMALL if seed != 14])  # a slow one
def test_the_truth_is_that_of_the_reference_solver(drawn, seed):
    run, true = drawn(seed)
    reference = again(run, run.substeps, "reference")
    error = furthest(run.process, run, reference)
    assert error < run.error_estimate
    assert furthest(run.process, true, reference) < 1e-9 + error / 4.0


class Samples:
    """A run of one tank of 1 m whose level is given."""

    def __init__(self, level: np.ndarray) -> None:
        self.values = {"tank_1.level": level}


@pytest.mark.parametrize(("order", "above"), [(4, 15.0), (3, 63.0), (2, 39.0), (1, 15.0)])
def test_the_estimate_of_an_error_of_known_order(order, above):
    process = load_process(Path(__file__).parents[1] / "one-tank.toml")
    span = process.state[0].span

    def run(steps: int) -> Samples:
        return Samples(
            np.array([0.0, 0.1, 0.05]) + span * np.array([0.0, 1e-3, -2e-3]) / steps**order
        )

    estimate = refined(process, run, 1, 0.0, largest=4)[1]
    assert estimate == pytest.approx(above * 2e-3 / 4**order, rel=1e-6)


@pytest.mark.parametrize("name", ["quadruple-tank", "three-tanks"])
def test_the_estimate_of_a_smooth_run_is_at_most_thirty_times_its_error(name):
    process = load_process(name)
    steps = [
        cl.step(signal.name, to=f"{1.1 * signal.initial:.9g} {signal.unit}", at=0.0)
        for signal in process.inputs
    ]
    slow = replace(process, sampling_period=20.0 * process.sampling_period)
    run = cl.simulate(cl.Plant(slow), None, steps, duration=60 * slow.sampling_period)
    assert 10.0 < ratio(run, truth(run)) < 30.0
