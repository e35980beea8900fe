"""A sensor that fails: how it is judged, how long that is ridden through, and what then."""

import math
from dataclasses import replace

import pytest
from scan_rig import ScannedLaw, at_rest, designed
from shell_rig import LEVEL, one_loop, read_status, shelled_loop

from clepsydra import Signal
from clepsydra.controllers.plant_shell.members import needed_by_outputs
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS
from clepsydra.program.step_law import Equations, step_law

SAFE = PlantShell(fail_safe={"pump_1": 1.5})
FAULTS = [
    {"level_1.good": 0},
    {"level_1.pv": math.nan},
    {"level_1.pv": math.inf},
    {"level_1.pv": -0.5},  # 3.5 mA
    {"level_1.pv": 17.5},  # 21.5 mA
]
GOOD = {"level_1.good": 1, "level_1.pv": 5.0}


def failed(outputs):
    return bool(int(outputs["pump_1.status"]) & 1024)


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(("scans", "fails"), [(39, False), (40, False), (41, True)])
def test_a_fault_of_3_9_s_rides_through_and_one_of_4_1_s_fails_safe(fault, scans, fails):
    loop = shelled_loop(0.1, SAFE)
    for _ in range(5):  # the integral is on its way
        before = loop.scan(level_1_sp=6.0)["pump_1.out"]
    integral = loop.state["level_1.integral"]
    assert integral != 3.0 and before != 3.0
    for k in range(1, scans + 1):
        outputs = loop.scan(**fault)
        if k <= 40:
            assert outputs["pump_1.out"] == before
            assert loop.state["level_1.integral"] == integral
            assert {"automatic", "sensor_fault", "rides_through"} <= set(
                read_status(int(outputs["pump_1.status"]))
            )
            assert not failed(outputs)
    if fails:
        assert failed(outputs) and outputs["pump_1.out"] == 1.5
        assert not int(outputs["pump_1.status"]) & SHELL_STATUS_BITS["rides_through"].value
        assert failed(loop.scan(**GOOD))  # latched
    else:
        outputs = loop.scan(**GOOD)
        assert read_status(int(outputs["pump_1.status"])) == ("automatic",)
        assert outputs["pump_1.out"] == 2.0 * (6.0 - 5.0) + integral


@pytest.mark.parametrize(
    ("period", "delay", "whole"),
    [(1.0, 4.0, 4), (0.3, 4.0, 14), (0.3, 3.9, 13), (0.7, 0.5, 1), (2.0, 0.0, 0), (60.0, 4.0, 1)],
)
def test_the_delay_is_rounded_up_to_whole_scans(period, delay, whole):
    """A fault first seen in scan k has failed in scan k + n."""
    loop = shelled_loop(period, PlantShell(sensor_delay={"level_1": delay}))
    loop.scan()
    told = [failed(loop.scan(level_1_good=0)) for _ in range(whole + 2)]
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
    outputs = loop.scan(level_1_pv=current - 4.0)
    word = read_status(int(outputs["pump_1.status"]))
    assert ("sensor_fault" not in word, "sensor_uncertain" in word) == (good, uncertain)
    assert loop.state["level_1.good_measurement"] == (current - 4.0 if good else LEVEL.initial)


def test_uncertain_currents_control_on_for_ever():
    loop = shelled_loop(1.0)
    outputs = loop.scans(20, level_1_pv=-0.3, level_1_sp=0.0)
    assert read_status(int(outputs["pump_1.status"])) == ("automatic", "sensor_uncertain")


def test_the_range_is_that_of_the_signal():
    loop = shelled_loop(1.0, level=replace(LEVEL, low=-10.0, high=30.0))
    # 3.6 and 21 mA of 40 V over 16 mA, from -10 V.
    for value, good in ((-11.01, False), (-10.99, True), (32.49, True), (32.51, False)):
        told = read_status(int(loop.scan(level_1_pv=value)["pump_1.status"]))
        assert ("sensor_fault" not in told) == good


def test_a_fault_of_another_kind_is_still_the_same_fault():
    loop = shelled_loop(1.0)
    loop.scan()
    told = [failed(loop.scan(**fault)) for fault in FAULTS]
    assert told == [False] * 4 + [True]


