"""Parameters are inputs: what is not valid leaves the last valid value in force, and is told."""

import math

import numpy as np
import pytest
from scan_rig import ScannedLaw, at_rest, designed
from shell_rig import read_status, shelled_loop

from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell

SETTINGS = PlantShell(
    fail_safe={"pump_1": 1.5}, rate_limit={"pump_1": 0.75}, setpoint_rate={"level_1": 0.5}
)
NOT_NUMBERS = [math.nan, math.inf, -math.inf, 1e301]
WRONG = [
    *(("level_1.proportional_gain", each) for each in NOT_NUMBERS),
    *(("level_1.integral_time", each) for each in (*NOT_NUMBERS, 0.0, -40.0)),
    *(("pump_1.high_limit", each) for each in (*NOT_NUMBERS, -1.0, 0.0)),
    *(("pump_1.low_limit", each) for each in (*NOT_NUMBERS, 10.0, 11.0)),
    *(("pump_1.rate_limit", each) for each in (*NOT_NUMBERS, -1.0)),
    *(("level_1.setpoint_rate", each) for each in (*NOT_NUMBERS, -1.0)),
    *(("pump_1.fail_safe", each) for each in NOT_NUMBERS),
    *(("level_1.sensor_delay", each) for each in (*NOT_NUMBERS, -1.0)),
    *(("level_1.range_high", each) for each in (*NOT_NUMBERS, 0.0)),
    *(("sampling_period", each) for each in (*NOT_NUMBERS, 0.0, -1.0)),
    *(("longest_gap", each) for each in (*NOT_NUMBERS, 0.0, -1.0)),
    *(("take_up_scans", each) for each in (0.0, -3.0, 2e9)),
]  # fmt: skip


def status(outputs):
    return set(read_status(int(outputs["pump_1.status"])))


def history(name=None, wrong=0.0):
    """Outputs over steps, a fault and a warm start, while a parameter is wrong in some scans."""
    loop = shelled_loop(1.0, SETTINGS)
    right, found = loop.values.get(name), []
    steps = [{}, {"level_1.sp": 7.0}, *[{}] * 8, {"level_1.good": 0}, *[{}] * 6,
             {"level_1.good": 1}, {"acknowledge": 1}, *[{}] * 8, {"start": 1},
             *[{}] * 8]  # fmt: skip
    for k, step in enumerate(steps):
        if name:
            loop.values[name] = wrong if k >= 3 else right
        outputs = loop.scan(**step)
        found.append((outputs["pump_1.out"], status(outputs)))
    return found


@pytest.mark.parametrize(("name", "wrong"), WRONG)
def test_the_last_valid_value_stays_in_force_and_is_told(name, wrong):
    expected, found = history(), history(name, wrong)
    assert [out for out, _ in found] == [out for out, _ in expected]
    for k, ((_, told), (_, without)) in enumerate(zip(found, expected, strict=True)):
        assert told == without | ({"invalid_parameter"} if k >= 3 else set())


def test_it_is_the_last_valid_one_and_not_the_designed_one():
    loop = shelled_loop(1.0)
    loop.scans(2)
    loop.values["pump_1.high_limit"] = 4.0
    assert loop.scans(3, level_1_sp=16.0)["pump_1.out"] == 4.0
    loop.values["pump_1.high_limit"] = math.nan
    for _ in range(20):
        outputs = loop.scan()
        assert outputs["pump_1.out"] == 4.0
        assert {"at_high_limit", "invalid_parameter"} <= status(outputs)
    loop.values["pump_1.high_limit"] = 10.0
    outputs = loop.scans(3)
    assert outputs["pump_1.out"] == 10.0 and "invalid_parameter" not in status(outputs)


def test_limits_are_judged_together():
    """The low one alone would be valid; with a high one below it neither is."""
    loop = shelled_loop(1.0)
    loop.scan()
    loop.values |= {"pump_1.low_limit": 8.0, "pump_1.high_limit": 2.0}
    assert loop.scan(pump_1_mode=0, pump_1_manual=9.5)["pump_1.out"] == 9.5
    outputs = loop.scan(pump_1_manual=12.0)
    assert outputs["pump_1.out"] == 10.0 and "invalid_parameter" in status(outputs)


def test_a_transmitter_may_be_scaled_the_other_way_round():
    loop = shelled_loop(1.0)
    loop.values |= {"level_1.range_low": 16.0, "level_1.range_high": 0.0}
    assert "invalid_parameter" not in status(loop.scan())


def test_a_cold_start_takes_the_designed_value_where_none_is_valid():
    loop = shelled_loop(1.0)
    loop.values["pump_1.high_limit"] = 4.0
    loop.scan()
    loop.values["pump_1.high_limit"] = math.nan
    assert loop.scan(pump_1_mode=0, pump_1_manual=12.0)["pump_1.out"] == 4.0
    assert loop.scan(start=2)["pump_1.out"] == 10.0


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "process"),
    [
        ("PI, SIMC", "quadruple-tank"),
        ("LQI with Kalman filter", "quadruple-tank"),
        ("Feedback linearisation", "quadruple-tank"),
        ("One-step inverse", "averaging-tank"),
        ("Fuzzy PI", "quadruple-tank"),
        ("Glover-McFarlane on PI, SIMC", "quadruple-tank"),
        ("Start/stop levels", "wet-well:start-stop"),
    ],
)
def test_no_parameter_of_any_family_lets_an_output_leave_its_limits(name, process):
    controller, plant = designed(name, process)
    period = plant.process.sampling_period
    shelled = with_plant_shell(controller, period)
    loop = ScannedLaw(shelled, period, **at_rest(controller, plant))
    random = np.random.default_rng(3)
    for parameter in shelled.law.parameters:
        right = loop.values[parameter.name]
        if parameter.kind == "boolean":
            continue
        wrong = math.nan if parameter.kind == "real" else -(2.0**31)
        loop.values[parameter.name] = wrong
        for _ in range(2):
            y = random.choice(controller.measurements)
            (pv,) = (s for s in shelled.law.inputs if s.name == f"{y}.pv")
            outputs = loop.scan(**{pv.name: random.uniform(pv.low, pv.high)})
            for u in controller.manipulated:
                (out,) = (s for s in shelled.law.outputs if s.name == f"{u}.out")
                assert out.low <= outputs[out.name] <= out.high
                assert "invalid_parameter" in read_status(int(outputs[f"{u}.status"]))
        loop.values[parameter.name] = right
