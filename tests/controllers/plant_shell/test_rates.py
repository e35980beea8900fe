"""Setpoint ramps and rate limits, in closed form, and with the law's own anti-windup."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scan_rig import ScannedLaw
from shell_rig import AT_REST, LEVEL, PUMP, one_loop, shelled_loop

from clepsydra import PidForm
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import read_status

RAMP = PlantShell(setpoint_rate={"level_1": 0.5})
RATE = PlantShell(rate_limit={"pump_1": 0.25})


def followed(loop):
    return loop.state["ramped_setpoint_1"]


def test_a_setpoint_moves_at_its_rate_and_arrives_in_every_bit():
    loop = shelled_loop(0.5, RAMP)
    loop.scan()
    target = 6.1000000000000005
    for k in range(1, 7):
        outputs = loop.scan(setpoint_1=target)
        assert followed(loop) == (5.0 + 0.25 * k if k < 5 else target)
        assert ("setpoint_ramps" in read_status(int(outputs["status_1"]))) == (k < 5)
    for k in range(1, 7):
        loop.scan(setpoint_1=5.0)
        assert followed(loop) == pytest.approx(max(5.0, target - 0.25 * k), abs=1e-14)


def test_the_law_gets_what_the_ramp_says():
    loop, bare = shelled_loop(1.0, RAMP), ScannedLaw(one_loop(), 1.0, **AT_REST)
    loop.scan(), bare.scan()
    for k in range(1, 12):
        found = loop.scan(setpoint_1=9.0)["manipulated_1"]
        assert found == bare.scan(setpoint_1=min(9.0, 5.0 + 0.5 * k))["manipulated_1"]


def test_the_ramp_begins_at_the_measurement_when_automatic_begins():
    loop = shelled_loop(1.0, RAMP)
    loop.scans(3, mode_1=0, measurement_1=7.0)
    assert followed(loop) == 7.0
    loop.scan(mode_1=1)
    assert followed(loop) == 6.5
    # A faulty measurement leaves the last good one.
    loop.scan(mode_1=0, measurement_1=math.nan)
    loop.scan()
    assert followed(loop) == 6.5 and loop.state["good_measurement_1"] == 7.0


def test_without_a_rate_manual_passes_the_setpoint_on():
    loop, bare = shelled_loop(1.0), ScannedLaw(one_loop(), 1.0, **AT_REST)
    random = np.random.default_rng(3)
    for _ in range(300):
        given = {
            "mode_1": float(random.integers(0, 3)), "setpoint_1": random.uniform(0, 9),
            "measurement_1": random.uniform(0, 9), "manual_1": random.uniform(-1, 12),
            "tracking_1": random.uniform(-1, 12),
        }  # fmt: skip
        found, expected = loop.scan(**given), bare.scan(**given)
        assert found["manipulated_1"] == expected["manipulated_1"]
        assert found["status_1"] == expected["status_1"]
        assert loop.state["integral_1"] == bare.state["integral_1"]


@pytest.mark.parametrize("settings", [PlantShell(), RAMP])
def test_a_setpoint_that_is_not_a_number_leaves_the_last_one(settings):
    loop = shelled_loop(1.0, settings)
    loop.scans(3, setpoint_1=6.0)
    before = followed(loop)
    outputs = loop.scan(setpoint_1=math.nan)
    assert followed(loop) == before == 6.0
    assert read_status(int(outputs["status_1"])) == ("automatic", "invalid_input")
    moved = outputs["manipulated_1"]
    assert loop.scan()["manipulated_1"] > moved  # it controls on


def test_a_first_setpoint_that_is_not_a_number_asks_for_what_is_there():
    loop = shelled_loop(1.0)
    loop.scan(setpoint_1=math.nan, measurement_1=6.25)
    assert followed(loop) == 6.25


def test_a_wrong_time_step_stops_the_ramp_only():
    loop = shelled_loop(1.0, RAMP)
    loop.scans(2)
    loop.scan(setpoint_1=8.0, time_step=math.nan)
    assert followed(loop) == 5.0
    loop.scan(time_step=1.0)
    assert followed(loop) == 5.5


def test_an_output_moves_at_its_rate_and_the_status_word_says_so():
    loop = shelled_loop(0.5, RATE)
    loop.scan()
    for k in range(1, 20):
        outputs = loop.scan(setpoint_1=9.0)
        assert outputs["manipulated_1"] == pytest.approx(3.0 + 0.125 * k, abs=1e-12)
        assert read_status(int(outputs["status_1"])) == ("automatic", "at_rate_limit")


def test_a_hand_is_slowed_too_and_limits_win():
    loop = shelled_loop(1.0, RATE)
    outputs = loop.scans(4, mode_1=0, manual_1=9.0)
    assert outputs["manipulated_1"] == 4.0
    loop.values["high_limit_1"] = 2.0
    outputs = loop.scan()
    assert outputs["manipulated_1"] == 2.0
    assert read_status(int(outputs["status_1"])) == ("at_high_limit",)


def test_at_the_real_limit_it_is_the_limit_that_is_told():
    loop = shelled_loop(1.0, RATE)
    outputs = loop.scans(100, setpoint_1=15.0)
    assert outputs["manipulated_1"] == 10.0
    assert read_status(int(outputs["status_1"])) == ("automatic", "at_high_limit")


class Tank:
    """y' = (u − u°)/50 − (y − y°)/100 about rest, sampled exactly."""

    def __init__(self):
        self.level, self.share = 5.0, math.exp(-1.0 / 100.0)

    def move(self, output):
        final = 5.0 + 2.0 * (output - 3.0)
        self.level = final + (self.level - final) * self.share


