"""Active disturbance rejection by bandwidths: where its poles lie, its margins, its code."""

import math

import numpy as np
import pytest
from refusals import refused
from tools import need, need_compiler

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop


@pytest.fixture(scope="module")
def basin():
    """Return a level that integrates, sampled every minute."""
    return cl.load("equalisation-tank")


def test_the_poles_of_the_loop_are_those_that_were_asked_for(basin):
    """The model is exact there: one pole at 1 − Δt/τc and two of the observer at 1/(1 + ωo Δt)."""
    controller = cl.design.disturbance_rejection(
        basin, closed_loop_time_constant="20 min", observer_ratio=4.0
    )
    period = basin.process.sampling_period
    loop, fast = 1.0 - period / 1200.0, 1.0 / (1.0 + 4.0 * period / 1200.0)
    found = np.linalg.eigvals(sampled_loop(controller, basin.linear).A)
    # Numbers are rounded to six digits, by whose square root a double pole moves.
    assert np.count_nonzero(np.abs(found - loop) < 1e-6) == 1
    assert np.count_nonzero(np.abs(found - fast) < 1e-3) == 2


def test_loops_that_interact_are_slowed_down_until_they_are_robust():
    plant = cl.load("quadruple-tank-nonminimum-phase")
    controller = cl.design.disturbance_rejection(plant)
    peak = sampled_loop(controller, plant.linear).maximum_sensitivity
    assert controller.slowed > 1.0 and 1.99 < peak <= 2.0
    faster = cl.design.disturbance_rejection(plant, closed_loop_time_constant="2 min")
    assert "choose a longer closed-loop time constant" in faster.notes[-1]


def test_loads_leave_no_offset_and_setpoint_steps_no_overshoot(basin):
    """A PI of the same τc passes its setpoint: its integral has to take in the load's share."""
    time = "45 min"
    found = cl.simulate(
        basin, cl.design.disturbance_rejection(basin, closed_loop_time_constant=time)
    )
    other = cl.simulate(basin, cl.design.simc(basin, closed_loop_time_constant=time))
    assert found.scores["offset[level]"] < 1e-6
    assert found.scores["overshoot[level]"] < 1e-3 < other.scores["overshoot[level]"]


def test_what_is_exported_runs_what_was_simulated():
    need_compiler()
    need("fmpy", "tree_sitter_iec61131_3_st")
    plant = cl.load("quadruple-tank")
    proof = cl.verify(cl.design.disturbance_rejection(plant), plant, to=["c", "st"])
    assert proof.holds


@pytest.mark.parametrize("ratio", [0.0, -1.0, math.nan, "much"])
def test_a_ratio_that_is_none_is_refused(basin, ratio):
    with refused(place="observer_ratio"):
        cl.design.disturbance_rejection(basin, observer_ratio=ratio)