def test_good_time_makes_up_for_half_as_much_bad_time():
    """4 s bad, 3 s good: 2.5 s are left of the delay of 4 s, and 1.5 s more are over it."""
    loop = shelled_loop(1.0)
    loop.scan()
    assert not failed(loop.scans(4, level_1_good=0))
    assert not failed(loop.scans(3, **GOOD))
    assert not failed(loop.scans(2, level_1_good=0))
    assert loop.state["level_1.fault_time"] == 4.0 - 1.5 + 1.0
    assert failed(loop.scan())


@pytest.mark.parametrize(("good", "bad"), [(1, 4), (1, 1), (2, 2), (5, 3)])
def test_a_sensor_that_comes_and_goes_fails_safe(good, bad):
    """Bad for more than a third of the time; after g good and b bad scans b - g/2 s are left."""
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    left, scans = 0.0, 0
    while left < 4.0:
        left, scans = left + bad - 0.5 * good, scans + good + bad
    told = [
        failed(loop.scan(**(GOOD if k % (good + bad) < good else FAULTS[0])))
        for k in range(scans + 3 * (good + bad))
    ]
    assert told[-1] and not any(told[:4])


def test_a_sensor_that_is_seldom_bad_never_fails_safe():
    """For a third of the time at most: what a scan adds two good ones take away."""
    loop = shelled_loop(1.0, SAFE)
    for k in range(300):
        outputs = loop.scan(**(FAULTS[0] if k % 3 == 2 else GOOD))
        assert not failed(outputs)
        assert loop.state["level_1.fault_time"] <= 1.0


@pytest.mark.parametrize("time_step", [0.5, 1.0, 2.0])
def test_the_delay_is_a_time_whatever_the_scans_are(time_step):
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    told = [failed(loop.scan(level_1_good=0, time_step=time_step)) for _ in range(10)]
    assert told.index(True) == 4.0 / time_step


@pytest.mark.parametrize("fault", FAULTS)
def test_a_sensor_that_was_never_good_is_not_ridden_through(fault):
    loop = shelled_loop(1.0, PlantShell(fail_safe={"pump_1": 1.5}, sensor_delay={"level_1": 60.0}))
    outputs = loop.scan(**fault)
    assert failed(outputs) and outputs["pump_1.out"] == 1.5
    assert not int(outputs["pump_1.status"]) & SHELL_STATUS_BITS["rides_through"].value


@pytest.mark.parametrize("wrong", [math.nan, 0.0, -1.0])
def test_a_sampling_period_or_delay_that_is_none_does_not_wait_for_ever(wrong):
    loop = shelled_loop(1.0)
    loop.values["sampling_period"] = wrong
    assert failed(loop.scans(6, level_1_good=0))
    loop = shelled_loop(1.0)
    loop.scan()
    loop.values["level_1.sensor_delay"] = wrong
    assert failed(loop.scans(6, level_1_good=0))


def test_where_the_range_is_not_known_no_current_is_told():
    shelled = with_plant_shell(one_loop(level=Signal("level_1", "V", initial=5.0)), 1.0)
    assert not any(name.endswith(("range_low", "range_high")) for name in shelled.values)
    assert any("range of level_1 is not known" in note for note in shelled.notes)
    loop = shelled_loop(1.0, level=Signal("level_1", "V", initial=5.0))
    assert "current_1" not in [signal.name for signal in loop.law.intermediates]
    assert read_status(int(loop.scan(level_1_pv=1e9)["pump_1.status"]))[-1] != "sensor_fault"
    for fault in FAULTS[:3]:
        word = read_status(int(loop.scan(**(GOOD | fault))["pump_1.status"]))
        assert "sensor_fault" in word and "rides_through" in word


def test_what_is_not_a_number_is_told_as_invalid_too():
    loop = shelled_loop(1.0)
    assert "invalid_input" in read_status(int(loop.scan(level_1_pv=math.nan)["pump_1.status"]))
    assert "invalid_input" not in read_status(int(loop.scan(**GOOD)["pump_1.status"]))