def overshoot(step):
    """Of a step of the setpoint from 5 to 8, and how far from it the level is in the end."""
    tank, levels = Tank(), []
    for _ in range(600):
        tank.move(step(tank.level))
        levels.append(tank.level)
    return (max(levels) - 8.0) / 3.0, max(abs(level - 8.0) for level in levels[-100:])


@pytest.mark.parametrize("anti_windup", ["back_calculation", "conditional_integration"])
def test_the_laws_own_anti_windup_heeds_the_rate_limit(anti_windup):
    """Beside it the same limiter behind the law, of which the law knows nothing."""
    values = {"proportional_gain_1": 5.0, "integral_time_1": 40.0, "tracking_time_1": 5.0}
    form = PidForm(anti_windup=anti_windup)
    slow = PlantShell(rate_limit={"pump_1": 0.02})
    shelled = shelled_loop(1.0, slow, form=form, **values)
    protected, left = overshoot(
        lambda level: shelled.scan(measurement_1=level, setpoint_1=8.0)["manipulated_1"]
    )
    bare, last = ScannedLaw(one_loop(form, **values), 1.0, **AT_REST), [3.0]

    def limited_outside(level):
        asked = bare.scan(measurement_1=level, setpoint_1=8.0)["manipulated_1"]
        last[0] = min(max(asked, last[0] - 0.02), last[0] + 0.02)
        return last[0]

    unprotected, swings = overshoot(limited_outside)
    assert unprotected > 0.3 and swings > 0.5
    assert protected < 0.1 and left < 1e-3


def test_a_law_with_a_rate_limit_of_its_own_keeps_it():
    shelled = with_plant_shell(one_loop(rate_limited=True, rate_limit_1=0.5), 1.0, RATE)
    assert shelled.values["rate_limit_1"] == 0.25
    assert [p.name for p in shelled.law.parameters].count("rate_limit_1") == 1
    loop = ScannedLaw(shelled, 1.0, **AT_REST)
    outputs = loop.scan(setpoint_1=9.0)
    assert outputs["manipulated_1"] == 3.25
    assert "at_rate_limit" in read_status(int(outputs["status_1"]))
    kept = with_plant_shell(one_loop(rate_limited=True, rate_limit_1=0.5), 1.0)
    assert kept.values["rate_limit_1"] == 0.5


def test_a_ramp_stands_while_a_fault_is_ridden_through():
    """On the sensor's return the output goes on as if the scans of the fault had not been."""
    loop, sound = shelled_loop(1.0, RAMP), shelled_loop(1.0, RAMP)
    for each in (loop, sound):
        each.scans(3, setpoint_1=10.0)
    before = followed(loop)
    assert before == 6.5
    for _ in range(4):
        outputs = loop.scan(sensor_1=0)
        assert followed(loop) == before
        word = read_status(int(outputs["status_1"]))
        assert "setpoint_ramps" in word and "rides_through" in word
    assert loop.scan(sensor_1=1) == sound.scan() | {"watchdog": 8.0}
    assert followed(loop) == 7.0


def test_after_fail_safe_the_ramp_begins_at_the_measurement():
    loop = shelled_loop(1.0, RAMP)
    loop.scans(3, setpoint_1=10.0)
    loop.scans(6, sensor_1=0)
    assert followed(loop) == 6.5  # nothing is known of the level
    loop.scan(sensor_1=1, measurement_1=4.0)
    assert followed(loop) == 4.0
    taken_up = loop.scan(acknowledge=1)
    assert followed(loop) == 4.0
    # Its first step only: K Δw = 2 · 0.5 V.
    assert loop.scan()["manipulated_1"] == pytest.approx(taken_up["manipulated_1"] + 1.0, abs=1e-12)
    assert followed(loop) == 4.5


