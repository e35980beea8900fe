"""A loop in a batch that makes its own noise, against the loop under the noise of a scenario."""

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.engine.batch_noise import BatchNoise, InputNoise
from clepsydra.engine.white_noise import seed_of
from clepsydra.loop.law_begin import loop_begin
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.loop.with_noise import with_noise

SAMPLES, FIRST, SEED, SCENARIOS = 300, 41, 7, 10


@pytest.mark.parametrize(
    ("name", "noisy"),
    [("averaging-tank", 2), ("equalisation-tank", 2), ("laboratory-four-tanks", 6)],
)
def test_a_scenario_of_a_batch_is_that_made_alone(name, noisy):
    """Of measurements, and of disturbances that have a course of their own."""
    plant = cl.load(name)
    process = plant.process
    loop = Loop(cl.design.simc(plant), plant.linear)
    quiet = scenario_of_changes(plant.point, (), SAMPLES)
    course = quiet.disturbances + 0.01 * np.sin(np.arange(SAMPLES))[:, None]
    quiet = replace(quiet, disturbances=course)
    kernel = loop_kernel(process, loop.controller, {}, loop.substeps)
    state, rings = loop_begin(loop, quiet, loop.substeps)
    given = {"parameters": loop.law_parameters(), "state": state, "rings": rings}
    noises = with_noise(replace(quiet, seed=SEED), process, FIRST).noises
    assert len(noises) == noisy
    measured = {signal.name for signal in process.measurements}
    inputs = {
        f"{each.signal}.noise" if each.signal in measured else each.signal: InputNoise(
            each.stream, each.deviation, each.first, each.count
        )
        for each in noises
    }
    batch = kernel.run(
        SAMPLES, inputs=loop.inputs_of(quiet), noise=BatchNoise(inputs, SEED, range(SCENARIOS)),
        **given,
    )  # fmt: skip
    for number in range(SCENARIOS):
        noisy = with_noise(replace(quiet, seed=seed_of(SEED, number)), process, FIRST)
        alone = kernel.run(SAMPLES, inputs=loop.inputs_of(noisy), **given)
        assert batch.record_of(number).tobytes() == alone.record_of(0).tobytes()
        assert batch.final_state[:, number].tobytes() == alone.final_state[:, 0].tobytes()
    assert np.any(batch.record_of(0) != batch.record_of(1))
