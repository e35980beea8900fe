"""Alarms in runs: the same in every solver, counted, and what they hold stays held."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.loop.alarm_times import alarm_times
from clepsydra.loop.loop import Loop

ONE_TANK = (Path(__file__).parents[1] / "one-tank.toml").read_text(encoding="utf-8")
TANK = ONE_TANK.replace('nominal = "1.5 V"', 'nominal = "3 V"')
ALARMS = """
[alarms.level_1]
high_high = { limit = "18 cm", interlock = { pump_1 = "0 V" } }
high = { limit = "16 cm", on_delay = "3 s" }
deviation = { limit = "2 cm", on_delay = "10 s" }
rate = "10 cm/min"
flatline = "30 s"
"""
EVENTS = [cl.step("level_1", to="15 cm", at="20 s"), cl.step("level_1", to="19 cm", at="200 s")]


def simulated(folder, alarms):
    plant = plant_of(folder, TANK + alarms)
    return plant, cl.simulate(plant, cl.design.simc(plant), EVENTS, duration="500 s")


def told(run):
    return {
        s.name: run.values[s.name]
        for s in run.signals
        if s.name.endswith((".active", ".interlock"))
    }


def test_every_solver_has_the_same_alarms(tmp_path):
    plant, run = simulated(tmp_path, ALARMS)
    loop = Loop(run.controller, plant.linear)
    found = told(run)
    assert any(np.any(column) for column in found.values())
    for other in (
        loop.run(run.scenario, solver="reference"),
        loop.run(run.scenario, precision="single"),
    ):
        for name, column in told(other).items():
            assert np.array_equal(column, found[name]), name


def test_alarms_that_hold_nothing_change_no_bit_of_a_run(tmp_path):
    _, bare = simulated(tmp_path, "")
    _, run = simulated(tmp_path, ALARMS.replace(', interlock = { pump_1 = "0 V" }', ""))
    for name, column in bare.values.items():
        assert np.array_equal(column, run.values[name]), name


def test_an_interlock_holds_the_pump_while_its_alarm_is_there(tmp_path):
    _, run = simulated(tmp_path, ALARMS)
    held = run.values["pump_1.interlock"] > 0
    assert np.any(held) and not np.all(held)
    assert np.all(run.values["pump_1"][held] == 0.0)
    assert np.all(run.values["level_1"][~held & np.roll(held, 1)] < 0.18)
    # As its mode does, it says so in the status word: 2 is tracking.
    status = run.values["pump_1.status"].astype(int)
    assert np.array_equal((status & 2) > 0, held)
    assert np.all(status[~held] & 1)
    _, free = simulated(tmp_path, ALARMS.replace(', interlock = { pump_1 = "0 V" }', ""))
    assert free.values["level_1"].max() > run.values["level_1"].max()


def test_it_goes_on_without_a_bump(tmp_path):
    """In the sample after the interlock the law moves on from the interlock value."""
    _, run = simulated(tmp_path, ALARMS)
    held = run.values["pump_1.interlock"] > 0
    after = np.flatnonzero(~held & np.roll(held, 1))
    jumps = run.values["pump_1"][after]
    # What K makes of one sample of the error that is left, and no integral that has wound up.
    assert np.all(jumps < 0.1 * np.ptp(run.values["pump_1"]))


def test_a_law_in_python_meets_the_same_alarms(tmp_path):
    plant = plant_of(tmp_path, TANK + ALARMS)
    (tmp_path / "own.py").write_text(
        "inputs = ['level_1.pv', 'level_1.sp']\noutputs = ['pump_1.out']\n"
        "def step(state, inputs, parameters, time_step):\n"
        "    error = inputs['level_1.sp'] - inputs['level_1.pv']\n"
        "    return {}, {'pump_1.out': 3.0 + 200.0 * error}\n",
        encoding="utf-8",
    )
    own = cl.design.own(
        plant, cl.load_law(tmp_path / "own.py"), measurements=["level_1"], setpoints=["level_1"],
        manipulated=["pump_1"],
    )  # fmt: skip
    found = cl.simulate(plant, own, EVENTS, duration="500 s")
    held = found.values["pump_1.interlock"] > 0.0
    assert np.any(held) and np.all(found.values["pump_1"][held] == 0.0)
    assert np.any(found.values["level_1.high.active"])


def test_times_are_those_of_the_trajectories(tmp_path):
    _, run = simulated(tmp_path, ALARMS)
    for each in alarm_times(run):
        active = run.values[f"{each.alarm.name}.active"]
        assert each.duration == active.sum() * run.scenario.sampling_period
        assert each.count == np.sum((active > 0) & (np.concatenate([[0.0], active[:-1]]) == 0))
        assert each.stands == bool(active[-1])
        assert all(active[int(time)] > 0 for time in each.came)
        assert all(active[int(time)] == 0 for time in each.returned)


@pytest.fixture
def filling(tmp_path):
    """A tank without a controller, which its pump fills beyond the limits."""
    step = [cl.step("pump_1", to="5 V", at="20 s")]

    def run(alarms, solver="kernel"):
        plant = plant_of(tmp_path, TANK + alarms)
        return cl.simulate(plant, None, step, duration="500 s", solver=solver)

    return run


def test_a_process_without_a_controller_has_its_alarms(filling):
    run = filling(ALARMS)
    counts = {each.alarm.kind.key: each.count for each in run.alarms}
    assert counts["high_high"] > 1
    assert counts["high"] == 1
    # Nothing has a setpoint.
    assert counts["deviation"] == 0
    for each in run.alarms:
        active = run.values[f"{each.alarm.name}.active"]
        assert each.duration == active[:-1].sum()
    held = run.values["pump_1.interlock"] > 0
    assert np.array_equal(held, run.values["level_1.high_high.active"] > 0)
    assert np.all(run.values["pump_1"][held] == 0.0)
    assert np.all(run.values["pump_1"][~held][20:] == 5.0)
    assert run.balances[0].error < 1e-12
    assert "Alarms: level_1 HH" in repr(run)
    assert [each["count"] for each in run.as_dict()["alarms"]] == [*counts.values()]


def test_they_are_the_same_by_the_reference_solver(filling):
    run, other = filling(ALARMS), filling(ALARMS, "reference")
    assert [each.came for each in other.alarms] == [each.came for each in run.alarms]
    for name in (*told(run), "pump_1"):
        assert np.array_equal(other.values[name], run.values[name]), name


def test_without_a_controller_too_they_change_no_bit_where_they_hold_nothing(filling):
    bare, run = filling(""), filling(ALARMS.replace(', interlock = { pump_1 = "0 V" }', ""))
    for name, column in bare.values.items():
        assert np.array_equal(column, run.values[name]), name


def test_a_chattering_level_gives_one_alarm(tmp_path):
    """Noise of 1 mm around the limit makes an alarm every few seconds, and one with a deadband."""
    counts = {}
    for deadband in ("0 cm", "1 cm"):
        high = f'high = {{ limit = "16 cm", deadband = "{deadband}" }}'
        plant = plant_of(tmp_path, f"{TANK}[alarms.level_1]\n{high}\n")
        step = [cl.step("level_1", to="16 cm", at="10 s")]
        loop = Loop(cl.design.lambda_(plant), plant.linear)
        quiet = cl.simulate(plant, loop.controller, step, duration="1500 s").scenario
        noise = 0.001 * np.random.default_rng(1).standard_normal((quiet.samples, 1))
        (found,) = alarm_times(loop.run(replace(quiet, noise=noise)))
        counts[deadband] = found.count
    assert counts["1 cm"] == 1
    assert counts["0 cm"] > 100


def test_a_study_tells_of_the_alarms(tmp_path):
    plant = plant_of(tmp_path, TANK + ALARMS)
    found = cl.study(
        plant, [cl.design.simc(plant), cl.design.lambda_(plant)], EVENTS, duration="500 s"
    )
    (simc,) = (each for each in found.ranking if each.controller.name == "PI, SIMC")
    assert any("High-high alarm of level_1 at 18 cm comes" in words for words in simc.warnings)
    assert "Alarms: level_1 H" in repr(found)
    assert "controller" in str(found.answer(every=True)) and "level_1 HH" in str(
        found.answer(every=True)
    )
    first = found.as_dict()["ranking"][0]["alarms"]
    assert {each["alarm"] for each in first} == {alarm.kind.key for alarm in plant.process.alarms}
    found.report(tmp_path / "study.html")
    text = (tmp_path / "study.html").read_text(encoding="utf-8")
    assert "Its alarms" in text and "high-high alarm of level_1 at 18 cm" in text
