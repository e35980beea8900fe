"""`cl.batch`: the scores of each draw, as data with units."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl

STEP = [cl.step("level_1", "+1 V", at="10 s")]


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def controller(plant):
    return cl.design.simc(plant)


@pytest.fixture(scope="module")
def found(plant, controller):
    return cl.batch(plant, controller, draws=50)


def test_a_dataset_has_units_events_and_what_varies(found, plant):
    data = found.to_xarray()
    assert data.sizes == {"draw": 50, "event": 9}
    assert data["iae[level_1]"].attrs["units"] == "V s"
    assert data["tank_1.area"].attrs["units"] == "m^2"
    assert data.event.values[0] == "whole run"
    assert "setpoint level_1 at 60 s" in data.event.values
    iae = data["iae[level_1]"]
    np.testing.assert_allclose(iae.isel(event=slice(1, None)).sum("event"), iae[0], rtol=1e-12)
    assert (data["iae[level_1]"].sel(event="load inflow_1 at 41 min")[0] > 0).all()


def test_a_row_of_the_table_is_a_draw(found):
    table = found.to_pandas()
    run = found.run(7)
    assert table.loc[7, "iae[level_2]"] == pytest.approx(run.scores["iae[level_2]"], rel=1e-12)
    assert table.loc[7, "tank_1.area"] == run.process.signal("tank_1.area").initial


def test_plants_settings_and_starts_are_given(plant, controller):
    given = {
        "tank_1.area": ["28 cm^2", "30 cm^2"],
        "level_1.proportional_gain": [3.0, 2.0],
        "tank_1.level": np.array([12.263, 10.0]),  # [cm]
    }
    found = cl.batch(plant, controller, STEP, duration="10 min", draws=given)
    run = found.run(2)
    assert run.values["tank_1.level"][0] == pytest.approx(0.10)
    own = controller.with_values({"level_1": {"K": 2.0}})
    wider = plant.with_values({"tank_1.area": "30 cm^2"})
    alone = cl.simulate(
        wider, own, STEP, duration="10 min", state={"tank_1.level": "10 cm"},
    )  # fmt: skip
    # The plant alone is simulated with steps four times as short.
    for score in ("iae[level_1]", "iae[level_2]"):
        assert found.to_pandas().loc[2, score] == pytest.approx(alone.scores[score], rel=1e-4)
        assert run.scores[score] == pytest.approx(found.to_pandas().loc[2, score], rel=1e-12)


def test_a_disturbance_is_given(plant, controller):
    found = cl.batch(plant, controller, STEP, draws={"inflow_1": ["0 cm^3/s", "1 cm^3/s"]})
    run = found.run(2)
    assert run.values["inflow_1"][0] == pytest.approx(1e-6)
    assert run.values["pump_1"][0] < found.run(1).values["pump_1"][0]


def test_draws_follow_from_their_numbers(found, plant, controller):
    more = cl.batch(plant, controller, draws=60)
    for name, rows in found.drawn.scores.items():
        np.testing.assert_array_equal(more.drawn.scores[name][:, :50], rows)
    other = cl.batch(plant, controller, draws=50, seed=2)
    assert (other.drawn.scores["iae[level_1]"] != found.drawn.scores["iae[level_1]"]).any()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"draws": 0}, {"value": 0}),
        ({"draws": {}}, {"expected": "a value for each plant"}),
        ({"draws": {"tank_1.area": []}}, {"expected": "a value for each plant"}),
        (
            {"draws": {"tank_1.area": ["28 cm^2"], "tank_2.area": ["28 cm^2", "30 cm^2"]}},
            {"expected": "as many of every name"},
        ),
        ({"draws": {"tank_9.area": [1.0]}}, {"value": "tank_9.area"}),
        ({"draws": {"tank_1.area": ["28 V"]}}, {"place": "tank_1.area"}),
        ({"draws": {"tank_1.area": [0.003, -1.0]}}, {"expected": "0", "remedy": "range"}),
        ({"draws": {"tank_1.area": [float("nan")]}}, {"value": "nan cm^2 in draw 1"}),
        ({"draws": {"tank_1.area": [[0.003]]}}, {"expected": "a value for each plant"}),
        ({"draws": {"tank_1.area": [True]}}, {"expected": "numbers in cm^2"}),
        ({"draws": 5, "scores": ["iae[level_9]"]}, {"value": "iae[level_9]"}),
        (
            {"draws": {"tank_1.area": [0.003]}, "uncertainty": {"default": "5 %"}},
            {"remedy": "leave it out"},
        ),
    ],
)
def test_what_cannot_be_asked_for_is_refused(plant, controller, given, words):
    with refused(**words):
        cl.batch(plant, controller, **given)
