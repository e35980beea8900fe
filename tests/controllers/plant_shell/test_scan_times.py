"""Scans that come late, once or for ever, and scans without a time step."""

import math

import pytest
from scan_rig import ScannedLaw, at_rest, designed
from shell_rig import read_status, shelled_loop

from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell

SAFE = PlantShell(fail_safe={"pump_1": 1.5})
#: K/Ti e Δt with K = 2, Ti = 40 s and e = 1, in a second.
INCREMENT = 0.05


def status(outputs):
    return set(read_status(int(outputs["pump_1.status"])))


def at_work(settings=None):
    """A loop whose error is 1, so that its output rises by the increment in each scan."""
    loop = shelled_loop(1.0, settings)
    loop.scans(3)
    loop.scan(level_1_sp=6.0)
    return loop


@pytest.mark.parametrize("late", [5.01, 600.0, 4294967.0, 1e9])
def test_a_scan_that_comes_late_counts_as_one_and_starts_warm(late):
    """After a breakpoint, or where nothing ran for a while: no step of the output."""
    loop = at_work()
    before = loop.scan()["pump_1.out"]
    outputs = loop.scan(time_step=late)
    assert outputs["pump_1.out"] == before
    assert {"scan_lost", "following", "automatic"} <= status(outputs)
    after = [loop.scan(time_step=1.0)["pump_1.out"] for _ in range(3)]
    # What the law takes up is what stands; then it goes on as before.
    assert after[0] == pytest.approx(before, abs=2 * INCREMENT)
    assert after[2] - after[1] == pytest.approx(INCREMENT, abs=1e-12)


@pytest.mark.parametrize("gap", [2.0, 5.0])
def test_up_to_the_longest_gap_the_measured_time_counts(gap):
    loop = at_work()
    loop.values["longest_gap"] = gap
    before = loop.scan()["pump_1.out"]
    outputs = loop.scan(time_step=gap)
    # The integral of the scan before is in this output, that of this one in the next.
    assert outputs["pump_1.out"] - before == pytest.approx(INCREMENT, abs=1e-12)
    assert "scan_lost" not in status(outputs)
    found = loop.scan(time_step=1.0)["pump_1.out"] - outputs["pump_1.out"]
    assert found == pytest.approx(gap * INCREMENT, abs=1e-12)


def test_that_a_scan_was_lost_is_told_until_it_is_acknowledged():
    loop = at_work()
    loop.scan(time_step=600.0)
    assert all("scan_lost" in status(loop.scan(time_step=1.0)) for _ in range(50))
    assert "scan_lost" in status(loop.scan(acknowledge=1, time_step=600.0))
    # Held it takes back nothing.
    assert "scan_lost" in status(loop.scan(time_step=1.0))
    loop.scan(acknowledge=0)
    assert "scan_lost" not in status(loop.scan(acknowledge=1))
    assert "scan_lost" not in status(loop.scan(acknowledge=0))


def test_a_cold_start_knows_of_no_lost_scan():
    loop = at_work()
    loop.scan(time_step=600.0)
    assert "scan_lost" not in status(loop.scan(time_step=1.0, start=2))


@pytest.mark.parametrize("start", [1, 2])
def test_the_time_before_a_start_is_not_judged(start):
    loop = at_work()
    outputs = loop.scan(start=start, time_step=600.0)
    assert "scan_lost" not in status(outputs)


@pytest.mark.parametrize("wrong", [0.0, -1.0, -4294967.0, math.nan, math.inf, 1e301])
def test_a_scan_without_a_time_step_counts_as_one_sampling_period(wrong):
    loop = at_work()
    before = loop.scan()["pump_1.out"]
    outputs = loop.scan(time_step=wrong)
    assert outputs["pump_1.out"] - before == pytest.approx(INCREMENT, abs=1e-12)
    assert status(outputs) == {"automatic", "invalid_time_step"}
    found = loop.scan(time_step=1.0)["pump_1.out"] - outputs["pump_1.out"]
    assert found == pytest.approx(INCREMENT, abs=1e-12)


@pytest.mark.parametrize("wrong", [0.0, math.nan, 600.0])
def test_without_any_time_it_fails_safe_until_it_is_acknowledged(wrong):
    """Five sampling periods are the longest gap."""
    loop = at_work(SAFE)
    told = [loop.scan(time_step=wrong) for _ in range(8)]
    assert ["failed_safe" in status(each) for each in told] == [False] * 5 + [True] * 3
    assert told[-1]["pump_1.out"] == 1.5
    # Acknowledged while there is no time yet.
    assert "failed_safe" in status(loop.scan(acknowledge=1))
    assert "failed_safe" in status(loop.scan(acknowledge=0, time_step=1.0))
    outputs = loop.scan(acknowledge=1)
    assert "failed_safe" not in status(outputs)
    assert loop.scans(2, acknowledge=0)["pump_1.out"] == pytest.approx(1.5, abs=2 * INCREMENT)


def test_a_clock_that_fails_more_often_than_not_fails_safe():
    loop = at_work(SAFE)
    told = [status(loop.scan(time_step=0.0 if k % 3 else 1.0)) for k in range(40)]
    assert "failed_safe" in told[-1] and "failed_safe" not in told[4]
    loop = at_work(SAFE)
    assert not any(
        "failed_safe" in status(loop.scan(time_step=1.0 if k % 3 else 0.0)) for k in range(200)
    )


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "process"),
    [
        ("PI, SIMC", "quadruple-tank"),
        ("PID, phase margin", "quadruple-tank"),
        ("LQI with Kalman filter", "quadruple-tank"),
        ("2DOF polynomial, LQ", "quadruple-tank"),
        ("Feedback linearisation", "quadruple-tank"),
        ("One-step inverse", "averaging-tank"),
        ("Glover-McFarlane on PI, SIMC", "quadruple-tank"),
        ("Fuzzy PI", "quadruple-tank"),
    ],
)
def test_no_family_makes_a_step_of_a_gap(name, process):
    """A level off by 1 % of its range for an hour that nobody ran is no reason to move."""
    controller, plant = designed(name, process)
    shelled = with_plant_shell(controller, 1.0)
    loop = ScannedLaw(shelled, 1.0, **at_rest(controller, plant))
    loop.scans(20)
    first, *_ = controller.measurements
    (level,) = (s for s in controller.law.inputs if s.name == f"{first}.pv")
    low = loop.inputs[level.name] - 0.01 * level.span
    outputs = loop.scans(3, **{level.name: low})
    before = {u: outputs[f"{u}.out"] for u in controller.manipulated}
    late = loop.scan(time_step=3600.0)
    for u in controller.manipulated:
        assert late[f"{u}.out"] == pytest.approx(before[u], abs=1e-9)
