"""`cl.robustness` by its door: causes that are known, plants that cannot be, and refusals."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl

STILL = {"default": "0 %"}


@pytest.fixture(scope="module")
def plant():
    return cl.load("three-tanks")


@pytest.fixture(scope="module")
def controller(plant):
    return cl.design.simc(plant)


def test_a_parameter_that_alone_varies_is_all_of_the_scatter(plant, controller):
    varied = {**STILL, "outlet_3.area": "10 %", "opening_12.discharge": "0.000001 %"}
    found = cl.robustness(controller, plant, draws=50, uncertainty=varied)
    total = {name: index.value for name, index in found.sensitivity.total.items()}
    assert total["outlet_3.area"] == pytest.approx(1.0, abs=0.02)
    assert total["opening_12.discharge"] < 1e-3
    assert "outlet_3.area 100 %" in str(found)


def test_what_is_correlated_is_one_cause(plant, controller):
    pair = ["tank_1.area", "tank_2.area"]
    varied = {
        **STILL,
        **dict.fromkeys(pair, "10 %"),
        "correlated": [{"parameters": pair, "correlation": 0.9}],
    }
    found = cl.robustness(controller, plant, draws=20, uncertainty=varied)
    assert list(found.sensitivity.total) == ["tank_1.area, tank_2.area"]


def test_nothing_that_varies_has_no_cause(plant, controller):
    found = cl.robustness(controller, plant, draws=20, uncertainty=STILL)
    assert found.sensitivity is None
    steps = "iae_setpoint[level_3]"
    assert found.worst(steps).value == pytest.approx(found.nominal[steps], rel=1e-12)
    # The noise is another one in each draw.
    noise = "noise_movement[feed]"
    assert found.worst(noise).value > found.nominal[noise] > found.quantile(noise, 0.05).value


def test_a_draw_is_run_again_by_its_number(plant, controller):
    found = cl.robustness(controller, plant, draws=100, sensitivity=False)
    worst = found.worst("iae[level_3]")
    run = found.run(worst.draw)
    assert run.scores["iae[level_3]"] == pytest.approx(worst.value, rel=1e-12)
    assert run.process.signal("tank_1.area").initial == found.values(worst.draw)["tank_1.area"]
    assert f"draw {found.worst().draw}" in str(found)


def test_the_scenario_may_be_given(plant, controller):
    step = [cl.step("level_3", "+1 cm", at="10 s")]
    found = cl.robustness(controller, plant, step, duration="5 min", draws=20, sensitivity=False)
    assert found.loops.scenario.duration == 300.0
    assert "iae_load[level_3]" not in found.nominal
    again = cl.robustness(controller, plant, step, duration="5 min", draws=20, sensitivity=False)
    assert found.tally.as_dict() == again.tally.as_dict()


def test_plants_that_cannot_rest_are_said_with_their_reason():
    plant = cl.load("quadruple-tank")
    controller = cl.design.simc(plant)
    wide = {**STILL, "outlet_1.area": {"from": "0.3 cm^2", "to": "0.4 cm^2"}}
    found = cl.robustness(controller, plant, draws=20, uncertainty=wide)
    reason = "No plant has an admissible steady state, as pump_1 would leave its range (20)."
    assert reason in str(found)
    with refused(expected="20 draws with an admissible steady state", remedy="pump_1"):
        found.quantile("iae[level_1]")
    assert found.as_dict()["scores"] == {}
    with refused(place="draw", remedy="pump_1 would leave its range"):
        found.run(3)


def test_gains_of_sensors_move_the_levels_and_not_the_readings():
    plant = cl.load("quadruple-tank")
    varied = {**STILL, "level_1.gain": "10 %"}
    found = cl.robustness(
        cl.design.simc(plant), plant, draws=5, uncertainty=varied, sensitivity=False
    )
    for draw in (1, 2, 3):
        run = found.run(draw)
        assert run.values["level_1"][0] == pytest.approx(plant.point.as_dict()["level_1"])
        gain = found.values(draw)["level_1.gain"]
        np.testing.assert_allclose(run.values["tank_1.level"][0] * gain, run.values["level_1"][0])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"draws": 0}, {"value": 0, "expected": "at least 1"}),
        ({"draws": 2.5}, {"expected": "a whole number"}),
        ({"uncertainty": {"tank_9.area": "5 %"}}, {"remedy": "tank_"}),
        ({"uncertainty": {"tank_1.area": "5 cm"}}, {"expected": "a share of its value"}),
        ({"uncertainty": ["5 %"]}, {"remedy": "tank_1.area"}),
        ({"scores": ["wear[feed]"]}, {"value": "wear[feed]", "expected": "iae"}),
        ({"seed": -1}, {"value": -1}),
    ],
)
def test_what_cannot_be_asked_for_is_refused(plant, controller, given, words):
    with refused(**words):
        cl.robustness(controller, plant, **{"draws": 5, "sensitivity": False, **given})
