"""The order over several cases, on trials made by hand."""

import math
from dataclasses import replace

import pytest

import clepsydra as cl
from clepsydra.studies.case_ranking import rank_cases
from clepsydra.studies.ranking import Standing, Trial, rank


@pytest.fixture(scope="module")
def trial():
    """Return a function that makes a trial from its error and the peak of its sensitivity."""
    plant = cl.load("quadruple-tank")
    run = cl.simulate(plant, cl.design.simc(plant), [], duration="5 min")

    def made(name, error, peak=1.5, moves=1.0):
        controller = replace(run.controller, name=name)
        scores = {f"iae_setpoint[{level}]": error for level in ("level_1", "level_2")}
        scores |= {f"total_variation[{pump}]": moves for pump in ("pump_1", "pump_2")}
        return Trial(controller, replace(run, controller=controller), scores, peak, ())

    return made


def names(ranking):
    return [each.controller.name for each in ranking]


def test_one_that_is_unsafe_in_a_case_decides_nothing_between_two_others(trial):
    """The figures of the decision: A is the best of the base case and unsafe in the other."""
    base = [trial("a", 1.0), trial("b", 1.8), trial("c", 1.3)]
    other = [trial("a", 9.0, math.inf), trial("b", 1.0), trial("c", 1.6)]
    ranking, by_case = rank_cases(base, {"other": other})
    assert names(ranking) == ["b", "c", "a"]
    assert [each.mean_error for each in ranking[:2]] == pytest.approx([1.8 / 1.3, 1.6])
    assert ranking[2].standing is Standing.UNSAFE
    assert names(by_case["other"]) == ["b", "c", "a"]
    assert names(rank_cases(base[1:], {"other": other[1:]}).overall) == ["b", "c"]


def test_the_worst_standing_counts_before_any_error(trial):
    base = [trial("fast", 1.0), trial("slow", 5.0)]
    ranking, _ = rank_cases(base, {"other": [trial("fast", 1.0, 2.5), trial("slow", 5.0)]})
    assert names(rank(base)) == ["fast", "slow"] and names(ranking) == ["slow", "fast"]
    assert ranking[1].standing is Standing.STABLE
    worst = "In the worst case (other): stable with thin margins (max|S| 2.50)."
    assert ranking[1].reason.startswith(worst)


def test_one_that_does_not_apply_in_a_case_comes_last(trial):
    base = [trial("some", 1.0), trial("all", 5.0, 2.5)]
    ranking, by_case = rank_cases(base, {"other": [trial("all", 5.0, 2.5)]})
    assert names(ranking) == ["all", "some"] and names(by_case["other"]) == ["all"]
    assert ranking[1].cases["other"] is None and ranking[1].mean_error == math.inf
    assert ranking[1].reason.startswith("Does not apply in a case (other).")


def test_moves_decide_between_equals_by_the_case_with_the_most(trial):
    base = [trial("calm", 1.0, moves=2000.0), trial("wild", 1.0, moves=2000.0)]
    other = [trial("calm", 1.01, moves=2000.0), trial("wild", 1.0, moves=9000.0)]
    assert names(rank_cases(base, {"other": other}).overall) == ["calm", "wild"]


def test_without_cases_it_is_the_usual_order(trial):
    base = [trial("a", 2.0), trial("b", 1.0)]
    found, by_case = rank_cases(base, {})
    assert names(found) == names(rank(base)) == ["b", "a"] and by_case == {}
    assert [each.cases for each in found] == [{}, {}]
    assert rank_cases([], {"other": []}).by_case == {"other": ()}
