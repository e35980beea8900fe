"""Cold and warm start, the watchdog and the check of the scan time."""

import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scan_rig import at_rest, designed
from shell_rig import read_status, shelled_loop

from clepsydra import Kernel
from clepsydra.controllers.plant_shell.scan import scan_start
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.program.delay_ring import DelayRing

DEAD_TIME = Path(__file__).parents[2] / "dead-time.toml"


def random_scans(program, samples, seed):
    """Inputs of a plant that works, with some faults."""
    random = np.random.default_rng(seed)
    found = {}
    for signal in program.inputs:
        if signal.part == "mode":
            found[signal.name] = random.choice([0.0, 1.0, 1.0, 1.0, 2.0], size=samples)
        elif signal.part == "good":
            found[signal.name] = (random.random(samples) < 0.9).astype(float)
        elif signal.name in ("start", "acknowledge"):
            found[signal.name] = np.zeros(samples)
        elif signal.name == "time_step":
            found[signal.name] = np.full(samples, 1.0)
        else:
            width = signal.span if math.isfinite(signal.span) else 1.0
            low = signal.low if math.isfinite(signal.low) else 0.0
            found[signal.name] = low + width * random.uniform(0.1, 0.9, samples)
    return found


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "process"),
    [
        ("Smith predictor, LQ", DEAD_TIME),
        ("Smith predictor, PI", DEAD_TIME),
        ("PI, SIMC", "quadruple-tank"),
        ("LQI with Kalman filter", "quadruple-tank"),
        ("Start/stop levels", "wet-well:start-stop"),
    ],
)
@pytest.mark.parametrize("before", [1, 3, 50])
def test_a_cold_start_is_a_fresh_start_in_every_bit(name, process, before):
    controller, _ = designed(name, process)
    settings = PlantShell(
        setpoint_rate=dict.fromkeys(controller.setpoints, 0.001),
        sensor_delay=dict.fromkeys(controller.measurements, 2.0),
    )
    program = with_plant_shell(controller, 1.0, settings).program()
    rings = [entry.length for entry in program.state if isinstance(entry, DelayRing)]
    assert bool(rings) == name.startswith("Smith")
    after = 80
    history, later = random_scans(program, before, 1), random_scans(program, after, 2)
    joined = {n: np.concatenate([history[n], later[n]]) for n in later}
    joined["start"][before] = 2.0
    restarted = Kernel(program).run(before + after, inputs=joined)
    fresh = Kernel(program).run(after, inputs=later)
    for signal in program.outputs:
        found = restarted.output(signal.name)[0]
        expected = fresh.output(signal.name)[0]
        assert np.array_equal(found[before:].view(np.int64), expected.view(np.int64)), signal.name
    if name == "Start/stop levels":  # these levels set every stage anew
        return
    # Without the cold start what went before is felt.
    joined["start"][before] = 0.0
    moved = program.outputs[0].name
    other = Kernel(program).run(before + after, inputs=joined).output(moved)[0]
    assert not np.array_equal(other[before:], fresh.output(moved)[0])


@pytest.mark.parametrize("start", [1, 2])
def test_a_start_forgets_how_long_a_fault_has_lasted(start):
    loop = shelled_loop(1.0)
    loop.scan()
    loop.scans(4, level_1_good=0)
    assert loop.state["level_1.fault_time"] == 3.0
    outputs = loop.scan(start=start)
    assert loop.state["level_1.fault_time"] == 0.0
    # After a cold start there was no good measurement yet.
    assert bool(int(outputs["pump_1.status"]) & 1024) == (start == 2)


@pytest.mark.parametrize(("start", "kept"), [(1, True), (2, False)])
def test_a_warm_start_keeps_what_is_latched_and_a_cold_one_does_not(start, kept):
    loop = shelled_loop(1.0)
    loop.scans(6, level_1_good=0)
    outputs = loop.scan(start=start, level_1_good=1)
    assert bool(int(outputs["pump_1.status"]) & 1024) == kept


def test_a_warm_start_in_manual_leaves_the_hand_alone():
    loop = shelled_loop(1.0)
    loop.scan()
    assert loop.scan(start=1, pump_1_mode=0, pump_1_manual=7.0)["pump_1.out"] == 7.0


