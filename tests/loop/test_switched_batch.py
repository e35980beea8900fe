"""Switches and delays in a batch: any lane is its own run, and every scenario has a status."""

from pathlib import Path

import numpy as np
import pytest

from clepsydra import Kernel
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.lane_status import LaneStatus, lane_status
from clepsydra.loop.loop import Loop
from clepsydra.loop.motion_block import CLOCK
from clepsydra.process.reader import load_process

PLANT = Path(__file__).parents[1] / "switched-tanks.toml"
SAMPLES = 400


@pytest.fixture(scope="module")
def loop() -> Loop:
    analysis = analyse(load_process(PLANT))
    return Loop(design_simc(analysis.model, analysis.pairing), analysis.model)


def batch(loop: Loop, demands: np.ndarray, **options):
    """Run a scenario for each demand [m³/s], which is drawn from sample 50 to 300."""
    program = closed_loop(loop.process, loop.controller, substeps=loop.substeps, statuses=True)
    profile = np.zeros((len(demands), SAMPLES))
    profile[:, 50:300] = demands[:, None]
    inputs = {k: v for k, v in loop.at_rest().items() if k != "demand"}
    kernel = Kernel(program, individual=["demand"], **options)
    given = inputs | {"demand": profile}
    return kernel.run(
        SAMPLES, inputs=given, state=loop.initial_state(), parameters=loop.law_parameters()
    )


@pytest.mark.thorough
def test_any_lane_equals_its_own_run_bit_for_bit_through_events_and_delays(loop):
    demands = np.array([0.0, 1e-4, 2.0e-4, 3.1e-4, 1.5e-4, 2.7e-4, 0.5e-4, 3.3e-4, 2.2e-4])
    together = batch(loop, demands)
    counts = together.state("demand.runs_dry.count")
    assert counts[0] == 0 and len(set(counts)) > 3
    for scenario, demand in enumerate(demands):
        alone = batch(loop, np.array([demand]))
        assert np.array_equal(together.record_of(scenario), alone.record_of(0))


def test_the_clock_counts_every_step(loop):
    assert batch(loop, np.array([2e-4])).state(CLOCK)[0] == SAMPLES * loop.substeps


def test_a_broken_lane_leaves_its_neighbours_alone(loop):
    demands = np.array([1e-4, np.nan, 2e-4, 1e-4])
    broken, sound = batch(loop, demands), batch(loop, np.full(4, 1e-4))
    assert LaneStatus.NOT_A_NUMBER in LaneStatus(int(lane_status(broken, loop.process)[1]))
    assert LaneStatus.NOT_A_NUMBER not in LaneStatus(int(lane_status(broken, loop.process)[0]))
    assert np.array_equal(broken.record_of(0), sound.record_of(0))
    assert np.array_equal(broken.record_of(3), sound.record_of(3))


def test_a_tank_above_its_rim_is_a_status(loop):
    program = closed_loop(loop.process, loop.controller, substeps=loop.substeps, statuses=True)
    heights = np.array([0.1, 0.29, 0.31])
    result = Kernel(program).run(
        3,
        inputs=loop.at_rest(),
        state=loop.initial_state() | {"tank_1.level": heights},
        parameters=loop.law_parameters(),
    )
    found = lane_status(result, loop.process)
    spilling = [LaneStatus.SPILLING in LaneStatus(int(status)) for status in found]
    assert spilling == [False, False, True]


@pytest.mark.parametrize("hole", [1.0, 3e4])
def test_a_step_beyond_the_reach_of_the_method_is_a_status(hole):
    """A hole as large as the tank: at 10 cm its rate is 3e4 times too fast for a step of 1 s."""
    analysis = analyse(load_process(Path(__file__).parents[1] / "one-tank.toml"))
    loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    program = closed_loop(loop.process, loop.controller, substeps=1, statuses=True)
    area = loop.process.signal("outlet_1.area").initial
    result = Kernel(program).run(
        20,
        inputs=loop.at_rest(),
        state=loop.initial_state(),
        parameters=loop.law_parameters() | {"outlet_1.area": hole * area},
    )
    status = LaneStatus(int(lane_status(result, loop.process)[0]))
    too_long = LaneStatus.STEP_TOO_LONG in status
    assert too_long == (hole > 1.0)


def test_emptied_is_a_status():
    analysis = analyse(load_process(Path(__file__).parents[1] / "one-tank.toml"))
    loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    program = closed_loop(loop.process, loop.controller, substeps=1, statuses=True)
    off = loop.at_rest() | {"pump_1.mode": 0.0, "pump_1.manual": 0.0}
    for samples, emptied in ((5, False), (400, True)):
        result = Kernel(program).run(
            samples, inputs=off, state=loop.initial_state(), parameters=loop.law_parameters()
        )
        status = LaneStatus(int(lane_status(result, loop.process)[0]))
        assert (LaneStatus.EMPTIED in status) == emptied


def test_harm_is_a_status_of_the_lane_where_it_happens(loop):
    """A demand of 2.7e-4 m³/s empties tank 2; none does not."""
    demands = np.array([0.0, 2.7e-4])
    found = [LaneStatus(int(s)) for s in lane_status(batch(loop, demands), loop.process)]
    assert [LaneStatus.HARMED in status for status in found] == [False, True]
