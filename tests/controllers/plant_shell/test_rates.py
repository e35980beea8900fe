"""Setpoint ramps and rate limits, in closed form, and with the law's own anti-windup."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scan_rig import ScannedLaw
from shell_rig import AT_REST, LEVEL, PUMP, one_loop, read_status, shelled_loop

from clepsydra import PidForm
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell

RAMP = PlantShell(setpoint_rate={"level_1": 0.5})
RATE = PlantShell(rate_limit={"pump_1": 0.25})


def followed(loop):
    return loop.state["level_1.ramped_setpoint"]


def test_a_setpoint_moves_at_its_rate_and_arrives_in_every_bit():
    loop = shelled_loop(0.5, RAMP)
    loop.scan()
    target = 6.1000000000000005
    for k in range(1, 7):
        outputs = loop.scan(level_1_sp=target)
        assert followed(loop) == (5.0 + 0.25 * k if k < 5 else target)
        assert ("setpoint_ramps" in read_status(int(outputs["pump_1.status"]))) == (k < 5)
    for k in range(1, 7):
        loop.scan(level_1_sp=5.0)
        assert followed(loop) == pytest.approx(max(5.0, target - 0.25 * k), abs=1e-14)


def test_the_law_gets_what_the_ramp_says():
    loop, bare = shelled_loop(1.0, RAMP), ScannedLaw(one_loop(), 1.0, **AT_REST)
    loop.scan(), bare.scan()
    for k in range(1, 12):
        found = loop.scan(level_1_sp=9.0)["pump_1.out"]
        assert found == bare.scan(level_1_sp=min(9.0, 5.0 + 0.5 * k))["pump_1.out"]


def test_the_ramp_begins_at_the_measurement_when_automatic_begins():
    loop = shelled_loop(1.0, RAMP)
    loop.scans(3, pump_1_mode=0, level_1_pv=7.0)
    assert followed(loop) == 7.0
    loop.scan(pump_1_mode=1)
    assert followed(loop) == 6.5
    # A faulty measurement leaves the last good one.
    loop.scan(pump_1_mode=0, level_1_pv=math.nan)
    loop.scan()
    assert followed(loop) == 6.5 and loop.state["level_1.good_measurement"] == 7.0


def test_without_a_rate_manual_passes_the_setpoint_on():
    loop, bare = shelled_loop(1.0), ScannedLaw(one_loop(), 1.0, **AT_REST)
    random = np.random.default_rng(3)
    for _ in range(300):
        given = {
            "pump_1.mode": float(random.integers(0, 3)), "level_1.sp": random.uniform(0, 9),
            "level_1.pv": random.uniform(0, 9), "pump_1.manual": random.uniform(-1, 12),
            "pump_1.tracking": random.uniform(-1, 12),
        }  # fmt: skip
        found, expected = loop.scan(**given), bare.scan(**given)
        assert found["pump_1.out"] == expected["pump_1.out"]
        assert found["pump_1.status"] == expected["pump_1.status"]
        assert loop.state["level_1.integral"] == bare.state["level_1.integral"]


@pytest.mark.parametrize("settings", [PlantShell(), RAMP])
def test_a_setpoint_that_is_not_a_number_leaves_the_last_one(settings):
    loop = shelled_loop(1.0, settings)
    loop.scans(3, level_1_sp=6.0)
    before = followed(loop)
    outputs = loop.scan(level_1_sp=math.nan)
    assert followed(loop) == before == 6.0
    assert read_status(int(outputs["pump_1.status"])) == ("automatic", "invalid_input")
    moved = outputs["pump_1.out"]
    assert loop.scan()["pump_1.out"] > moved  # it controls on


def test_a_first_setpoint_that_is_not_a_number_asks_for_what_is_there():
    loop = shelled_loop(1.0)
    loop.scan(level_1_sp=math.nan, level_1_pv=6.25)
    assert followed(loop) == 6.25


@pytest.mark.parametrize("wrong", [math.nan, 0.0, -1.0])
def test_without_a_time_step_the_ramp_goes_on_by_a_sampling_period(wrong):
    loop = shelled_loop(1.0, RAMP)
    loop.scans(2)
    loop.scan(level_1_sp=8.0, time_step=wrong)
    assert followed(loop) == 5.5
    loop.scan(time_step=1.0)
    assert followed(loop) == 6.0


def test_an_output_moves_at_its_rate_and_the_status_word_says_so():
    loop = shelled_loop(0.5, RATE)
    loop.scan()
    for k in range(1, 20):
        outputs = loop.scan(level_1_sp=9.0)
        assert outputs["pump_1.out"] == pytest.approx(3.0 + 0.125 * k, abs=1e-12)
        assert read_status(int(outputs["pump_1.status"])) == ("automatic", "at_rate_limit")


def test_a_hand_is_slowed_too_and_limits_win():
    loop = shelled_loop(1.0, RATE)
    outputs = loop.scans(4, pump_1_mode=0, pump_1_manual=9.0)
    assert outputs["pump_1.out"] == 4.0
    loop.values["pump_1.high_limit"] = 2.0
    outputs = loop.scan()
    assert outputs["pump_1.out"] == 2.0
    assert read_status(int(outputs["pump_1.status"])) == ("at_high_limit",)


def test_at_the_real_limit_it_is_the_limit_that_is_told():
    loop = shelled_loop(1.0, RATE)
    outputs = loop.scans(100, level_1_sp=15.0)
    assert outputs["pump_1.out"] == 10.0
    assert read_status(int(outputs["pump_1.status"])) == ("automatic", "at_high_limit")


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
    values = {
        "level_1.proportional_gain": 5.0,
        "level_1.integral_time": 40.0,
        "level_1.tracking_time": 5.0,
    }
    form = PidForm(anti_windup=anti_windup)
    slow = PlantShell(rate_limit={"pump_1": 0.02})
    shelled = shelled_loop(1.0, slow, form=form, **values)
    protected, left = overshoot(
        lambda level: shelled.scan(level_1_pv=level, level_1_sp=8.0)["pump_1.out"]
    )
    bare, last = ScannedLaw(one_loop(form, **values), 1.0, **AT_REST), [3.0]

    def limited_outside(level):
        asked = bare.scan(level_1_pv=level, level_1_sp=8.0)["pump_1.out"]
        last[0] = min(max(asked, last[0] - 0.02), last[0] + 0.02)
        return last[0]

    unprotected, swings = overshoot(limited_outside)
    assert unprotected > 0.3 and swings > 0.5
    assert protected < 0.1 and left < 1e-3


def test_a_law_with_a_rate_limit_of_its_own_keeps_it():
    shelled = with_plant_shell(one_loop(rate_limited=True, pump_1_rate_limit=0.5), 1.0, RATE)
    assert shelled.values["pump_1.rate_limit"] == 0.25
    assert [p.name for p in shelled.law.parameters].count("pump_1.rate_limit") == 1
    loop = ScannedLaw(shelled, 1.0, **AT_REST)
    outputs = loop.scan(level_1_sp=9.0)
    assert outputs["pump_1.out"] == 3.25
    assert "at_rate_limit" in read_status(int(outputs["pump_1.status"]))
    kept = with_plant_shell(one_loop(rate_limited=True, pump_1_rate_limit=0.5), 1.0)
    assert kept.values["pump_1.rate_limit"] == 0.5


def test_a_ramp_stands_while_a_fault_is_ridden_through():
    """On the sensor's return the output goes on as if the scans of the fault had not been."""
    loop, sound = shelled_loop(1.0, RAMP), shelled_loop(1.0, RAMP)
    for each in (loop, sound):
        each.scans(3, level_1_sp=10.0)
    before = followed(loop)
    assert before == 6.5
    for _ in range(4):
        outputs = loop.scan(level_1_good=0)
        assert followed(loop) == before
        word = read_status(int(outputs["pump_1.status"]))
        assert "setpoint_ramps" in word and "rides_through" in word
    assert loop.scan(level_1_good=1) == sound.scan() | {"watchdog": 8.0}
    assert followed(loop) == 7.0