def test_the_watchdog_counts_to_32767_and_over_again():
    controller, plant = designed("PI, SIMC", "quadruple-tank")
    shelled = with_plant_shell(controller, 1.0)
    samples = 70_000
    run = Kernel(shelled.program()).run(samples, inputs=at_rest(shelled, plant))
    count = run.output("watchdog")[0]
    assert np.array_equal(count, np.arange(1, samples + 1) % 32768)
    assert shelled.output_wires["watchdog"] == "controller.watchdog"


@pytest.mark.parametrize("spoilt", [-7.0, 40000.0])
def test_a_watchdog_that_memory_spoilt_counts_on_within_its_range(spoilt):
    loop = shelled_loop(1.0)
    loop.state["scans_counted"] = spoilt
    assert 0 <= loop.scan()["watchdog"] <= 32767


@pytest.mark.parametrize(
    ("time_step", "off"),
    [(0.5, False), (0.54, False), (0.56, True), (0.46, False), (0.44, True), (5.0, True)],
)
def test_the_scan_time_is_told_if_it_is_off_by_more_than_a_tenth(time_step, off):
    loop = shelled_loop(0.5)
    outputs = loop.scan(time_step=time_step)
    assert ("scan_time_off" in read_status(int(outputs["pump_1.status"]))) == off
    # The scan of a start is not judged.
    outputs = loop.scan(start=1)
    assert "scan_time_off" not in read_status(int(outputs["pump_1.status"]))


@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan, math.inf])
def test_a_time_step_that_is_none_has_its_own_bit(time_step):
    outputs = shelled_loop(0.5).scan(time_step=time_step)
    assert read_status(int(outputs["pump_1.status"])) == ("automatic", "invalid_time_step")


def test_the_measured_time_step_is_what_the_law_gets():
    """K/Ti e Δt with K = 2, Ti = 40 s, e = 1."""
    loop = shelled_loop(0.5)
    loop.scan()
    before = loop.state["level_1.integral"]
    loop.scan(level_1_sp=6.0, time_step=0.8)
    assert loop.state["level_1.integral"] - before == pytest.approx(2.0 / 40.0 * 0.8, abs=1e-15)


@pytest.mark.parametrize("start", [1, 2])
def test_a_start_that_is_held_acts_once(start):
    """A switch left on: the loop controls on, and a dead sensor fails safe."""
    loop = shelled_loop(1.0)
    loop.scan()
    loop.scan(start=start)
    moved = [loop.scan(level_1_pv=4.0)["pump_1.out"] for _ in range(4)]
    # K e and K/Ti e Δt with K = 2, Ti = 40 s, e = 1, in the scan after the start with one of
    # taking up where it is warm: there the present error makes no bump.
    assert np.diff(moved)[1:] == pytest.approx([0.05] * 2, abs=1e-12)
    told = [bool(int(loop.scan(level_1_good=0)["pump_1.status"]) & 1024) for _ in range(6)]
    assert told == [False] * 4 + [True] * 2


def test_only_a_change_of_start_to_one_or_two_is_a_start():
    state = {entry.name: 0 for entry in scan_start(delays=False).state}
    state |= {"scans_since_start": 1, "scans_counted": 7}
    in_time = {"time_step": 1.0, "sampling_period": 1.0, "scan_tolerance": 0.1, "longest_gap": 5.0}
    cases = [(1, "warm"), (1, ""), (2, "cold"), (2, ""), (2, ""), (1, "warm"), (0, ""),
             (2, "cold"), (0, ""), (3, ""), (1, "warm"), (-1, ""), (2, "cold")]  # fmt: skip
    for start, kind in cases:
        inputs = {"start": ca.DM(start), "acknowledge": ca.DM(0), **in_time}
        found = scan_start(delays=False)("scan", inputs, state)
        told = {name: bool(ca.evalf(value)) for name, value in found.outputs.items()}
        assert (told["warm"], told["cold"]) == (kind == "warm", kind == "cold"), (start, kind)
        state = {name: ca.evalf(value) for name, value in found.next_state.items()}


@pytest.mark.parametrize("scans", [1, 3])
def test_following_is_told_for_as_long_as_the_law_takes_up(scans):
    loop = shelled_loop(1.0)
    loop.values["take_up_scans"] = float(scans)
    told = []
    for k in range(6):
        outputs = loop.scan(start=float(k == 1))
        told.append("following" in read_status(int(outputs["pump_1.status"])))
    assert told == [1 <= k <= scans for k in range(6)]
    # A hand moves the output itself: nothing is taken up.
    loop.scan(pump_1_mode=0, start=0)
    assert int(loop.scan(start=1)["pump_1.status"]) == 0
