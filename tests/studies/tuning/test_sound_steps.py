"""Tuning where the step from the operating point is too long for what happens in the scenario."""

import dataclasses

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError
from clepsydra.loop import step_size
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning import batch as batches
from clepsydra.studies.tuning.batch import BatchEvaluation

PERIOD, SAMPLES = 60.0, 60
SCORE = "iae[level_1]"


@pytest.fixture
def plant(monkeypatch) -> cl.Plant:
    """A time constant of 23 s in a step of a minute: RK4 is at the end of its reach."""
    monkeypatch.setattr(step_size, "REACH", 10.0)
    process = dataclasses.replace(cl.load("quadruple-tank").process, sampling_period=PERIOD)
    return cl.Plant(process)


def scenario(plant: cl.Plant) -> Scenario:
    at_rest = [plant.point.as_dict()[name] for name in plant.process.controlled]
    setpoints = np.tile(at_rest, (SAMPLES, 1))
    setpoints[5:] += 2.0
    none = np.zeros((SAMPLES, 2))
    return Scenario(PERIOD, setpoints, none, np.zeros((SAMPLES, 4)), (), 1)


@pytest.mark.thorough
def test_the_steps_of_a_tuning_are_halved_until_the_start_is_sound(plant, monkeypatch):
    """The mark of the start once hid the same mark of every candidate."""
    controller, model = cl.design.simc(plant), plant.linear
    loop, plan = Loop(controller, model), scenario(plant)
    assert loop.substeps == 1
    found = BatchEvaluation(controller, model, plan, [SCORE]).run({})
    assert found.status.tolist() == [0]
    coarse, fine = (loop.run(plan, substeps=n).true_measurement("level_1") for n in (1, 64))
    assert np.max(np.abs(coarse - fine)) > 0.01 * np.ptp(fine)
    monkeypatch.setattr(step_size, "REACH", 0.05)
    truth = BatchEvaluation(controller, model, plan, [SCORE]).run({}).scores[SCORE]
    assert found.scores[SCORE] == pytest.approx(truth, rel=1e-3)


def test_a_start_that_no_step_suits_is_refused(plant, monkeypatch):
    monkeypatch.setattr(batches, "LARGEST_REFINEMENT", 1)
    controller, model = cl.design.simc(plant), plant.linear
    with pytest.raises(InputError) as caught:
        BatchEvaluation(controller, model, scenario(plant), [SCORE])
    assert caught.value.place == f"tuning, {controller.name}, integration"
    assert "1 steps in a sampling period" in str(caught.value.value)
