"""Plants of a batch, each with noise of its own, against loops under the noise of a scenario."""

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.begin import begin_from
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_batch import LoopBatch
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.loop.with_noise import with_noise

SAMPLES, FIRST, SEED, PLANTS = 300, 41, 7, 10


@pytest.mark.parametrize(
    ("name", "noisy"),
    [("averaging-tank", 2), ("equalisation-tank", 2), ("laboratory-four-tanks", 6)],
)
def test_a_plant_of_a_batch_has_the_noise_of_its_number(name, noisy):
    """Of measurements, and of disturbances that have a course of their own."""
    plant = cl.load(name)
    process, point = plant.process, plant.point
    loop = Loop(cl.design.simc(plant), plant.measured)
    quiet = scenario_of_changes(point, (), SAMPLES)
    course = quiet.disturbances + 0.01 * np.sin(np.arange(SAMPLES))[:, None]
    quiet = replace(quiet, disturbances=course)
    scenario = with_noise(replace(quiet, seed=SEED), process, FIRST)
    assert len(scenario.noises) == noisy
    batch = LoopBatch(loop, scenario, [f"iae[{y}]" for y in process.controlled])
    state, inputs = (np.tile(each[:, None], PLANTS) for each in (point.state, point.inputs))
    found = batch.run(ManyPlants(point, state, inputs, numbers=np.arange(PLANTS)))
    begin = begin_from(point, "rest", controller_start="bumpless")
    for number in range(PLANTS):
        own = replace(quiet, seed=SEED + number * 2**32, begin=begin)
        run = loop.run(with_noise(own, process, FIRST), substeps=batch.substeps)
        ended = {**run.final_state.contents, **run.final_state.numbers}
        same = found.final_state.keys() & ended.keys()
        assert len(same) >= len(process.state)
        for key in same:
            assert found.final_state[key][number] == ended[key], (number, key)
    assert all(len(set(found.final_state[s.name])) == PLANTS for s in process.motion.contents)
