"""A sensor that fails: how it is judged, how long that is ridden through, and what then."""

import math

import pytest
from scan_rig import ScannedLaw, at_rest, designed
from shell_rig import LEVEL, one_loop, shelled_loop

from clepsydra import Signal
from clepsydra.controllers.plant_shell.dependence import needed_by_outputs
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS, read_status
from clepsydra.program.step_law import Equations, step_law

SAFE = PlantShell(fail_safe={"pump_1": 1.5})
FAULTS = [
    {"sensor_1": 0},
    {"measurement_1": math.nan},
    {"measurement_1": math.inf},
    {"measurement_1": -0.5},  # 3.5 mA
    {"measurement_1": 17.5},  # 21.5 mA
]
GOOD = {"sensor_1": 1, "measurement_1": 5.0}


def failed(outputs):
    return bool(int(outputs["status_1"]) & 1024)


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(("scans", "fails"), [(39, False), (40, False), (41, True)])
def test_a_fault_of_3_9_s_rides_through_and_one_of_4_1_s_fails_safe(fault, scans, fails):
    loop = shelled_loop(0.1, SAFE)
    for _ in range(5):  # the integral is on its way
        before = loop.scan(setpoint_1=6.0)["manipulated_1"]
    integral = loop.state["integral_1"]
    assert integral != 3.0 and before != 3.0
    for k in range(1, scans + 1):
        outputs = loop.scan(**fault)
        if k <= 40:
            assert outputs["manipulated_1"] == before
            assert loop.state["integral_1"] == integral
            assert {"automatic", "sensor_fault", "rides_through"} <= set(
                read_status(int(outputs["status_1"]))
            )
            assert not failed(outputs)
    if fails:
        assert failed(outputs) and outputs["manipulated_1"] == 1.5
        assert not int(outputs["status_1"]) & SHELL_STATUS_BITS["rides_through"].value
        assert failed(loop.scan(**GOOD))  # latched
    else:
        outputs = loop.scan(**GOOD)
        assert read_status(int(outputs["status_1"])) == ("automatic",)
        assert outputs["manipulated_1"] == 2.0 * (6.0 - 5.0) + integral


@pytest.mark.parametrize(
    ("period", "delay", "whole"),
    [(1.0, 4.0, 4), (0.3, 4.0, 14), (0.3, 3.9, 13), (0.7, 0.5, 1), (2.0, 0.0, 0), (60.0, 4.0, 1)],
)
def test_the_delay_is_rounded_up_to_whole_scans(period, delay, whole):
    """A fault first seen in scan k has failed in scan k + n."""
    loop = shelled_loop(period, PlantShell(sensor_delay={"level_1": delay}))
    loop.scan()
    told = [failed(loop.scan(sensor_1=0)) for _ in range(whole + 2)]
    assert told == [False] * whole + [True, True]


@pytest.mark.parametrize(
    ("current", "good", "uncertain"),
    [
        (3.599999, False, False), (3.6, True, True), (3.799999, True, True), (3.8, True, False),
        (12.0, True, False), (20.5, True, False), (20.500001, True, True), (21.0, True, True),
        (21.000001, False, False),
    ],
)  # fmt: skip
def test_the_borders_of_ne_43(current, good, uncertain):
    loop = shelled_loop(1.0)
    outputs = loop.scan(measurement_1=current - 4.0)
    word = read_status(int(outputs["status_1"]))
    assert ("sensor_fault" not in word, "sensor_uncertain" in word) == (good, uncertain)
    assert loop.state["good_measurement_1"] == (current - 4.0 if good else LEVEL.initial)


def test_uncertain_currents_control_on_for_ever():
    loop = shelled_loop(1.0)
    outputs = loop.scans(20, measurement_1=-0.3, setpoint_1=0.0)
    assert read_status(int(outputs["status_1"])) == ("automatic", "sensor_uncertain")


