"""A start where nothing was kept: the actuators are not where the design says."""

import math

import pytest
from scan_rig import ScannedLaw, at_rest, designed
from shell_rig import read_status, shelled_loop

from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell

SAFE = PlantShell(fail_safe={"pump_1": 1.5})


def status(outputs):
    return set(read_status(int(outputs["pump_1.status"])))


def test_a_warm_start_without_kept_state_begins_at_the_fail_safe_value():
    """The tank is nearly full, and the design rests at 3 V."""
    loop = shelled_loop(1.0, SAFE)
    outputs = loop.scan(start=1, level_1_pv=15.7, level_1_sp=5.0)
    assert outputs["pump_1.out"] == 1.5
    assert status(outputs) == {"automatic", "following", "state_lost"}
    # Then it goes on from there: K/Ti e Δt with K = 2, Ti = 40 s, e = -10.7.
    first, second = (loop.scan(start=0)["pump_1.out"] for _ in range(2))
    assert first == pytest.approx(1.5, abs=1e-9)
    assert second - first == pytest.approx(-2.0 / 40.0 * 10.7, abs=1e-9)


def test_it_is_told_until_it_is_acknowledged():
    loop = shelled_loop(1.0, SAFE)
    loop.scan(start=1)
    assert all("state_lost" in status(loop.scan(start=0)) for _ in range(20))
    assert "state_lost" not in status(loop.scan(acknowledge=1))
    assert "state_lost" not in status(loop.scan(acknowledge=0))


@pytest.mark.parametrize(
    ("mode", "given", "expected"),
    [
        (0, {"pump_1.manual": 7.0}, 7.0),
        (2, {"pump_1.tracking": 6.5}, 6.5),
        (0, {"pump_1.manual": math.nan}, 1.5),
        (2, {"pump_1.tracking": math.nan}, 1.5),
        (3, {}, 1.5),
    ],
)
def test_a_hand_and_what_is_tracked_go_first(mode, given, expected):
    loop = shelled_loop(1.0, SAFE)
    outputs = loop.scan(start=1, pump_1_mode=mode, **given)
    assert outputs["pump_1.out"] == expected and "state_lost" in status(outputs)


def test_a_bad_sensor_then_fails_safe_at_once():
    loop = shelled_loop(1.0, SAFE)
    outputs = loop.scan(start=1, level_1_good=0)
    assert outputs["pump_1.out"] == 1.5
    assert {"failed_safe", "state_lost"} <= status(outputs)


def test_with_kept_state_it_goes_on_from_the_last_output():
    loop = shelled_loop(1.0, SAFE)
    loop.scan()
    outputs = loop.scan(start=1)
    assert outputs["pump_1.out"] == 3.0 and "state_lost" not in status(outputs)


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "process"),
    [
        ("LQI with Kalman filter", "quadruple-tank"),
        ("Feedback linearisation", "quadruple-tank"),
        ("One-step inverse", "averaging-tank"),
        ("Smith predictor, PI", "eight-tanks"),
        ("Fuzzy PI", "quadruple-tank"),
        ("Start/stop levels", "wet-well:start-stop"),
    ],
)
def test_no_output_of_any_family_begins_at_the_operating_point(name, process):
    controller, plant = designed(name, process)
    period = plant.process.sampling_period
    high = {s.owner: s.high for s in controller.law.outputs if s.part == "out"}
    shelled = with_plant_shell(controller, period, PlantShell(fail_safe=high))
    loop = ScannedLaw(shelled, period, **at_rest(controller, plant))
    outputs = loop.scan(start=1)
    for u in controller.manipulated:
        assert outputs[f"{u}.out"] == high[u] > loop.inputs[f"{u}.manual"]
        told = set(read_status(int(outputs[f"{u}.status"])))
        assert {"following", "state_lost"} <= told and "failed_safe" not in told