def test_it_stays_until_good_sensors_are_acknowledged():
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    assert loop.scans(5, level_1_good=0)["pump_1.out"] == 1.5
    # Acknowledged too early.
    assert failed(loop.scan(acknowledge=1)) and failed(loop.scan(acknowledge=0))
    assert failed(loop.scans(10, **GOOD))
    assert loop.scan()["pump_1.out"] == 1.5
    outputs = loop.scan(acknowledge=1)
    assert not failed(outputs)
    assert read_status(int(loop.scan(acknowledge=0)["pump_1.status"])) == ("automatic",)


@pytest.mark.parametrize(("mode", "name"), [(0, "pump_1.manual"), (2, "pump_1.tracking")])
def test_an_operator_may_always_move_the_actuator(mode, name):
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    loop.scans(6, level_1_good=0)
    outputs = loop.scan(pump_1_mode=mode, **{name: 7.25})
    assert outputs["pump_1.out"] == 7.25 and failed(outputs)
    # Automatic with the sensor still bad: safe again.
    assert loop.scan(pump_1_mode=1)["pump_1.out"] == 1.5
    # With a good sensor a hand takes the latch back.
    outputs = loop.scan(pump_1_mode=mode, **GOOD)
    assert not failed(outputs)
    assert not failed(loop.scan(pump_1_mode=1)) and loop.state["pump_1.failed_safe"] == 0.0


def test_a_mode_that_is_none_fails_safe_too():
    loop = shelled_loop(1.0, SAFE)
    loop.scan(pump_1_mode=3)
    assert loop.scans(5, level_1_good=0)["pump_1.out"] == 1.5


def test_an_operator_in_manual_is_not_disturbed_by_the_failure():
    loop = shelled_loop(1.0, SAFE)
    for _ in range(10):
        assert loop.scan(pump_1_mode=0, pump_1_manual=6.0, level_1_good=0)["pump_1.out"] == 6.0
    assert loop.scan(pump_1_mode=1)["pump_1.out"] == 1.5


def test_a_fail_safe_value_is_within_the_limits_and_not_slowed():
    settings = PlantShell(fail_safe={"pump_1": 9.0}, rate_limit={"pump_1": 0.1})
    loop = shelled_loop(1.0, settings)
    loop.scan()
    assert loop.scans(5, level_1_good=0)["pump_1.out"] == 9.0
    loop.values["pump_1.high_limit"] = 8.0
    assert loop.scan()["pump_1.out"] == 8.0
    # Back in automatic it is slowed again.
    loop.scans(2, acknowledge=1, **GOOD)
    before = loop.scan(level_1_pv=5.0, level_1_sp=1.0)["pump_1.out"]
    assert loop.scan()["pump_1.out"] == pytest.approx(before - 0.1, abs=1e-12)


@pytest.mark.parametrize("wrong", [math.nan, 0.0, -1.0])
@pytest.mark.parametrize("options", [{}, {"rate_limited": True, "pump_1.rate_limit": 0.5}])
def test_it_fails_safe_without_a_time_step(wrong, options):
    loop = shelled_loop(1.0, SAFE, **options)
    loop.scan()
    outputs = loop.scans(5, level_1_good=0, time_step=wrong)
    assert outputs["pump_1.out"] == 1.5
    assert {"failed_safe", "invalid_time_step"} <= set(read_status(int(outputs["pump_1.status"])))


LEVELS = ["level_1", "level_2", "level_3", "level_4"]