def test_after_fail_safe_the_ramp_begins_at_the_measurement():
    loop = shelled_loop(1.0, RAMP)
    loop.scans(3, level_1_sp=10.0)
    loop.scans(6, level_1_good=0)
    assert followed(loop) == 6.5  # nothing is known of the level
    loop.scan(level_1_good=1, level_1_pv=4.0)
    assert followed(loop) == 4.0
    taken_up = loop.scan(acknowledge=1)
    assert followed(loop) == 4.0
    # Its first step only: K Δw = 2 · 0.5 V.
    assert loop.scan()["pump_1.out"] == pytest.approx(taken_up["pump_1.out"] + 1.0, abs=1e-12)
    assert followed(loop) == 4.5


def test_a_ramp_stands_for_every_output_that_follows_it():
    """Two outputs with a setpoint each: the fault of the one holds its own ramp only."""
    loop = ScannedLaw(with_plant_shell(two_loops(), 1.0, two_ramps()), 1.0, **both())
    loop.scan()
    loop.scans(3, level_1_sp=9.0, level_2_sp=9.0, level_1_good=0)
    followed = [loop.state[f"{level}.ramped_setpoint"] for level in ("level_1", "level_2")]
    assert followed == [5.0, 6.5]


def two_loops(setpoints=("level_1", "level_2"), free=None):
    bare = one_loop()
    level, pump = replace(LEVEL, name="level_2"), replace(PUMP, name="pump_2")
    law = multiloop_pid_law([LEVEL, level], [PUMP, pump])
    values, state = (
        {p.name: given.get(p.name.replace("_2.", "_1."), p.initial) for p in group}
        for group, given in ((law.parameters, bare.values), (law.state, bare.initial_state))
    )
    return Controller(
        "PI, by hand", "multiloop PI", "By hand.", law, values, state, ("level_1", "level_2"),
        setpoints, ("pump_1", "pump_2"), free_inputs=free or {},
    )  # fmt: skip


