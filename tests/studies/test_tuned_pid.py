"""The tuning that a study makes, on processes of the catalogue."""

import dataclasses
from functools import cache

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.studies.trial import scores_of
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Limits, minimax
from clepsydra.studies.tuning.parameters import settings_of
from clepsydra.studies.tuning.tune import tune

pytestmark = pytest.mark.thorough


@cache
def tuned(name):
    """Return start, model, scenario and result of the tuning of a process's PI loops."""
    plant = cl.load(name)
    start, scenario = cl.design.simc(plant), default_scenario(plant.measured)
    objective = minimax(*(f"iae[{y}]" for y in start.setpoints))
    goal = Goal(plant.measured, scenario, objective, Limits(2.0))
    return start, plant.measured, scenario, tune(LawSpace(start, settings_of(start)), goal)


@pytest.mark.parametrize("name", ["quadruple-tank", "quadruple-tank-nonminimum-phase"])
def test_the_tuned_controller_scores_in_a_run_of_its_own_what_the_tuning_said(name):
    start, model, scenario, found = tuned(name)
    own = scores_of(Loop(found.controller, model).run(scenario))
    before = scores_of(Loop(start, model).run(scenario))
    ratios = []
    for y in start.setpoints:
        score = f"iae[{y}]"
        assert found.scores[score] == pytest.approx(own[score], rel=1e-10), y
        assert found.start_scores[score] == pytest.approx(before[score], rel=1e-10), y
        ratios.append(own[score] / before[score])
    assert found.objective == pytest.approx(max(ratios), rel=1e-10) and found.objective < 1.0
    # A minimax of two that can be traded has both equal.
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-4)
    peak = sampled_loop(found.controller, model).maximum_sensitivity
    assert found.maximum_sensitivity == pytest.approx(peak, rel=1e-9)
    # Six digits round gain and time by up to 5e-6 each: S by |T| times that, here |T| < 3.
    assert peak <= 2.0 * (1 + 3e-5)
    assert ("max|S| at most 2" in found.binding) == (peak > 1.999)
    for i in (1, 2):
        values = found.controller.values
        assert values[f"level_{i}.tracking_time"] == values[f"level_{i}.integral_time"], i


def test_no_neighbour_that_keeps_the_limit_is_better():
    """The non-minimum phase tank, whose best stands on the limit: 60 points around it."""
    _, model, scenario, found = tuned("quadruple-tank-nonminimum-phase")
    random = np.random.default_rng(5)
    moved = [f"level_{i}.{name}" for name in ("proportional_gain", "integral_time") for i in (1, 2)]
    kept = 0
    for _ in range(60):
        values = dict(found.controller.values)
        values |= {name: values[name] * (1 + 0.02 * random.normal()) for name in moved}
        values |= {f"level_{i}.tracking_time": values[f"level_{i}.integral_time"] for i in (1, 2)}
        state = found.controller.initial_state
        last = {name: name.replace(".", ".last_") for name in moved}
        state = state | {last[n]: values[n] for n in moved if last[n] in state}
        other = dataclasses.replace(found.controller, values=values, initial_state=state)
        if sampled_loop(other, model).maximum_sensitivity > 2.0:
            continue
        kept += 1
        scores = scores_of(Loop(other, model).run(scenario))
        ratio = max(scores[k] / found.start_scores[k] for k in found.scores)
        assert ratio >= found.objective * (1 - 1e-6)
    assert kept > 10