def test_the_range_is_that_of_the_signal_or_of_the_settings():
    loop = shelled_loop(1.0, PlantShell(ranges={"level_1": (-10.0, 30.0)}))
    # 3.6 and 21 mA of 40 V over 16 mA, from -10 V.
    for value, good in ((-11.01, False), (-10.99, True), (32.49, True), (32.51, False)):
        told = read_status(int(loop.scan(measurement_1=value)["status_1"]))
        assert ("sensor_fault" not in told) == good


def test_a_fault_of_another_kind_is_still_the_same_fault():
    loop = shelled_loop(1.0)
    told = [failed(loop.scan(**fault)) for fault in FAULTS]
    assert told == [False] * 4 + [True]


def test_a_good_scan_in_between_begins_anew():
    loop = shelled_loop(1.0)
    loop.scans(4, sensor_1=0)
    assert not failed(loop.scans(1, **GOOD))
    assert not failed(loop.scans(4, sensor_1=0))
    assert failed(loop.scan())


def test_a_range_of_no_width_is_a_fault_and_divides_nothing():
    loop = shelled_loop(1.0)
    loop.values["range_high_1"] = loop.values["range_low_1"]
    outputs = loop.scan()
    assert all(math.isfinite(value) for value in loop.state.values())
    assert "sensor_fault" in read_status(int(outputs["status_1"]))


@pytest.mark.parametrize("wrong", [math.nan, 0.0, -1.0])
def test_a_sampling_period_or_delay_that_is_none_does_not_wait_for_ever(wrong):
    loop = shelled_loop(1.0)
    loop.values["sampling_period"] = wrong
    assert failed(loop.scans(6, sensor_1=0))
    loop = shelled_loop(1.0)
    loop.values["sensor_delay_1"] = wrong
    assert failed(loop.scan(sensor_1=0))


def test_where_the_range_is_not_known_no_current_is_told():
    shelled = with_plant_shell(one_loop(level=Signal("level_1", "V", initial=5.0)), 1.0)
    assert not any(name.startswith(("range_low", "range_high")) for name in shelled.values)
    assert any("range of level_1 is not known" in note for note in shelled.notes)
    loop = shelled_loop(1.0, level=Signal("level_1", "V", initial=5.0))
    assert "current_1" not in [signal.name for signal in loop.law.intermediates]
    assert read_status(int(loop.scan(measurement_1=1e9)["status_1"]))[-1] != "sensor_fault"
    for fault in FAULTS[:3]:
        word = read_status(int(loop.scan(**(GOOD | fault))["status_1"]))
        assert "sensor_fault" in word and "rides_through" in word


def test_what_is_not_a_number_is_told_as_invalid_too():
    loop = shelled_loop(1.0)
    assert "invalid_input" in read_status(int(loop.scan(measurement_1=math.nan)["status_1"]))
    assert "invalid_input" not in read_status(int(loop.scan(**GOOD)["status_1"]))


def test_it_stays_until_good_sensors_are_acknowledged():
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    assert loop.scans(5, sensor_1=0)["manipulated_1"] == 1.5
    # Acknowledged too early.
    assert failed(loop.scan(acknowledge=1)) and failed(loop.scan(acknowledge=0))
    assert failed(loop.scans(10, **GOOD))
    assert loop.scan()["manipulated_1"] == 1.5
    outputs = loop.scan(acknowledge=1)
    assert not failed(outputs)
    assert read_status(int(loop.scan(acknowledge=0)["status_1"])) == ("automatic",)


@pytest.mark.parametrize(("mode", "name"), [(0, "manual_1"), (2, "tracking_1")])
def test_an_operator_may_always_move_the_actuator(mode, name):
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    loop.scans(6, sensor_1=0)
    outputs = loop.scan(mode_1=mode, **{name: 7.25})
    assert outputs["manipulated_1"] == 7.25 and failed(outputs)
    # Automatic with the sensor still bad: safe again.
    assert loop.scan(mode_1=1)["manipulated_1"] == 1.5
    # With a good sensor a hand takes the latch back.
    outputs = loop.scan(mode_1=mode, **GOOD)
    assert not failed(outputs)
    assert not failed(loop.scan(mode_1=1)) and loop.state["failed_safe_1"] == 0.0