@pytest.mark.parametrize(
    ("name", "needed"),
    [
        ("PI, SIMC", [["level_1"], ["level_2"]]),
        ("PI, SIMC, dynamic decoupling", [["level_1"], ["level_2"]]),
        ("LQI, Bryson", [LEVELS, LEVELS]),
        ("Feedback linearisation", [LEVELS, LEVELS]),
        ("One-step inverse", [LEVELS, LEVELS]),
        ("Fuzzy PI", [["level_1"], ["level_2"]]),
    ],
)
def test_only_outputs_that_need_the_sensor_fail_safe(name, needed):
    controller, plant = designed(name, "quadruple-tank")
    found = needed_by_outputs(controller.law, ("pv", "good"))
    assert [sorted(levels) for levels in found.values()] == needed
    loop = ScannedLaw(
        with_plant_shell(controller, 1.0, PlantShell(fail_safe={"pump_1": 1.25, "pump_2": 2.5})),
        1.0,
        **at_rest(controller, plant),
    )
    loop.scan()
    outputs = loop.scans(6, level_1_good=0)
    for i, safe in ((1, 1.25), (2, 2.5)):
        fails = "level_1" in needed[i - 1]
        assert (outputs[f"pump_{i}.out"] == safe) == fails
        assert bool(int(outputs[f"pump_{i}.status"]) & 1024) == fails


def test_a_sensor_that_is_only_remembered_is_needed_by_what_it_reaches():
    law = step_law(
        "delayed",
        inputs=[Signal(n) for n in ("level_1.pv", "level_2.pv", "level_1.sp")],
        parameters=[],
        state=[Signal("first"), Signal("second")],
        outputs=[Signal("pump_1.out"), Signal("pump_2.out")],
        equations=lambda s: Equations(
            {"first": s["level_1.pv"], "second": s["first"]},
            {"pump_1.out": s["second"], "pump_2.out": s["level_2.pv"]},
        ),
    )
    assert needed_by_outputs(law, ("pv",)) == {"pump_1": ("level_1",), "pump_2": ("level_2",)}
    assert needed_by_outputs(law, ("sp",)) == {"pump_1": (), "pump_2": ()}


def test_a_pump_station_stops_its_pumps_together():
    controller, _ = designed("Start/stop levels", "wet-well:start-stop")
    shelled = with_plant_shell(controller, 1.0)
    assert any("runs or stands" in note for note in shelled.notes)
    assert not any(name.endswith("rate_limit") for name in shelled.values)
    top = max(v for name, v in controller.values.items() if "start_level" in name)
    signal = next(s for s in shelled.law.inputs if s.name == "level.pv")
    assert top < signal.high
    loop = ScannedLaw(shelled, 1.0, level_pv=0.5 * (top + signal.high))
    pumps = controller.manipulated
    running = [controller.values[f"{pump}.running_value"] for pump in pumps]
    outputs = loop.scans(3)
    assert [outputs[f"{pump}.out"] for pump in pumps] == running
    outputs = loop.scans(4, level_good=0)
    assert [outputs[f"{pump}.out"] for pump in pumps] == running
    outputs = loop.scan()
    lows = [controller.values[f"{pump}.low_limit"] for pump in pumps]
    assert [outputs[f"{pump}.out"] for pump in pumps] == lows
    outputs = loop.scans(4, level_good=1, acknowledge=1)
    assert [outputs[f"{pump}.out"] for pump in pumps] == running


def test_an_acknowledgement_that_is_held_takes_back_no_later_fault():
    """A button that sticks: pressed while good it clears that fault and no other."""
    loop = shelled_loop(1.0, SAFE)
    loop.scans(6, level_1_good=0)
    assert not failed(loop.scan(acknowledge=1, **GOOD))
    for _ in range(3):
        outputs = loop.scans(6, level_1_good=0)
        assert failed(outputs) and outputs["pump_1.out"] == 1.5
        assert failed(loop.scans(20, **GOOD))
    # Released and pressed again.
    assert failed(loop.scan(acknowledge=0))
    assert not failed(loop.scan(acknowledge=1))


@pytest.mark.parametrize("held", [1, 5])
def test_who_acknowledges_a_bad_sensor_has_to_do_it_again(held):
    loop = shelled_loop(1.0, SAFE)
    loop.scans(6, level_1_good=0)
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
    loop.scan(pump_1_mode=7)
    loop.scans(5, level_1_good=0)
    for mode in (3, -1, 7):
        outputs = loop.scan(pump_1_mode=mode, **GOOD)
        assert outputs["pump_1.out"] == 1.5 and failed(outputs)
    outputs = loop.scan(acknowledge=1)
    assert outputs["pump_1.out"] == 1.5 and not failed(outputs)
