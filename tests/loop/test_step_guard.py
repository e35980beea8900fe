"""The guard "step too long" against the error that smaller steps show, over random draws."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from random_plants import random_plant

from clepsydra import Kernel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.lane_status import STEP_BOUND, LaneStatus, lane_status
from clepsydra.loop.motion_block import MotionBlock, motion_at_rest
from clepsydra.loop.process_period import process_period
from clepsydra.loop.step_size import delay_substeps
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

SAMPLES, HOLD = 160, 40
#: The truth has so many times as many steps.
FINER = 8
SHAPE_KEYS = ("diameter", "length", "height")


def middle(process: Process) -> OperatingPoint:
    """Return the process with everything at its nominal value, at rest or not."""
    groups = (process.state, process.inputs, process.disturbances)
    state, inputs, disturbances = (np.array([s.initial for s in group]) for group in groups)
    measured = np.array(process.measure(state, process.parameter_values)).ravel()
    return OperatingPoint(process, state, inputs, disturbances, measured, residual=np.inf)


def drawn(process: Process, seed: int, lanes: int) -> tuple[dict, dict, dict]:
    """Return inputs, parameters and beginnings of so many draws.

    Inputs jump anywhere in their ranges, to their ends too; half the tanks begin empty. Holes
    are up to three hundred times too large for the step, and down to a tenth of the file's.
    """
    random = np.random.default_rng(seed)
    inputs = {}
    for signal in (*process.inputs, *process.disturbances):
        shares = random.uniform(0.0, 1.0, (lanes, SAMPLES // HOLD))
        shares[random.random(shares.shape) < 0.25] = 0.0
        shares[random.random(shares.shape) < 0.1] = 1.0
        inputs[signal.name] = np.repeat(signal.low + shares * signal.span, HOLD, axis=1)
    opening = 10.0 ** random.uniform(-1.0, random.uniform(-0.5, 2.5, lanes), lanes)
    parameters = {}
    for parameter in process.parameters:
        element, _, key = parameter.name.rpartition(".")
        factor = np.exp(random.uniform(-0.4, 0.4, lanes))
        if key in SHAPE_KEYS or key.endswith("_diameter"):
            factor = np.ones(lanes)
        if key in ("area", "coefficient") and not element.startswith("tank"):
            factor *= opening
        parameters[parameter.name] = parameter.initial * factor
    point = middle(process)
    floor = np.array([s.low if s.name.endswith(".level") else s.initial for s in process.state])
    empty = random.random(lanes) < 0.5
    values = process.parameter_values
    dry, wet = (
        np.array(process.motion.to_contents(x, values)).ravel() for x in (floor, point.state)
    )
    beginning = {
        signal.name: np.where(empty, dry[place], wet[place])
        for place, signal in enumerate(process.motion.contents)
    }
    return inputs, parameters, motion_at_rest(point) | beginning


def simulated(
    process: Process, draws: tuple[dict, dict, dict], substeps: int, guarded: bool = True
):
    """Return the trajectories of the draws with so many steps in a sampling period."""
    inputs, parameters, state = draws
    watched = process if guarded else None
    motion = MotionBlock(process.motion, process.sampling_period, substeps, watched=watched)
    program = process_period(process, motion, (), shown="start")
    kernel = Kernel(program, individual=list(inputs))
    return kernel.run(SAMPLES, inputs=inputs, parameters=parameters, state=state)


def judged(process: Process, seed: int, lanes: int) -> tuple[np.ndarray, ...]:
    """Return error as a share of the range, alarm, draws that switch alike, and that switch at all.

    A switch that smaller steps move, and more so each time that it comes again, makes more of an
    error than the steps do, and one that they bring about or spare is none of their length.
    """
    draws, least = drawn(process, seed, lanes), delay_substeps(process)
    one = simulated(process, draws, least)
    other = simulated(process, draws, FINER * least)
    error = np.zeros(lanes)
    with np.errstate(invalid="ignore", over="ignore"):
        for signal in process.state:
            if np.isfinite(signal.span):
                apart = np.abs(one.output(signal.name) - other.output(signal.name))
                error = np.maximum(error, apart.max(axis=1) / signal.span)
    error[~np.isfinite(error)] = np.inf
    alike, switched = np.ones(lanes, bool), np.zeros(lanes, bool)
    for event in process.motion.events:
        alike &= one.state(event.counted) == other.state(event.counted)
        switched |= one.state(event.counted) > 0
    alarm = lane_status(one, process) & LaneStatus.STEP_TOO_LONG != 0
    return error, alarm, alike, switched


def plants(folder: Path, count: int) -> list[Process]:
    found = []
    for seed in range(count):
        path = folder / f"plant-{seed}.toml"
        path.write_text(random_plant(seed))
        found.append(load_process(path))
    return found


class Verdict(NamedTuple):
    """How many draws: that switch alike; well within the bound; false alarms; misses."""

    alike: int
    small: int
    false: int
    missed: int
    missed_where_it_switches: int


def verdict(processes: list[Process], lanes: int) -> Verdict:
    parts = [judged(process, seed, lanes) for seed, process in enumerate(processes)]
    columns = (np.concatenate(part) for part in zip(*parts, strict=True))
    error, alarm, alike, switched = columns
    small = alike & (error < STEP_BOUND / 10)
    missed = alike & (error > 10 * STEP_BOUND) & ~alarm
    counted = (alike, small, small & alarm, missed & ~switched, missed & switched)
    return Verdict(*(int(np.count_nonzero(part)) for part in counted))


@pytest.mark.thorough
def test_the_guard_tells_a_step_that_is_too_long_from_one_that_is_not(tmp_path):
    """Ten thousand draws, of random plants and all of the catalogue.

    The few alarms allowed are corners: where one lies in a step, Simpson's weights cancel its
    error by chance, which no stage shows. The few misses allowed are of trips that come again
    and again, each a little later than the one before.
    """
    processes = [*plants(tmp_path, 41), *(load_process(name) for name in catalogue_names())]
    found = verdict(processes, 10_000 // len(processes))
    assert found.alike > 9_500 and found.small > 1_500
    assert found.missed == 0, found
    assert found.false <= 5 and found.missed_where_it_switches <= 10, found


def test_the_guard_is_right_on_a_few_draws():
    process = load_process(Path(__file__).parents[1] / "one-tank.toml")
    found = verdict([process], 90)
    assert found.alike == 90 and 10 < found.small < 80
    assert found[2:] == (0, 0, 0)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["quadruple-tank", "laboratory-four-tanks"])
def test_draws_of_a_sound_step_are_not_marked(name):
    """At the turn of a level stages differ by little, but by more of one another."""
    process, random = load_process(name), np.random.default_rng(1)
    inputs, _, state = drawn(process, 1, 200)
    parameters = {
        parameter.name: parameter.initial * random.uniform(0.9, 1.1, 200)
        for parameter in process.parameters
    }
    found = simulated(process, (inputs, parameters, state), 1)
    assert not np.any(lane_status(found, process) & LaneStatus.STEP_TOO_LONG)


@pytest.mark.parametrize(
    "name",
    ["quadruple-tank", pytest.param("laboratory-four-tanks", marks=pytest.mark.thorough)],
)
def test_the_guard_changes_no_bit(name):
    process = load_process(name)
    draws = drawn(process, 1, 16)
    watched, alone = simulated(process, draws, 1), simulated(process, draws, 1, guarded=False)
    for signal in process.state:
        assert np.array_equal(watched.output(signal.name), alone.output(signal.name))
