"""Nonlinear model predictive control: the physical limit, an unknown load, and its own faults."""

import math
import pickle
import signal
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.optimal_control.interruptible import Interruption
from clepsydra.optimal_control.receding_horizon import RecedingHorizon
from clepsydra.optimal_control.search import NoCourse

ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"
STEP = [cl.step("level_1", "+4 cm", at="5 s")]


@pytest.fixture(scope="module")
def tank():
    return cl.load(ONE_TANK)


@pytest.fixture(scope="module")
def controller(tank):
    return cl.design.nonlinear_mpc(tank)


def test_a_tank_is_filled_nearly_as_fast_as_it_can_be(tank, controller):
    """The full inflow, and then what holds the level, without overshoot."""
    run = cl.simulate(tank, controller, STEP, duration="60 s")
    assert cl.limit(tank, STEP, duration="60 s").times(run) < 1.1
    assert run.values["pump_1"][6] == pytest.approx(10.0, abs=1e-4)  # [V]
    assert run.scores["overshoot[level_1]"] < 1.0  # [%]
    assert run.final_state["controller.unsolved"] == 0


def test_a_load_that_it_is_not_told_of_leaves_no_error(tmp_path, controller):
    """The pump gives nine tenths of what the controller's equations say."""
    path = tmp_path / "weak.toml"
    path.write_text(ONE_TANK.read_text("utf-8").replace("3.33 cm", "3.0 cm"), "utf-8")
    weak = cl.load(path)
    run = cl.simulate(weak, controller, STEP, duration="2 min")
    level, setpoint = (run.values[name][-1] for name in ("level_1", "level_1.setpoint"))
    assert level == pytest.approx(setpoint, abs=5e-5)  # [m]
    # What the pump lacks, as a voltage, is the load that was found.
    lacks = run.values["pump_1"][-1] * (3.0 / 3.33 - 1.0)
    assert run.final_state["controller.pump_1.load"] == pytest.approx(lacks, rel=0.02)


@pytest.mark.thorough
def test_a_level_stays_below_its_rim(tmp_path):
    """The setpoint of a level stands above the rim of the tank before it."""
    text = ONE_TANK.read_text("utf-8")
    path = tmp_path / "two.toml"
    lower = '[tanks.tank_2]\narea = "28 cm^2"\nheight = "40 cm"\n\n'
    lower += '[orifices.outlet_2]\nsource = "tank_2"\ndestination = "basin"\narea = "0.06 cm^2"\n\n'
    text = text.replace('destination = "basin"\narea', 'destination = "tank_2"\narea')
    text = text.replace("[orifices.outlet_1]", f"{lower}[orifices.outlet_1]")
    path.write_text(
        text.replace(
            '[sensors.level_1]\ntank = "tank_1"', '[sensors.level_1]\ntank = "tank_2"'
        ).replace('range = ["0 cm", "20 cm"]', 'range = ["0 cm", "40 cm"]'),
        "utf-8",
    )
    plant = cl.load(path)
    step = [cl.step("level_1", "+16 cm", at="5 s")]
    run = cl.simulate(plant, cl.design.nonlinear_mpc(plant), step, duration="4 min")
    levels = run.values["tank_1.level"]
    assert 0.19 < levels.max() < 0.2005
    assert run.values["level_1"][-1] == pytest.approx(run.values["level_1.setpoint"][-1], abs=2e-3)


def test_without_a_plan_the_last_one_goes_on(tank, controller, monkeypatch):
    whole, solve = cl.simulate(tank, controller, STEP, duration="20 s"), RecedingHorizon.solve

    def seldom(self, now, plan):
        if 0.2 < now.contents[0] < 0.28:
            raise NoCourse(False)
        return solve(self, now, plan)

    monkeypatch.setattr(RecedingHorizon, "solve", seldom)
    copied = pickle.loads(pickle.dumps(controller))
    (found,) = cl.study(tank, controllers=[copied], events=STEP, duration="20 s").ranking
    run = found.run
    unsolved = round(run.final_state["controller.unsolved"])
    assert unsolved > 0
    (told,) = (str(each) for each in found.warnings if "came to no end" in str(each))
    assert told.lower().startswith(f"in {unsolved} of 20 samples")
    # The plan was made on the same equations, so that little is lost.
    np.testing.assert_allclose(run.values["level_1"], whole.values["level_1"], atol=2e-3)


