"""Several loops of one law as lanes of one kernel: each with the bits of its own run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.begin import begin_from
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.several_loops import TOGETHER, checked_runs, run_alike

RULES = (cl.design.simc, cl.design.lambda_, cl.design.amigo)
DELAYED = Path(__file__).parents[1] / "dead-time.toml"


def loops_of(name, rules=RULES):
    plant = cl.load(name)
    loops = [Loop(rule(plant), plant.measured) for rule in rules]
    return loops, default_scenario(plant.measured)


@pytest.mark.parametrize(
    ("name", "fuse"),
    [
        ("three-tanks", True),
        ("three-tanks", False),
        ("laboratory-four-tanks", True),
        ("quadruple-tank", True),
    ],
)
def test_loops_side_by_side_run_as_each_alone(name, fuse):
    loops, scenario = loops_of(name)
    loops = [replace(loop, fuse=fuse) for loop in loops]
    assert all(run_alike(loops[0], each, scenario) for each in loops)
    found = checked_runs(loops, scenario, 8)
    assert len({run.error_estimate for run in found}) == len(loops) <= TOGETHER
    for loop, run in zip(loops, found, strict=True):
        alone = loop.run_checked(scenario, 8)
        assert run.controller is loop.controller
        assert (run.substeps, run.error_estimate) == (alone.substeps, alone.error_estimate)
        assert run.final_state == alone.final_state
        for signal, values in alone.values.items():
            assert np.array_equal(run.values[signal], values), signal


def test_another_law_a_delay_and_the_end_of_another_run_stand_alone():
    (one, other, lqi), scenario = loops_of("three-tanks", (*RULES[:2], cl.design.lqi))
    assert run_alike(one, other, scenario)
    assert not run_alike(one, lqi, scenario)
    empty = replace(scenario, begin=begin_from(one.point, "empty"))
    assert not run_alike(one, other, empty)
    (late, later, _), scenario = loops_of(DELAYED)
    assert late.process.motion.delays
    assert not run_alike(late, later, scenario)