def test_a_mode_that_is_none_fails_safe_too():
    loop = shelled_loop(1.0, SAFE)
    loop.scan(mode_1=3)
    assert loop.scans(5, sensor_1=0)["manipulated_1"] == 1.5


def test_an_operator_in_manual_is_not_disturbed_by_the_failure():
    loop = shelled_loop(1.0, SAFE)
    for _ in range(10):
        assert loop.scan(mode_1=0, manual_1=6.0, sensor_1=0)["manipulated_1"] == 6.0
    assert loop.scan(mode_1=1)["manipulated_1"] == 1.5


def test_a_fail_safe_value_is_within_the_limits_and_not_slowed():
    settings = PlantShell(fail_safe={"pump_1": 9.0}, rate_limit={"pump_1": 0.1})
    loop = shelled_loop(1.0, settings)
    loop.scan()
    assert loop.scans(5, sensor_1=0)["manipulated_1"] == 9.0
    loop.values["high_limit_1"] = 8.0
    assert loop.scan()["manipulated_1"] == 8.0
    # Back in automatic it is slowed again.
    loop.scans(2, acknowledge=1, **GOOD)
    before = loop.scan(measurement_1=5.0, setpoint_1=1.0)["manipulated_1"]
    assert loop.scan()["manipulated_1"] == pytest.approx(before - 0.1, abs=1e-12)


@pytest.mark.parametrize("wrong", [math.nan, 0.0, -1.0])
@pytest.mark.parametrize("options", [{}, {"rate_limited": True, "rate_limit_1": 0.5}])
def test_it_fails_safe_without_a_time_step(wrong, options):
    loop = shelled_loop(1.0, SAFE, **options)
    loop.scan()
    outputs = loop.scans(5, sensor_1=0, time_step=wrong)
    assert outputs["manipulated_1"] == 1.5
    assert {"failed_safe", "invalid_time_step"} <= set(read_status(int(outputs["status_1"])))


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_a_fail_safe_value_that_is_not_a_number_is_the_low_limit(wrong):
    loop = shelled_loop(1.0, SAFE, low_limit_1=0.75)
    loop.scan()
    loop.values["fail_safe_1"] = wrong
    assert loop.scans(5, sensor_1=0)["manipulated_1"] == 0.75


@pytest.mark.parametrize(
    ("name", "needed"),
    [
        ("PI, SIMC", [(1,), (2,)]),
        ("PI, SIMC, dynamic decoupling", [(1,), (2,)]),
        ("LQI, Bryson", [(1, 2, 3, 4)] * 2),
        ("Feedback linearisation", [(1, 2, 3, 4)] * 2),
        ("Fuzzy PI", [(1,), (2,)]),
    ],
)
def test_only_outputs_that_need_the_sensor_fail_safe(name, needed):
    controller, plant = designed(name, "quadruple-tank")
    assert needed_by_outputs(controller.law, 2, ("measurement", "sensor")) == needed
    loop = ScannedLaw(
        with_plant_shell(controller, 1.0, PlantShell(fail_safe={"pump_1": 1.25, "pump_2": 2.5})),
        1.0,
        **at_rest(controller, plant),
    )
    loop.scan()
    outputs = loop.scans(6, sensor_1=0)
    for i, safe in ((1, 1.25), (2, 2.5)):
        fails = 1 in needed[i - 1]
        assert (outputs[f"manipulated_{i}"] == safe) == fails
        assert bool(int(outputs[f"status_{i}"]) & 1024) == fails


