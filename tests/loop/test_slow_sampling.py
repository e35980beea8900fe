"""Designs for slow sampling, on the nonlinear tanks, and sampling too slow to be simulated."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import LinearModel
from clepsydra.loop import loop as loop_module
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.step_size import MOST_SUBSTEPS, substeps_for
from clepsydra.process.reader import load_process

NAMES = ["quadruple-tank", "quadruple-tank-nonminimum-phase"]
DESIGNS = {
    "simc": cl.design.simc,
    "phase margin": cl.design.phase_margin,
    "lqi": cl.design.lqi,
}


@cache
def sampled(name: str, period: float) -> cl.Plant:
    return cl.Plant(replace(load_process(name), sampling_period=period))


@pytest.mark.sampled
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("period", "rest"), [(30.0, 0.01), (60.0, 0.01), (1000.0, 0.1)])
@pytest.mark.parametrize("design", list(DESIGNS))
def test_levels_come_to_rest_at_their_setpoints(name, period, rest, design):
    plant = sampled(name, period)
    scenario = default_scenario(plant.linear)
    run = Loop(DESIGNS[design](plant), plant.linear).run(scenario)
    for segment in scenario.segments:
        if segment.kind == "noise":
            continue
        last = round(segment.stop / period) - 1
        for i, level in enumerate(("level_1", "level_2")):
            missed = run.true_measurement(level)[last] - scenario.setpoints[last, i]
            # Of a step of 1 V, after six times the slowest thing that the process does.
            assert abs(missed) < rest, (segment, level)
    # Away from noise the loop comes to rest: no swing from sample to sample.
    before = round(scenario.segments[-1].start / period)
    assert np.abs(np.diff(run.values["pump_1"][before - 4 : before])).max() < rest


def fast_mode(model: LinearModel) -> float:
    return float(np.abs(np.linalg.eigvals(model.A)).max())


@pytest.mark.parametrize("period", [1e9, 1e300])
def test_a_period_without_end_is_refused_before_anything_is_computed(period):
    plant, usual = sampled(NAMES[0], period), sampled(NAMES[0], 1.0)
    fastest = f"fastest time constant of {1 / fast_mode(plant.linear):.3g} s"
    with refused(place="quadruple-tank, sampling_period", expected=fastest) as caught:
        cl.study(plant)
    assert str(caught.value.value).startswith("1e+")
    for design in DESIGNS.values():
        with refused(place="sampling_period"):
            design(plant)
    with refused(place="sampling_period"):
        Loop(cl.design.lqi(usual), plant.linear)


@pytest.mark.thorough
def test_the_step_keeps_its_share_of_the_fastest_time_constant_up_to_the_limit():
    fastest = fast_mode(sampled(NAMES[0], 1.0).linear)
    for period in (0.01, 1.0, 8.0, 1000.0 / fastest * 0.999):
        count = substeps_for(sampled(NAMES[0], period).linear)
        assert count == max(1, math.ceil(fastest * period / 0.1))
    assert count == MOST_SUBSTEPS - 10
    with refused(place="sampling_period", expected="fastest time constant"):
        substeps_for(sampled(NAMES[0], 1000.0 / fastest * 1.001).linear)


@pytest.mark.thorough
@pytest.mark.parametrize(("times", "substeps"), [(0.04, 64), (900.0, 10_000), (400.0, 10_000)])
def test_refinement_ends_at_64_times_the_steps_or_at_the_limit(times, substeps, monkeypatch):
    """With a tolerance that no run can meet."""
    monkeypatch.setattr(loop_module, "TOLERANCE", 0.0)
    fastest = fast_mode(sampled(NAMES[0], 1.0).linear)
    plant = sampled(NAMES[0], times / fastest)
    scenario = default_scenario(plant.linear)
    run = Loop(cl.design.lqi(plant), plant.linear).run_checked(scenario)
    assert run.substeps == pytest.approx(substeps, rel=0.12)
    assert run.substeps <= MOST_SUBSTEPS
    assert 0.0 < run.error_estimate < 1e-6
