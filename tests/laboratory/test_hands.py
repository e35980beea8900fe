"""What hands can do to a process, and the other numbers that it can have."""

import math

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.laboratory.hands import hands_on, with_hands
from clepsydra.laboratory.page_data import FORM
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import session_of
from clepsydra.laboratory.setups import setups


def test_pouring_once_adds_a_quarter_of_what_the_simulator_counts_as_full():
    # The course's button adds 25 % of 25 cm: 6.25 cm of 15.5179 cm².
    rig = hands_on(with_hands(cl.load("laboratory-four-tanks").linear).point)
    for tank in rig:
        poured = tank.full * tank.samples * 0.05
        assert poured == pytest.approx(6.25e-2 * 15.5179e-4, rel=1e-12)


@pytest.mark.parametrize("name", ["three-tanks", "eight-tanks", "wet-well", "averaging-tank"])
def test_with_hands_a_process_is_the_same_until_they_move(name):
    plant = cl.load(name)
    model = with_hands(plant.linear)
    assert np.array_equal(model.A, plant.linear.A)
    assert np.array_equal(model.B, plant.linear.B)
    assert model.point.residual == plant.point.residual
    for tank in hands_on(model.point):
        assert model.point.as_dict()[tank.pour] == 0.0
        assert math.isfinite(tank.area)
        assert tank.area > 0.0


def test_an_open_hole_doubles_what_leaves_a_tank():
    model = with_hands(cl.load("quadruple-tank").linear)
    process, point = model.point.process, model.point
    tank = next(each for each in hands_on(point) if each.tank == "tank_1")
    values = process.parameter_values
    names = [parameter.name for parameter in process.parameters]
    values[names.index(tank.extra_outlet)] = tank.area
    rates = process.dynamics(point.state, point.inputs, point.disturbances, values)
    level = point.as_dict()["tank_1.level"]
    leaves = 0.071e-4 * math.sqrt(2 * 9.81 * level) / 28e-4
    assert float(rates[0]) == pytest.approx(-leaves, rel=1e-9)


def test_the_set_ups_of_a_rig_differ_in_parameters_alone():
    found = setups(cl.load("laboratory-four-tanks").process)
    assert [each.name.split(":")[0] for each in found][0::2] == [
        "laboratory-four-tanks", "laboratory-four-tanks-nonminimum-phase",
    ]  # fmt: skip
    assert all(each.parameters.keys() == found[0].parameters.keys() for each in found)
    assert found[-1].parameters["splitter_1.tank_1"] == 0.375
    assert [each.title for each in setups(cl.load("wet-well").process)] == [
        cl.load("wet-well").process.title
    ]


def replay(rig, samples, *touches):
    """Run what hands do to a rig, each a sample and what is set there."""
    session = {
        "form": FORM, "version": cl.__version__, "digest": rig.digest, "process": "",
        "controllers": [each.name for each in rig.controllers], "start": "rest",
        "samples": samples, "seed": 1,
        "touches": [{"sample": sample, **hand} for sample, hand in touches],
    }  # fmt: skip
    return replayed(rig, session_of(session, "session"), "session")


def by_hand(name, value):
    return [
        (0, {"input": f"{name}.mode", "value": 0}), (0, {"input": f"{name}.manual", "value": value})
    ]  # fmt: skip


def test_what_comes_over_the_rim_is_spilt_and_no_level_stands_above_it():
    """All that is poured into a plugged tank is in it, or was spilt."""
    plant = cl.load("quadruple-tank")
    rig = Rig(plant.linear, [cl.design.simc(plant)])
    poured = 40e-6
    run = replay(
        rig, 200, *by_hand("pump_1", 0.0), *by_hand("pump_2", 0.0),
        (0, {"parameters": {"outlet_3.area": 0.0}}),
        (5, {"input": "pour_into_tank_3", "value": poured}),
    )  # fmt: skip
    level, spilt = run.values["tank_3.level"], run.values["tank_3.spilt"]
    rim = plant.process.signal("tank_3.level").high
    assert level.max() == rim
    assert np.all(level[spilt > 0] == rim)
    # Up to the start of the last sample.
    entered = poured * (199 - 5)
    assert spilt[-1] == pytest.approx(entered - 28e-4 * (rim - level[0]), rel=1e-9)
    assert run.levels["tank_3.level"] == rim
    for other in ("tank_1", "tank_2", "tank_4"):
        assert not run.values[f"{other}.spilt"].any()


def test_what_is_left_in_a_tank_that_spills_is_as_concentrated_as_before():
    """A full tank of V washes out as exp(−q t/V); between two samples V is a little larger."""
    plant = cl.load("averaging-tank")
    rig = Rig(plant.linear, [cl.design.lqi(plant)])
    flow, salty, full, period = 1.0, 1e4, 4.0, 0.1  # [m³/s, mol/m³, m³, s]
    run = replay(
        rig, 200, *by_hand("inflow", flow), *by_hand("inflow.impurity", salty)
    )  # fmt: skip
    level, salt = run.values["tank.level"], run.values["tank.impurity"]
    first = int(np.argmax(level == full))
    assert 0 < first < 100 and np.all(level[first:] == full)
    most = full + (flow - 0.2) * period
    washed = period * np.arange(200 - first) * flow
    fast, slow = (salty - (salty - salt[first]) * np.exp(-washed / v) for v in (full, most))
    assert np.all(salt[first:] <= fast + 1e-6) and np.all(salt[first:] >= slow - 1e-6)
    assert salt[-1] - salt[first] > 1e3
