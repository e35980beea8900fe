"""Tuning for what most of many drawn plants keep, beside tuning for the plant itself."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.linear.linearise import linearise
from clepsydra.loop.begin import begin_from
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.profile import Change
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.process.uncertainty import Rule, Uncertainty
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.trial import scores_of
from clepsydra.studies.tuning.drawn_problem import DrawnProblem
from clepsydra.studies.tuning.draws import Draws, draws_at
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Limits, minimax
from clepsydra.studies.tuning.parameters import settings_of
from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.tune import Search, tune

LIMITS = Limits(2.0, overshoot_if_stepped=10.0, noise_movement=0.045)
HARMS = (Happening.OVERFLOW, Happening.DRY, Happening.HARM, Happening.UNSTABLE, Happening.UNSOLVED)


class Case:
    """A plant with a controller and a goal, and plants that are up to a share different."""

    def __init__(self, name, share=0.25, scenario=None):
        self.plant = cl.load(name)
        self.controller = cl.design.simc(self.plant)
        self.space = LawSpace(self.controller, settings_of(self.controller))
        self.names = [f"iae[{y}]" for y in self.plant.process.controlled]
        self.rules = Uncertainty(default=Rule(share=share, shared=True, clipped=True))
        self.scenario = scenario or default_scenario(self.plant.linear)

    def plants(self, seed=1, rules=None):
        pairing = self.plant.analysis.pairing
        return DrawnPlants(self.plant.point, pairing, rules or self.rules, seed)

    def goal(self, draws=None):
        model = self.plant.measured
        return Goal(model, self.scenario, minimax(*self.names), LIMITS, draws)

    def tuned(self, draws=None, **search):
        return tune(self.space, self.goal(draws), Search(generations=8, **search))


@pytest.fixture(scope="module")
def tanks():
    return Case("three-tanks")


def step_of(name, signal, size, samples):
    point = cl.load(name).point
    return scenario_of_changes(
        point, [Change(signal, point.as_dict()[signal] + size, 5, 5)], samples
    )


@pytest.fixture(scope="module")
def quick():
    """One step of 2 cm in five minutes."""
    return Case("three-tanks", scenario=step_of("three-tanks", "level_3", 0.02, 300))


# What it brings ----------------------------------------------------------------------------


def quantile(case, controller, chance=0.95):
    """The quantile over 500 plants of another seed, by the batch of a study of robustness."""
    loops = DrawnLoops(controller, case.scenario, case.plants(seed=2), tuple(case.names))
    drawn = loops.draw(np.arange(1, 501))
    (score,) = (drawn.scores[name][0] for name in case.names)
    harmed = np.any([drawn.happened[what] for what in HARMS], axis=0)
    counted = np.sort(np.where(harmed, np.inf, score)[~np.isnan(score)])
    return counted[int(np.ceil(chance * len(counted))) - 1]


def test_on_other_plants_it_is_better_than_what_is_best_for_the_plant_itself(tanks):
    alone, over = tanks.tuned(), tanks.tuned(Draws(tanks.plants(), 64))
    first, last = (quantile(tanks, each.controller) for each in (alone, over))
    assert np.isfinite(last) and last < 0.95 * first
    # The price is paid on the plant itself, whose limits hold.
    assert over.scores["iae[level_3]"] > alone.scores["iae[level_3]"]
    assert over.maximum_sensitivity <= 2.0 + 1e-4
    assert over.scores["overshoot[level_3]"] <= 10.01
    told = over.over_draws
    assert told.tuned.objective < told.of_plant_alone.objective < told.start.objective


# What is computed --------------------------------------------------------------------------


def points_of(case, count):
    generator = np.random.default_rng(3)
    start = case.space.start
    return np.vstack(
        [start, np.clip(start + 0.05 * generator.standard_normal((count, len(start))), 0, 1)]
    )


def test_the_quantile_is_a_score_of_draws_that_are_run_one_by_one(quick):
    """The 13th best of 16 is the 80 % quantile, by runs of each draw with its trajectories."""
    problem = DrawnProblem(quick.space, quick.goal(Draws(quick.plants(), 16, 0.8)))
    problem.begin()
    problem.take_draws()
    point = quick.space.start + 0.05
    values = {name: float(each[0]) for name, each in quick.space.values_at(point[None]).items()}
    changed = replace(quick.controller, values={**quick.controller.values, **values})
    loops = DrawnLoops(changed, quick.scenario, quick.plants(), tuple(quick.names))
    runs = [scores_of(loops.run(number))["iae[level_3]"] for number in range(1, 17)]
    own = sorted(runs)[12] / problem.start_scores["iae[level_3]"]
    assert len(set(runs)) == 16
    assert problem.evaluate(point[None]).objective[0] == pytest.approx(own, rel=1e-9)


def test_plants_that_are_all_the_plant_itself_have_the_objective_of_an_ordinary_tuning(quick):
    area = quick.plant.process.signal("tank_1.area").initial
    same = Uncertainty(
        default=Rule(share=0.0, shared=True), named={"tank_1.area": Rule("values", values=(area,))}
    )
    points = points_of(quick, 20)
    ordinary = TuningProblem(quick.space, quick.goal())
    drawn = DrawnProblem(quick.space, quick.goal(Draws(quick.plants(rules=same), 5)))
    for problem in (ordinary, drawn):
        problem.begin()
    drawn.take_draws()
    own, many = (each.evaluate(points) for each in (ordinary, drawn))
    assert np.ptp(own.objective[np.isfinite(own.objective)]) > 0.1
    np.testing.assert_allclose(many.objective, own.objective, rtol=1e-9)
    found = [quick.tuned(draws) for draws in (None, drawn.draws)]
    assert found[1].objective == pytest.approx(found[0].objective, rel=1e-4)


def test_a_candidate_alone_is_that_candidate_among_others_in_every_bit(quick):
    points = points_of(quick, 40)
    found = []
    for parts in ([points], np.split(points, len(points))):
        problem = DrawnProblem(quick.space, quick.goal(Draws(quick.plants(), 12)))
        problem.begin()
        problem.take_draws()
        found.append(np.concatenate([problem.evaluate(part).objective for part in parts]))
    np.testing.assert_array_equal(*found)


def test_what_passes_a_limit_is_not_tried_on_drawn_plants(quick):
    problem = DrawnProblem(quick.space, quick.goal(Draws(quick.plants(), 8)))
    problem.begin()
    problem.take_draws()
    tried = set(problem.memory.drawn)
    wild = np.ones((1, len(quick.space.start)))
    assert problem.loops.sensitivities(wild)[0] > 2.0
    problem.evaluate(wild)
    assert set(problem.memory.drawn) == tried


# Plants on which a candidate fails ---------------------------------------------------------


@pytest.fixture(scope="module")
def quadruple():
    """Plants whose holes and areas are up to a fifth different: on some a tank runs empty."""
    return Case("quadruple-tank", 0.2, step_of("quadruple-tank", "level_1", 1.0, 600))


def failing(case, quantile):
    problem = DrawnProblem(case.space, case.goal(Draws(case.plants(), 32, quantile)))
    problem.begin()
    problem.take_draws()
    return problem


def test_as_many_plants_may_fail_as_the_quantile_leaves_out(quadruple):
    loops = DrawnLoops(quadruple.controller, quadruple.scenario, quadruple.plants(), ())
    drawn = loops.draw(np.arange(1, 33))
    able = ~drawn.happened[Happening.INFEASIBLE]
    failed = int(np.sum(np.any([drawn.happened[what][able] for what in HARMS], axis=0)))
    count = int(np.sum(able))
    assert 1 < failed < count < 32
    start = quadruple.space.start[None]
    for spared, works in ((failed, True), (failed - 1, False)):
        problem = failing(quadruple, (count - spared - 0.5) / count)
        assert (problem.draws.able, problem.draws.bearable) == (count, spared)
        found = problem.evaluate(start)
        assert bool(found.violation[0] == 0.0) is works
        told = problem.over(quadruple.controller.values)
        assert told.failed == failed and bool(np.isfinite(told.objective)) is works
        assert sum(problem.draws.left_out.values()) == 32 - count
        if not works:  # by one plant of all
            assert found.violation[0] == pytest.approx(1 / count)


def test_where_no_candidate_works_on_enough_plants_it_is_told_what_happens(quadruple):
    with pytest.raises(NotApplicable) as caught:
        quadruple.tuned(Draws(quadruple.plants(), 32, 0.99))
    reason = caught.value.reason
    assert "a tank runs empty on" in reason and "lower the quantile" in reason


# Interruption ------------------------------------------------------------------------------


class Stop:
    """Presses control-C after some batches, or at the first one of a stage."""

    def __init__(self, after=10**9, stage=""):
        self.left, self.stage, self.stages = after, stage, []

    def __call__(self, progress):
        self.stages.append(progress.stage)
        self.left -= 1
        if self.left == 0 or progress.stage == self.stage:
            self.stage = ""
            raise KeyboardInterrupt


def same(one, other):
    return (
        one.controller.values == other.controller.values
        and one.controller.notes == other.controller.notes
        and one.over_draws.tuned == other.over_draws.tuned
        and np.array_equal(one.history, other.history)
        and np.array_equal(one.front.objective, other.front.objective)
    )


def test_a_resumed_tuning_ends_as_one_without_a_break(quick, tmp_path):
    draws, count = Draws(quick.plants(), 12), Stop()
    whole = quick.tuned(draws, progress=count)
    first = count.stages.index("search over drawn plants")
    path = tmp_path / "state.json"
    stops = (
        Stop(first // 2), Stop(stage="search over drawn plants"),
        Stop((first + len(count.stages)) // 2),
    )  # fmt: skip
    for stop in stops:
        broken = quick.tuned(draws, progress=stop, state_file=path)
        assert broken.interrupted and broken.objective >= whole.objective
        assert broken.over_draws.tuned.objective == broken.objective
    assert len(json.loads(path.read_text())["drawn"]) > 0
    assert same(quick.tuned(draws, state_file=path), whole)
    after = Stop()
    assert same(quick.tuned(draws, state_file=path, progress=after), whole)
    assert "search over drawn plants" in after.stages


@pytest.mark.parametrize("other", ["count", "quantile", "seed", "rules", "none"])
def test_the_state_of_other_draws_is_refused(quick, tmp_path, other):
    path = tmp_path / "state.json"
    draws = Draws(quick.plants(), 6)
    problem = DrawnProblem(quick.space, quick.goal(draws))
    problem.memory.save(path)
    changed = {
        "count": lambda: Draws(quick.plants(), 7),
        "quantile": lambda: Draws(quick.plants(), 6, 0.9),
        "seed": lambda: Draws(quick.plants(seed=2), 6),
        "rules": lambda: Draws(quick.plants(rules=Uncertainty()), 6),
        "none": lambda: None,
    }[other]()
    with refused(place=str(path), value="the state of another problem", remedy="another file"):
        quick.tuned(changed, state_file=path)


# What is asked for -------------------------------------------------------------------------


def test_a_process_of_which_nothing_varies_has_no_draws(tanks):
    sure = Uncertainty(default=Rule(share=0.0, shared=True))
    process = dataclasses.replace(tanks.plant.process, uncertainty=sure)
    model = linearise(dataclasses.replace(tanks.plant.point, process=process))
    with refused(
        place="tuning, draws", value=64, expected="three-tanks has none", remedy="[uncertainty]"
    ):
        draws_at(model, 64)


def test_a_scenario_that_begins_away_from_rest_is_refused(quick):
    begin = begin_from(quick.plant.point, "empty")
    goal = replace(
        quick.goal(Draws(quick.plants(), 4)), scenario=replace(quick.scenario, begin=begin)
    )
    with refused(place="tuning, draws", value=4, expected="begins at rest", remedy="leave draws"):
        DrawnProblem(quick.space, goal)