def test_a_ramp_stands_for_every_output_that_follows_it():
    """Two outputs with a setpoint each: the fault of the one holds its own ramp only."""
    loop = ScannedLaw(with_plant_shell(two_loops(), 1.0, two_ramps()), 1.0, **both())
    loop.scan()
    loop.scans(3, setpoint_1=9.0, setpoint_2=9.0, sensor_1=0)
    assert (loop.state["ramped_setpoint_1"], loop.state["ramped_setpoint_2"]) == (5.0, 6.5)


def two_loops(setpoints=("level_1", "level_2"), free=None):
    bare = one_loop()
    level, pump = replace(LEVEL, name="level_2"), replace(PUMP, name="pump_2")
    law = multiloop_pid_law(2, measured=[LEVEL, level], manipulated=[PUMP, pump])
    values, state = (
        {p.name: given.get(p.name[:-1] + "1", p.initial) for p in group}
        for group, given in ((law.parameters, bare.values), (law.state, bare.initial_state))
    )
    return Controller(
        "PI, by hand", "multiloop PI", "By hand.", law, values, state, ("level_1", "level_2"),
        setpoints, ("pump_1", "pump_2"), free_inputs=free or {},
    )  # fmt: skip


def two_ramps():
    return PlantShell(setpoint_rate={"level_1": 0.5, "level_2": 0.5})


def both():
    return {name[:-1] + number: value for name, value in AT_REST.items() for number in "12"}


def test_a_setpoint_that_stands_fixed_is_left_alone():
    """The second setpoint is a free input: no ramp, no name of the shell, the law's own bits."""
    bare = two_loops(("level_1",), {"setpoint_2": 5.0})
    shelled = with_plant_shell(bare, 1.0, RAMP)
    assert "setpoint_rate_1" in shelled.values and "setpoint_rate_2" not in shelled.values
    loop, alone = ScannedLaw(shelled, 1.0, **both()), ScannedLaw(bare, 1.0, **both())
    for setpoint in (5.0, 9.0, math.nan, 2.0):
        found, expected = loop.scan(setpoint_2=setpoint), alone.scan(setpoint_2=setpoint)
        for name in ("manipulated_1", "manipulated_2", "status_1", "status_2"):
            assert found[name] == expected[name]
    assert expected["manipulated_2"] != 3.0
    assert "setpoint_ramps" in read_status(int(loop.scan(setpoint_1=9.0)["status_1"]))
    assert "setpoint_ramps" not in read_status(int(loop.scan(setpoint_2=9.0)["status_2"]))


LIMITED = [{}, {"rate_limited": True}]


@pytest.mark.parametrize("options", LIMITED)
def test_tracking_is_not_slowed_and_automatic_goes_on_from_it(options):
    """Somebody else moves the actuator: the rate limit is none of his."""
    loop = shelled_loop(1.0, RATE, **options)
    loop.scan()
    for value in (8.0, 1.0, 7.5):
        outputs = loop.scan(mode_1=2, tracking_1=value, measurement_1=4.0)
        assert outputs["manipulated_1"] == loop.state["last_output_1"] == value
        assert read_status(int(outputs["status_1"])) == ("tracking",)
    before = loop.scan(tracking_1=8.0)["manipulated_1"]
    assert loop.scan(mode_1=1)["manipulated_1"] == pytest.approx(before, abs=1e-12)
    # From there the controller moves it, at its rate.
    assert loop.scan(setpoint_1=1.0)["manipulated_1"] == pytest.approx(before - 0.25, abs=1e-12)
    loop.scan(mode_1=2, tracking_1=2.0)
    assert loop.scan(mode_1=0, manual_1=6.0)["manipulated_1"] == 2.25


@pytest.mark.parametrize("options", LIMITED)
def test_after_fail_safe_the_hand_moves_at_its_rate(options):
    settings = PlantShell(rate_limit={"pump_1": 0.25}, fail_safe={"pump_1": 9.0})
    loop = shelled_loop(1.0, settings, **options)
    assert loop.scans(6, sensor_1=0)["manipulated_1"] == 9.0
    assert loop.scan(mode_1=0, manual_1=3.0)["manipulated_1"] == 8.75
