"""How sure a controller is: its own numbers against draws one by one, and causes that are known."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.studies.robustness.drawn_loops import ERROR, DrawnLoops
from clepsydra.studies.robustness.drawn_plants import DrawnPlants, GivenPlants
from clepsydra.studies.robustness.robustness import robustness_of


def loops_of(name):
    plant = cl.load(name)
    plants = DrawnPlants(plant.point, plant.analysis.pairing, plant.process.uncertainty)
    return DrawnLoops(cl.design.simc(plant), default_scenario(plant.linear), plants, ())


@pytest.fixture(scope="module")
def found():
    return robustness_of(loops_of("three-tanks"), 300, rows=64)


def test_the_worst_draw_is_the_worst_run(found):
    worst = found.worst("iae[level_3]")
    run = cl.simulate("three-tanks", found.loops.controller)  # of the plant itself
    from_run = found.run(worst.draw)
    error = np.abs(from_run.values["level_3.setpoint"] - from_run.true_measurement("level_3"))
    assert error.sum() * from_run.process.sampling_period == pytest.approx(worst.value, rel=0.05)
    assert worst.value > run.scores["iae[level_3]"]


def test_quantiles_are_those_of_the_draws(found):
    drawn = found.loops.draw(np.arange(1, 301)).scores["iae[level_3]"][0]
    quantile = found.quantile("iae[level_3]", 0.95)
    assert quantile.value == np.sort(drawn)[285 - 1]
    assert quantile.low < quantile.value < quantile.high


def test_the_error_of_the_plant_itself_is_1(found):
    assert found.nominal[ERROR] == 1.0
    assert 1.0 < found.quantile(ERROR).value < 2.0


def test_given_plants_are_counted_from_1():
    plant = cl.load("three-tanks")
    areas = {"tank_1.area": np.array([0.0150, 0.0160])}
    given = GivenPlants(plant.point, plant.analysis.pairing, areas)
    loops = DrawnLoops(
        cl.design.simc(plant), default_scenario(plant.linear), given, ("iae[level_3]",)
    )
    found = loops.draw(np.arange(3)).scores["iae[level_3]"][0]
    assert loops.run(2).process.signal("tank_1.area").initial == 0.0160
    assert len(set(found)) == 3


def test_no_draw_and_unknown_scores_are_refused(found):
    loops = loops_of("three-tanks")
    with refused(value=0, expected="at least 1"):
        robustness_of(loops, 0)
    with refused(value="iae[pump]", expected="iae"):
        robustness_of(loops, 10, scores=["iae[pump]"])
    with refused(value="wear", expected="iae[level_3]"):
        found.quantile("wear")
