"""Draws of a controller over plants: each alone as among others, and as an ordinary run."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.engine.host import host
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.studies.robustness import drawn_loops
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.trial import scores_of

CHANNEL = str(Path(__file__).parents[2] / "dead-time.toml")
PLANTS = (
    "quadruple-tank", "three-tanks", "averaging-tank", "laboratory-four-tanks", "wet-well", CHANNEL,
)  # fmt: skip


def loops_of(name, design="simc"):
    plant = cl.load(name)
    plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty)
    names = tuple(f"iae[{y}]" for y in plant.process.controlled)
    controller = getattr(cl.design, design)(plant)
    return DrawnLoops(controller, default_scenario(plant.linear), plants, names)


def final_state(loops, numbers):
    values = loops.plants.values(numbers)
    rest = loops.plants.rest(numbers, values)
    return loops._batch.run(loops.plants.plants(numbers, values, rest)).final_state, rest.feasible


@pytest.mark.parametrize("name", PLANTS)
def test_a_draw_ends_as_its_own_run_in_every_bit(name):
    loops = loops_of(name)
    states, feasible = final_state(loops, np.arange(12))
    compared = 0
    for place, number in enumerate(np.flatnonzero(feasible)[:4]):
        ended = loops.run(int(number)).final_state
        own = {**ended.contents, **{n: v for n, v in ended.numbers.items() if n in states}}
        assert len(own.keys() - ended.contents.keys()) > 0  # of the law
        for key in states.keys() & own.keys():
            assert states[key][place] == own[key], (name, number, key)
            compared += 1
    assert compared > 20


@pytest.mark.parametrize("name", PLANTS)
def test_a_draw_alone_is_that_draw_of_many_in_every_bit(name):
    loops = loops_of(name)
    many = loops.draw(np.arange(40))
    for number in (0, 1, 17, 39):
        alone = loops.draw(np.array([number]))
        for key, values in many.scores.items():
            np.testing.assert_array_equal(alone.scores[key][:, 0], values[:, number])
        for what, truths in many.happened.items():
            assert alone.happened[what][0] == truths[number]


def test_each_draw_has_noise_of_its_own():
    loops = loops_of("quadruple-tank")
    one, other = loops.run(1).scenario, loops.run(2).scenario
    assert loops.scenario.noise[-1].any()
    assert (one.noise[-1] != other.noise[-1]).all()
    np.testing.assert_array_equal(loops.run(0).scenario.noise, loops.scenario.noise)


def test_draws_without_fused_operations_are_other_ones_and_end_as_their_own_runs():
    fused = loops_of("quadruple-tank")
    loops = replace(fused, fuse=False)
    assert (loops.digest != fused.digest) == host().fuses
    states, _ = final_state(loops, np.arange(4))
    ended = loops.run(3).final_state
    for key, value in ended.contents.items():
        assert states[key][3] == value
    others, _ = final_state(fused, np.arange(4))
    changed = any(np.any(states[key] != others[key]) for key in ended.contents)
    assert changed == host().fuses


def test_a_processor_that_does_not_fuse_is_refused_where_that_is_asked_for(monkeypatch):
    loops = loops_of("quadruple-tank")
    monkeypatch.setattr(drawn_loops, "host", lambda: replace(host(), fuses=False))
    with refused(
        place="draws", value="a processor that fuses no multiply-adds", remedy="draws without"
    ):
        replace(loops, fuse=True).draw(np.arange(2))
    assert not loops_of("quadruple-tank").fuse


@pytest.mark.parametrize("design", ("simc", "lqi"))
def test_loops_that_were_pickled_draw_the_same(design):
    """The law of them is then one of kept equations, whose kernels are found by the law."""
    loops = loops_of("laboratory-four-tanks", design)
    found = loops.draw(np.arange(20))
    again = pickle.loads(pickle.dumps(loops))
    kept = {"_batch", "_equilibria"}  # which are found anew where they are needed
    assert kept <= vars(loops).keys() | vars(loops.plants).keys()
    assert not kept & (vars(again).keys() | vars(again.plants).keys())
    assert again.digest == loops.digest
    for key, values in again.draw(np.arange(20)).scores.items():
        np.testing.assert_array_equal(values, found.scores[key])


def test_the_scores_of_events_add_up_to_that_of_the_run():
    loops = loops_of("quadruple-tank")
    found = loops.draw(np.arange(8)).scores["iae[level_1]"]
    np.testing.assert_allclose(found[1:].sum(axis=0), found[0], rtol=1e-13)
    for number in (0, 3):
        one = scores_of(loops.run(number))["iae[level_1]"]  # of a stored run, summed pairwise
        assert found[0, number] == pytest.approx(one, rel=1e-12)


def test_an_offset_is_found_where_a_law_has_no_integral():
    """A law that knows its plant by a model alone leaves an error on another one."""
    plant = cl.load("quadruple-tank")
    plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty)
    scenario = default_scenario(plant.linear)
    found = {}
    for design in ("lqr", "lqi"):
        controller = getattr(cl.design, design)(plant)
        drawn = DrawnLoops(controller, scenario, plants, ()).draw(np.arange(200))
        found[design] = drawn.happened[Happening.STEADY]
    assert not found["lqi"][0]
    assert found["lqr"][1:].mean() > 0.5
    assert found["lqi"][1:].mean() < 0.05


def test_a_draw_without_a_steady_state_is_counted_and_has_no_score():
    loops = loops_of("laboratory-four-tanks")
    found = loops.draw(np.arange(200))
    infeasible = found.happened[Happening.INFEASIBLE]
    assert 0 < infeasible.sum() < 200
    assert np.isnan(found.scores["iae[level_1]"][:, infeasible]).all()
    assert np.isfinite(found.scores["iae[level_1]"][:, ~infeasible]).all()
    with pytest.raises(cl.InputError, match="admissible steady state"):
        loops.run(int(np.flatnonzero(infeasible)[0]))
