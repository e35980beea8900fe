"""Disturbance rejection: against an observer in matrices, and what is known of its loop."""

import numpy as np
import pytest
from pid_rig import AUTOMATIC, MANUAL, TRACKING, Scans

from clepsydra.controllers.disturbance_rejection import disturbance_rejection_law

SLOPE, BANDWIDTH, OBSERVER, STEP = 0.02, 0.1, 0.5, 1.0


def loop(level=5.0, output=40.0, **changed):
    values = {
        "level_1.bandwidth": BANDWIDTH,
        "level_1.observer_bandwidth": OBSERVER,
        "level_1.model_gain": SLOPE,
        "pump_1.low_limit": 0.0,
        "pump_1.high_limit": 100.0,
    }
    given = {"level_1.sp": level, "level_1.pv": level, "pump_1.tracking": output}
    given |= {"pump_1.manual": output, "time_step": STEP}
    law = disturbance_rejection_law(["level_1"], ["pump_1"])
    return Scans(law, values | {f"level_1.{key}": value for key, value in changed.items()}, **given)


class Tank:
    """A level that integrates pump and load exactly over each sample."""

    def __init__(self, scans, level=5.0, load=0.0):
        self.scans, self.level, self.load = scans, level, load

    def run(self, count, **inputs):
        levels, moved = [], []
        for _ in range(count):
            moved.append(self.scans.moved(level_1_pv=self.level, **inputs))
            self.level += STEP * SLOPE * (moved[-1] - 40.0 - self.load)
            levels.append(self.level)
        return np.array(levels), np.array(moved)


@pytest.mark.parametrize("slope", [SLOPE, -SLOPE])
def test_equals_an_observer_in_matrices_with_both_poles_placed(slope):
    """x⁻ = A x + B u, x = x⁻ + L (y − C x⁻): L by Ackermann's formula for A and C A."""
    scans, random = loop(model_gain=slope), np.random.default_rng(5)
    state, moved = np.array([5.0, 40.0]), 40.0
    for _ in range(200):
        step, level, setpoint = random.uniform(0.2, 5.0), *random.uniform(4.0, 6.0, 2)
        pole = 1.0 / (1.0 + OBSERVER * step)
        A = np.array([[1.0, -step * slope], [0.0, 1.0]])
        seen = A[:1]
        shifted = (A - pole * np.eye(2)) @ (A - pole * np.eye(2))
        gain = shifted @ np.linalg.solve(np.vstack([seen, seen @ A]), [0.0, 1.0])
        before = A @ state + [step * slope * moved, 0.0]
        state = before + gain * (level - before[0])
        asked = state[1] + BANDWIDTH / slope * (setpoint - state[0])
        moved = scans.moved(level_1_sp=setpoint, level_1_pv=level, time_step=step)
        assert moved == pytest.approx(min(100.0, max(0.0, asked)), rel=1e-9, abs=1e-7)


def test_a_load_is_found_and_leaves_no_offset():
    """The error of the observer is a sum of z^k and k z^k: after 60 samples 60 · 1.5^−60."""
    scans = loop()
    tank = Tank(scans, load=10.0)
    levels, moved = tank.run(60)
    assert scans.state["level_1.balance"] == pytest.approx(50.0, abs=1e-6)
    levels, moved = tank.run(200)
    assert levels[-1] == pytest.approx(5.0, abs=1e-6) and moved[-1] == pytest.approx(50.0, abs=1e-6)


def test_a_setpoint_step_is_answered_as_by_a_first_order_lag_and_nothing_winds_up():
    """The observer sees what it expects: r − y shrinks by 1 − ωc Δt in each sample."""
    levels, _ = Tank(loop()).run(30, level_1_sp=6.0)
    assert 6.0 - levels == pytest.approx((1.0 - BANDWIDTH * STEP) ** np.arange(1, 31), rel=1e-9)
    far, moved = Tank(loop()).run(400, level_1_sp=60.0)
    assert np.count_nonzero(moved == 100.0) > 20
    assert far.max() <= 60.0 + 1e-9 and far[-1] == pytest.approx(60.0, abs=1e-6)


@pytest.mark.parametrize("mode", [MANUAL, TRACKING])
def test_automatic_goes_on_from_what_was_moved_by_hand(mode):
    scans = loop()
    tank = Tank(scans, load=30.0)
    levels, _ = tank.run(80, pump_1_mode=mode, pump_1_manual=70.0, pump_1_tracking=70.0)
    assert levels[-1] == pytest.approx(5.0, abs=1e-9)
    assert tank.run(1, pump_1_mode=AUTOMATIC)[1] == pytest.approx(70.0, abs=1e-6)


def test_a_lost_sensor_holds_the_output_and_comes_back_without_a_jump():
    scans = loop()
    tank = Tank(scans, load=10.0)
    _, before = tank.run(250)
    _, held = tank.run(50, level_1_good=0.0)
    assert (held == before[-1]).all()
    tank.level = 5.4
    _, after = tank.run(1, level_1_good=1.0)
    assert after[0] == pytest.approx(before[-1] - BANDWIDTH / SLOPE * 0.4, abs=1e-6)


def test_a_model_gain_of_zero_holds_the_output():
    scans = loop()
    scans.set(level_1_model_gain=0.0)
    assert scans.moved(level_1_sp=9.0) == 40.0