def two_ramps():
    return PlantShell(setpoint_rate={"level_1": 0.5, "level_2": 0.5})


def both():
    return {
        name.replace("_1.", f"_{number}."): value
        for name, value in AT_REST.items()
        for number in (1, 2)
    }


def test_a_setpoint_that_stands_fixed_is_left_alone():
    """The second setpoint is a free input: no ramp, no name of the shell, the law's own bits."""
    bare = two_loops(("level_1",), {"level_2.sp": 5.0})
    shelled = with_plant_shell(bare, 1.0, RAMP)
    assert (
        "level_1.setpoint_rate" in shelled.values and "level_2.setpoint_rate" not in shelled.values
    )
    loop, alone = ScannedLaw(shelled, 1.0, **both()), ScannedLaw(bare, 1.0, **both())
    for setpoint in (5.0, 9.0, math.nan, 2.0):
        found, expected = loop.scan(level_2_sp=setpoint), alone.scan(level_2_sp=setpoint)
        for name in ("pump_1.out", "pump_2.out", "pump_1.status", "pump_2.status"):
            assert found[name] == expected[name]
    assert expected["pump_2.out"] != 3.0
    assert "setpoint_ramps" in read_status(int(loop.scan(level_1_sp=9.0)["pump_1.status"]))
    assert "setpoint_ramps" not in read_status(int(loop.scan(level_2_sp=9.0)["pump_2.status"]))


LIMITED = [{}, {"rate_limited": True}]


@pytest.mark.parametrize("options", LIMITED)
def test_tracking_is_not_slowed_and_automatic_goes_on_from_it(options):
    """Somebody else moves the actuator: the rate limit is none of his."""
    loop = shelled_loop(1.0, RATE, **options)
    loop.scan()
    for value in (8.0, 1.0, 7.5):
        outputs = loop.scan(pump_1_mode=2, pump_1_tracking=value, level_1_pv=4.0)
        assert outputs["pump_1.out"] == loop.state["pump_1.last_output"] == value
        assert read_status(int(outputs["pump_1.status"])) == ("tracking",)
    before = loop.scan(pump_1_tracking=8.0)["pump_1.out"]
    assert loop.scan(pump_1_mode=1)["pump_1.out"] == pytest.approx(before, abs=1e-12)
    # From there the controller moves it, at its rate.
    assert loop.scan(level_1_sp=1.0)["pump_1.out"] == pytest.approx(before - 0.25, abs=1e-12)
    loop.scan(pump_1_mode=2, pump_1_tracking=2.0)
    assert loop.scan(pump_1_mode=0, pump_1_manual=6.0)["pump_1.out"] == 2.25


@pytest.mark.parametrize("options", LIMITED)
def test_after_fail_safe_the_hand_moves_at_its_rate(options):
    settings = PlantShell(rate_limit={"pump_1": 0.25}, fail_safe={"pump_1": 9.0})
    loop = shelled_loop(1.0, settings, **options)
    assert loop.scans(6, level_1_good=0)["pump_1.out"] == 9.0
    assert loop.scan(pump_1_mode=0, pump_1_manual=3.0)["pump_1.out"] == 8.75
