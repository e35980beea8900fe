"""Long runs of a study side by side: its results are those of runs made one by one."""

import math

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.studies import long_runs


@pytest.fixture
def groups(monkeypatch):
    """The names of the controllers of each group that is run side by side, all runs being long."""
    found, run = [], long_runs.checked_runs

    def told(loops, *more):
        found.append([loop.controller.name for loop in loops])
        return run(loops, *more)

    monkeypatch.setattr(long_runs, "LONG", 0.0)
    monkeypatch.setattr(long_runs, "checked_runs", told)
    return found


def test_a_study_has_the_bits_of_one_whose_runs_are_short(groups, monkeypatch):
    plant = cl.load("three-tanks")
    designs = (cl.design.simc, cl.design.amigo, cl.design.lambda_, cl.design.lqi, cl.design.lqr)
    together = cl.study(plant, [design(plant) for design in designs])
    pi = [design(plant).name for design in designs[:3]]
    assert groups == [pi]
    monkeypatch.setattr(long_runs, "LONG", math.inf)
    alone = cl.study(plant, [design(plant) for design in designs])
    assert len(groups) == 1
    assert together.as_dict() == alone.as_dict()
    for one, other in zip(together.ranking, alone.ranking, strict=True):
        assert one.run.values.keys() == other.run.values.keys()
        assert all(np.array_equal(one.run.values[k], v) for k, v in other.run.values.items())


def test_what_does_not_apply_is_passed_over_and_refused_in_its_turn(groups):
    plant = cl.load("three-tanks")
    told = []
    whole = cl.study(plant, progress=lambda now: told.append(now.name))
    assert groups[0][:2] == ["PI, SIMC", "PI, lambda"]
    assert len(groups[0]) == 5
    refused = [name for name, _ in whole.not_applicable]
    assert refused and not set(refused) & {name for group in groups for name in group}
    order = list(dict.fromkeys(told))
    assert order[0] == "PI, arrest time" and order.index("PI, SIMC") < order.index("PI, lambda")


def test_a_mistake_in_what_comes_later_is_not_told_before_its_turn(groups):
    plant = cl.load("three-tanks")
    scenario = cl.simulate(plant, cl.design.simc(plant)).scenario
    runs = long_runs.LongRuns(plant.measured, scenario)

    def later():
        yield cl.design.amigo(plant)
        raise cl.InputError("a later controller", 1, "another", "take another")

    first = cl.design.simc(plant)
    run = runs.of(first, later())
    assert run.controller is first
    assert [len(group) for group in groups] == [2]
