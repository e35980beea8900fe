"""Levels that average, tuned for what ranks them, within a band of levels."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Limits, minimax
from clepsydra.studies.tuning.parameters import TunedParameter, settings_of
from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.usual_goal import usual_goal

SCORES = ("outflow_rate[level]", "variance_ratio[level]")


@pytest.fixture(scope="module")
def basin():
    return cl.load("equalisation-tank")


@pytest.fixture(scope="module")
def controller(basin):
    return cl.design.arrest_time(basin)


@pytest.mark.thorough
def test_a_study_tunes_a_basin_for_the_scores_that_rank_it():
    study = cl.study("equalisation-tank", only="PI, arrest time, tuned")
    assert len(study.ranking) == 2  # with the one that it starts from
    start, tuned = study["PI, arrest time"], study["PI, arrest time, tuned"]
    assert tuned.standing is start.standing and tuned.rank < start.rank
    ratios = [tuned.scores[name] / start.scores[name] for name in SCORES]
    assert tuned.tuning.objective == pytest.approx(sum(ratios) / 2.0, rel=1e-9)
    assert sum(ratios) < 2.0
    for name in SCORES:
        assert tuned.tuning.scores[name] == pytest.approx(tuned.scores[name], rel=1e-9), name
    # It has no more room than its start took: half full is 2.5 m.
    levels = [np.abs(each.run.values["basin.level"] - 2.5).max() for each in (start, tuned)]
    assert levels[1] <= levels[0] * (1.0 + 1e-5)
    assert "basin.level at most 4.47 m" in tuned.tuning.binding


def test_a_basin_that_takes_longer_to_rest_than_its_loads_last_may_stay_as_it_is(basin, controller):
    """Two modes that take 58 h to a hundredth, and load steps of 17 h."""
    scenario = default_scenario(basin.measured)
    goal = usual_goal(controller, basin.measured, scenario)
    problem = TuningProblem(LawSpace(controller, settings_of(controller)), goal)
    problem.begin()
    loads = [part.stop - part.start for part in scenario.segments if part.kind == "load"]
    assert min(loads) < problem.loops.decay_times(problem.space.start[None])[0]
    assert problem.best is not None and problem.best.objective == pytest.approx(1.0)


@pytest.mark.thorough
def test_a_limit_of_a_level_binds_where_the_level_stands_on_it(basin, controller):
    scenario = default_scenario(basin.linear)
    gain = controller.values["level.proportional_gain"]
    bounds = [TunedParameter("level.proportional_gain", 10.0 * gain, 0.1 * gain)]
    free, kept = (
        tune(
            LawSpace(controller, bounds),
            Goal(basin.linear, scenario, minimax(SCORES[1]), limits),
            Search(generations=8),
        )
        for limits in (Limits(), Limits(levels={"basin.level": (0.5, 4.3)}))
    )
    run = Loop(kept.controller, basin.linear).run(scenario)
    assert run.values["basin.level"].max() == pytest.approx(4.3, rel=1e-5)
    assert kept.binding == ("basin.level at most 4.3 m",)
    assert free.objective < kept.objective