def test_the_same_run_has_the_same_bits(tank, controller):
    one, two = (cl.simulate(tank, controller, STEP, duration="15 s") for _ in range(2))
    for name, values in one.values.items():
        np.testing.assert_array_equal(two.values[name], values, err_msg=name)


def test_the_linear_model_is_of_estimates_alone(tank, controller):
    """Contents, load and last output: where a search begins is no mode of a loop."""
    assert sorted(controller.law.aside) == sorted(
        name
        for name in controller.initial_state
        if name not in ("tank_1.level.estimate", "pump_1.load", "pump_1.last_output")
    )


def test_control_c_ends_a_run(tank, controller, monkeypatch):
    before, asked = signal.signal(signal.SIGINT, signal.default_int_handler), []

    def sent(self, results):
        asked.append(1)
        if len(asked) == 30:
            signal.raise_signal(signal.SIGINT)
        return [int(self._arrived is not None)]

    monkeypatch.setattr(Interruption, "eval", sent)
    try:
        with pytest.raises(KeyboardInterrupt):
            cl.simulate(tank, controller, STEP, duration="60 s")
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(asked) == 30


@pytest.mark.parametrize(
    ("given", "place", "expected"),
    [
        ({"horizon": "1 s"}, "horizon", "at least"),
        ({"horizon": -5.0}, "horizon", "a time above 0 s"),
        ({"horizon": math.nan}, "horizon", "a time above 0 s"),
        ({"move_weight": 0.0}, "move_weight", "a weight above 0"),
        ({"move_weight": -1.0}, "move_weight", "a weight above 0"),
        ({"maximum_errors": {"level_1": 0.0}}, "maximum_errors, level_1", "above 0"),
        ({"maximum_errors": {"level": 1.0}}, "maximum_errors, level", "a controlled measurement"),
        ({"maximum_moves": {"pump": 1.0}}, "maximum_moves, pump", "an input of one-tank"),
    ],
)
def test_what_it_cannot_be_given(tank, given, place, expected):
    with refused(place=place, expected=expected):
        cl.design.nonlinear_mpc(tank, **given)


@pytest.mark.parametrize(
    ("plant", "reason"),
    [
        ("wet-well", "a switch decides"),
        ("equalisation-tank", "meant to move, not to follow a setpoint"),
        (Path(__file__).parents[1] / "dead-time.toml", "dead time"),
    ],
)
def test_where_it_does_not_apply(plant, reason):
    with pytest.raises(cl.NotApplicable, match=reason):
        cl.design.nonlinear_mpc(plant)


def test_it_is_not_exported(tank, controller, tmp_path):
    with refused(value="nonlinear_mpc, a law in Python", remedy="take another controller"):
        cl.export(controller, tank, tmp_path)
    with refused(place="Nonlinear MPC", expected="which a page can run"):
        cl.lab(tank, [controller], tmp_path / "lab.html")
    assert not [*tmp_path.iterdir()]


def test_a_study_has_it_where_it_is_asked_for(tank, tmp_path):
    from_file = tmp_path / "study.toml"
    from_file.write_text(
        f'process = "{ONE_TANK}"\n[scenario]\nduration = "15 s"\n'
        '[[scenario.setpoint]]\nsignal = "level_1"\nat = "5 s"\nby = "2 cm"\n'
        '[controllers."Nonlinear MPC"]\ndesign = "nonlinear_mpc"\n'
        'horizon = "4 min"\nmove_weight = 2.0\n',
        "utf-8",
    )
    (found,) = cl.study(from_file).ranking
    assert found.controller.name == "Nonlinear MPC"
    assert "over 4 min" in found.controller.design
    assert 1.0 < found.maximum_sensitivity < 2.0


@pytest.mark.thorough
def test_it_comes_near_the_limit_of_a_plant_of_nonminimum_phase():
    plant = cl.load("quadruple-tank-nonminimum-phase")
    events = [cl.step("level_1", "+0.9 V"), cl.step("level_2", "+1 V")]
    controller = cl.design.nonlinear_mpc(plant)
    run = cl.simulate(plant, controller, events)
    assert 1.0 < cl.limit(plant, events).times(run) < 1.15
    assert run.final_state["controller.unsolved"] == 0
    assert sampled_loop(controller, plant.linear).maximum_sensitivity < 2.0