def test_a_sensor_that_is_only_remembered_is_needed_by_what_it_reaches():
    law = step_law(
        "delayed",
        inputs=[Signal(n) for n in ("measurement_1", "measurement_2", "setpoint_1")],
        parameters=[],
        state=[Signal("first"), Signal("second")],
        outputs=[Signal("manipulated_1"), Signal("manipulated_2")],
        equations=lambda s: Equations(
            {"first": s["measurement_1"], "second": s["first"]},
            {"manipulated_1": s["second"], "manipulated_2": s["measurement_2"]},
        ),
    )
    assert needed_by_outputs(law, 2, ("measurement",)) == [(1,), (2,)]
    assert needed_by_outputs(law, 2, ("setpoint",)) == [(), ()]


def test_a_pump_station_stops_its_pumps_together():
    controller, _ = designed("Start/stop levels", "wet-well:start-stop")
    shelled = with_plant_shell(controller, 1.0)
    assert any("runs or stands" in note for note in shelled.notes)
    assert not any(name.startswith("rate_limit") for name in shelled.values)
    top = max(v for name, v in controller.values.items() if name.startswith("start_level"))
    signal = next(s for s in shelled.law.inputs if s.name == "measurement_1")
    assert top < signal.high
    loop = ScannedLaw(shelled, 1.0, measurement_1=0.5 * (top + signal.high))
    count = len(controller.manipulated)
    running = [controller.values[f"running_value_{i}"] for i in range(1, count + 1)]
    outputs = loop.scans(3)
    assert [outputs[f"manipulated_{i}"] for i in range(1, count + 1)] == running
    outputs = loop.scans(4, sensor_1=0)
    assert [outputs[f"manipulated_{i}"] for i in range(1, count + 1)] == running
    outputs = loop.scan()
    lows = [controller.values[f"low_limit_{i}"] for i in range(1, count + 1)]
    assert [outputs[f"manipulated_{i}"] for i in range(1, count + 1)] == lows
    outputs = loop.scans(4, sensor_1=1, acknowledge=1)
    assert [outputs[f"manipulated_{i}"] for i in range(1, count + 1)] == running


def test_an_acknowledgement_that_is_held_takes_back_no_later_fault():
    """A button that sticks: pressed while good it clears that fault and no other."""
    loop = shelled_loop(1.0, SAFE)
    loop.scans(6, sensor_1=0)
    assert not failed(loop.scan(acknowledge=1, **GOOD))
    for _ in range(3):
        outputs = loop.scans(6, sensor_1=0)
        assert failed(outputs) and outputs["manipulated_1"] == 1.5
        assert failed(loop.scans(20, **GOOD))
    # Released and pressed again.
    assert failed(loop.scan(acknowledge=0))
    assert not failed(loop.scan(acknowledge=1))


@pytest.mark.parametrize("held", [1, 5])
def test_who_acknowledges_a_bad_sensor_has_to_do_it_again(held):
    loop = shelled_loop(1.0, SAFE)
    loop.scans(6, sensor_1=0)
    assert failed(loop.scans(held, acknowledge=1))
    assert failed(loop.scan(**GOOD)) and failed(loop.scans(3, acknowledge=1.0 if held > 1 else 0.0))
    loop.scan(acknowledge=0)
    assert not failed(loop.scan(acknowledge=1))


def test_an_acknowledgement_held_from_the_beginning_clears_nothing():
    loop = shelled_loop(1.0, SAFE)
    loop.scans(3, acknowledge=1)
    for k in range(60):
        outputs = loop.scan(**(FAULTS[0] if k % 10 < 6 else GOOD))
        assert failed(outputs) == (k >= 4)


def test_a_mode_that_is_none_stays_safe_until_it_is_acknowledged():
    """Like automatic; good sensors alone, or the mode, take nothing back."""
    loop = shelled_loop(1.0, SAFE)
    loop.scan(mode_1=7)
    loop.scans(5, sensor_1=0)
    for mode in (3, -1, 7):
        outputs = loop.scan(mode_1=mode, **GOOD)
        assert outputs["manipulated_1"] == 1.5 and failed(outputs)
    outputs = loop.scan(acknowledge=1)
    assert outputs["manipulated_1"] == 1.5 and not failed(outputs)
