"""A batch of one plant is the single run; plants of a batch do not depend on each other."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.begin import begin_from
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_batch import LoopBatch
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.loop.stretches import stretches_of


def alone(point):
    return ManyPlants(point, point.state[:, None], point.inputs[:, None])


@pytest.mark.parametrize(
    ("name", "design"),
    [
        ("quadruple-tank", "simc"),
        ("quadruple-tank", "lqi_kalman"),
        ("quadruple-tank", "feedback_linearisation"),
        ("averaging-tank", "simc"),
        ("eight-tanks", "simc"),
        ("wet-well", "simc"),
        ("laboratory-four-tanks", "simc"),
    ],
)
def test_a_batch_of_one_ends_as_the_single_run_in_every_bit(name, design):
    plant = cl.load(name)
    loop = Loop(getattr(cl.design, design)(plant), plant.measured)
    scenario = default_scenario(plant.linear)
    scores = [f"iae[{y}]" for y in plant.process.controlled]
    batch = LoopBatch(loop, scenario, scores)
    found = batch.run(alone(plant.point))
    begin = begin_from(plant.point, "rest", controller_start="bumpless")
    run = loop.run(replace(scenario, begin=begin), substeps=batch.substeps)
    ended = {**run.final_state.contents, **run.final_state.numbers}
    same = found.final_state.keys() & ended.keys()
    assert len(same) >= len(plant.process.state)
    for key in same:
        assert found.final_state[key][0] == ended[key], key


def test_a_plant_for_which_the_step_is_too_long_runs_again_with_half_of_it():
    """A first tank of a hundredth of its width empties in seconds, not in a minute."""
    plant = cl.load("quadruple-tank")
    loop = Loop(cl.design.simc(plant), plant.measured)
    batch = LoopBatch(loop, default_scenario(plant.linear), ["iae[level_1]"])
    state, inputs = (np.tile(each[:, None], 2) for each in (plant.point.state, plant.point.inputs))
    areas = {"tank_3.area": np.array([28e-4, 28e-6])}
    found = batch.run(ManyPlants(plant.point, state, inputs, areas))
    assert found.substeps[0] == batch.substeps < found.substeps[1]
    own = batch.run(alone(plant.point))
    for key, values in found.final_state.items():
        assert values[0] == own.final_state[key][0]


def test_every_sample_is_in_one_part_of_one_stretch():
    for name in ("quadruple-tank", "wet-well"):
        scenario = default_scenario(cl.load(name).linear)
        spans = [span for stretch in stretches_of(scenario) for span in stretch.spans]
        assert spans[0][0] == 0
        assert spans[-1][1] == scenario.samples
        assert all(one[1] == other[0] for one, other in pairwise(spans))


def test_a_disturbance_of_its_own_moves_the_course_of_a_plant():
    plant = cl.load("quadruple-tank")
    loop = Loop(cl.design.simc(plant), plant.measured)
    scenario = default_scenario(plant.linear)
    batch = LoopBatch(loop, scenario, ["iae[level_1]"])
    state, inputs = (np.tile(each[:, None], 2) for each in (plant.point.state, plant.point.inputs))
    poured = {"inflow_1": np.array([0.0, 1e-6])}
    found = batch.run(ManyPlants(plant.point, state, inputs, poured))
    moved = replace(
        scenario,
        disturbances=scenario.disturbances + [1e-6, 0.0],
        begin=begin_from(plant.point, "rest", controller_start="bumpless"),
    )
    run = loop.run(moved, substeps=batch.substeps)
    ended = {**run.final_state.contents, **run.final_state.numbers}
    for key in found.final_state.keys() & ended.keys():
        assert found.final_state[key][1] == ended[key]
