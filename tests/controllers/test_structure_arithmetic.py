"""What each structure computes, by hand: cascade, override, split range, feedforward, ratio."""

import math

import numpy as np
import pytest
from pid_rig import BUMP, Scans, one_loop
from pid_rig import settings as pid_settings
from scheme_rig import cascade, decoupled, feedforward, override, ratio, split_range
from scipy.signal import lfilter

from clepsydra import PidForm
from clepsydra.controllers.blocks.status import read_status

STEP = 0.5
ANTI_WINDUPS = ("back_calculation", "conditional_integration", "clamping", "none")


def loop_settings(loop, gain, integral_time, tracking_time=None):
    return {
        f"{loop}.proportional_gain": gain,
        f"{loop}.integral_time": integral_time,
        f"{loop}.tracking_time": integral_time if tracking_time is None else tracking_time,
    }


# --- cascade ----------------------------------------------------------------------------------

OUTER, INNER = loop_settings("level", 4.0, 40.0), loop_settings("flow", 3.0, 5.0)


def resting_cascade(law=None, output=50.0, **changed):
    """Level 5 m at its setpoint, flow 8 l/s, pump at 50 %."""
    return Scans(
        law or cascade(), OUTER | INNER | changed, level_sp=5.0, level_pv=5.0,
        flow_pv=8.0, flow_local_setpoint=8.0, pump_tracking=output, time_step=STEP,
    )  # fmt: skip


def test_a_cascade_is_one_loop_in_another():
    scheme = resting_cascade()
    assert scheme.moved() == 50.0
    # The level falls by 0.2 m: 0.8 l/s more are asked for, and 2.4 % at once for that.
    first = scheme.moved(level_pv=4.8)
    assert first == pytest.approx(50.0 + 3.0 * 4.0 * 0.2, abs=BUMP)
    # Then the outer integral raises the setpoint by 4/40 · 0.2 · 0.5 = 0.01 l/s, and the inner
    # one goes on at 3/5 · 0.8 · 0.5 = 0.24 %.
    assert scheme.moved() - first == pytest.approx(3.0 * 0.01 + 0.24, abs=BUMP)


def test_the_setpoint_of_an_inner_loop_has_limits_and_the_outer_integral_heeds_them():
    scheme = resting_cascade(flow_setpoint_low_limit=7.0, flow_setpoint_high_limit=9.0)
    # Asked for 8 + 4 · 2 = 16 l/s the inner loop takes 9.
    assert scheme.moved(level_pv=3.0) == pytest.approx(50.0 + 3.0 * 1.0, abs=BUMP)
    # v − 9 goes to K e Tt/Ti = 8: the outer integral goes back to 9 while the inner one, held
    # at its own setpoint by a flow that follows, is at rest.
    for _ in range(3000):
        scheme.moved(flow_pv=9.0)
    assert scheme.state["level.integral"] == pytest.approx(9.0, abs=1e-6)
    # The error turns by a hair, and the setpoint leaves the limit in that very sample.
    before = scheme.twin().moved()
    assert scheme.moved(level_pv=5.1) - before == pytest.approx(-3.0 * 0.4, abs=1e-6)


def test_an_outer_loop_does_not_wind_up_while_the_pump_is_at_its_limit():
    """External reset: the outer integral goes to the flow that there is, not to what it asks."""
    scheme = resting_cascade()
    for _ in range(4000):
        output = scheme.moved(level_pv=4.0, flow_pv=12.0)
    assert output == 100.0
    # Without it the integral would have risen by 4/40 · 1 · 2000 = 200 l/s.
    assert scheme.state["level.integral"] == pytest.approx(12.0, abs=1e-6)
    # At the setpoint again it asks for the flow that there is.
    last = scheme.moved(level_pv=5.0)
    assert scheme.state["flow.working_setpoint"] == pytest.approx(12.0, abs=1e-6)
    assert last < 100.0


@pytest.mark.parametrize("mode", [0, 2])
@pytest.mark.parametrize("movement", [0.0, 0.1])
def test_by_hand_the_whole_cascade_follows(mode, movement):
    """The outer loop asks for the flow that there is; by hand it learns that a sample later, so
    that automatic begins with the inner gain on what the flow did in the sample before."""
    scheme = resting_cascade()
    for sample in range(50):
        flow = 8.0 + 0.1 * sample if sample < 49 else 8.0 + 4.8 + movement
        scheme.moved(
            level_pv=4.0, flow_pv=flow, pump_mode=mode, pump_manual=70.0, pump_tracking=70.0
        )
    assert scheme.moved(pump_mode=1) == pytest.approx(70.0 + 3.0 * movement, abs=BUMP)
    assert scheme.state["flow.working_setpoint"] == pytest.approx(12.8 + movement, abs=BUMP)


# --- override ---------------------------------------------------------------------------------

LOOPS = loop_settings("level", 10.0, 60.0) | loop_settings("flow", 2.0, 8.0)


def resting_override(selection="low", **changed):
    """Both loops at their setpoints, the pump at 50 %."""
    return Scans(
        override(selection), LOOPS | changed, level_sp=5.0, level_pv=5.0,
        flow_sp=8.0, flow_pv=8.0, pump_tracking=50.0, time_step=STEP,
    )  # fmt: skip


@pytest.mark.parametrize(("selection", "pick"), [("low", min), ("high", max)])
@pytest.mark.parametrize("level", [4.6, 5.0, 5.3])
@pytest.mark.parametrize("flow", [6.0, 8.0, 9.5])
def test_a_selector_takes_the_lowest_or_the_highest(selection, pick, level, flow):
    asked = 50.0 + 10.0 * (5.0 - level), 50.0 + 2.0 * (8.0 - flow)
    found = resting_override(selection).moved(level_pv=level, flow_pv=flow)
    assert found == pytest.approx(pick(asked), abs=BUMP)


@pytest.mark.parametrize(("selection", "side"), [("low", 1.0), ("high", -1.0)])
@pytest.mark.parametrize("tracking_time", [8.0, 4.0])
def test_a_loop_that_waits_stands_at_what_is_applied_and_its_error(selection, side, tracking_time):
    """External reset, Shinskey chapter 6: v = u + K e, for a tracking time of Ti; in general
    v − u goes to K e Tt/Ti with the ratio 1 − Δt/Tt."""
    scheme = resting_override(selection, flow_tracking_time=tracking_time)
    error = side * 2.0  # the flow loop asks for more than the level loop, or for less
    scheme.moved(flow_pv=8.0 - error)
    for samples in range(1, 60):
        integral, share = scheme.state["flow.integral"], STEP / tracking_time
        final = 50.0 - 2.0 * error + 2.0 * error * tracking_time / 8.0
        expected = final + (50.0 - final) * (1.0 - share) ** samples
        assert integral == pytest.approx(expected, abs=1e-9)
        assert scheme.moved() == 50.0  # the level loop rests at its setpoint
    for _ in range(400):
        scheme.moved()
    # So it takes over as soon as its error has changed its sign by a hair.
    output = scheme.moved(flow_pv=8.0 + 1e-3 * side)
    moved = 2.0 * error * (tracking_time / 8.0 - 1.0) - 2.0 * 1e-3 * side
    assert output - 50.0 == pytest.approx(side * min(side * moved, 0.0), abs=1e-6)


def test_the_loop_in_force_is_not_slowed_by_the_others():
    """The selected loop integrates as if it were alone."""
    scheme = resting_override()
    alone = one_loop(PidForm(), pid_settings(PidForm(), gain=10.0, integral_time=60.0))
    alone.set(level_1_tracking_time=60.0)
    for sample in range(100):
        level = 5.0 + 0.5 * math.sin(0.1 * sample) + 0.5
        found = scheme.moved(level_pv=level, flow_pv=2.0)
        assert found == pytest.approx(alone.moved(level_1_pv=level, time_step=STEP), abs=BUMP)


def test_a_loop_whose_sensor_fails_is_passed_over():
    scheme = resting_override()
    found = scheme.scan(level_pv=4.0, flow_pv=math.nan, flow_good=0.0)
    assert found["pump.out"] == pytest.approx(60.0, abs=BUMP)
    assert set(read_status(int(found["pump.status"]))) == {
        "automatic", "sensor_fault", "invalid_input"
    }  # fmt: skip
    # What it cannot compute it does not integrate either.
    integral = scheme.state["flow.integral"]
    for _ in range(5):
        last = scheme.moved()
    assert scheme.state["flow.integral"] == integral == 50.0
    assert scheme.moved(level_good=0.0) == last  # and with both the output is held


# --- split range ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "pump", "valve"),
    [(0, 100, 0), (10, 80, 0), (25, 50, 0), (50, 0, 0), (60, 0, 20), (75, 0, 50), (100, 0, 100)],
)
def test_a_split_range_by_hand(value, pump, valve):
    """0 … 50 % closes the pump, 50 … 100 % opens the valve."""
    scheme = Scans(
        split_range(), loop_settings("level", 10.0, 60.0), level_sp=5.0, level_pv=5.0,
        pump_tracking=100.0, valve_tracking=0.0, time_step=STEP,
    )  # fmt: skip
    # The pump wide open is 0 % of the range: an error of value/10 asks for value.
    found = scheme.scan(level_pv=5.0 - value / 10.0)
    assert found["pump.out"] == pytest.approx(pump, abs=BUMP)
    assert found["valve.out"] == pytest.approx(valve, abs=BUMP)


def test_the_limit_of_one_leg_stops_the_integral_of_the_loop():
    """The valve ends at 60 %, which is 84 % of the range: I goes to 84 + K e (Tt/Ti − 1)."""
    law = split_range((0.0, 40.0, 100.0, 0.0), (60.0, 100.0, 0.0, 100.0))
    scheme = Scans(
        law, loop_settings("level", 10.0, 30.0) | {"valve.high_limit": 60.0}, level_sp=5.0,
        level_pv=5.0, pump_tracking=50.0, valve_tracking=0.0, time_step=STEP,
    )  # fmt: skip
    for _ in range(3000):
        found = scheme.scan(level_pv=4.0)
    assert (found["pump.out"], found["valve.out"]) == (0.0, 60.0)
    assert scheme.state["level.integral"] == pytest.approx(84.0, abs=1e-6)
    # The error turns to −0.1: the valve leaves its limit by K e = 1 % of the range at once.
    found = scheme.scan(level_pv=5.1)
    assert found["valve.out"] == pytest.approx(60.0 - 1.0 / 40.0 * 100.0, abs=1e-5)


def test_a_gap_between_the_parts_is_crossed_at_the_speed_of_the_integral():
    """From 40 to 60 % nothing moves, and what is asked for is taken as applied."""
    law = split_range((0.0, 40.0, 100.0, 0.0), (60.0, 100.0, 0.0, 100.0))
    scheme = Scans(
        law, loop_settings("level", 10.0, 60.0), level_sp=5.0, level_pv=5.0,
        pump_tracking=50.0, valve_tracking=0.0, time_step=STEP,
    )  # fmt: skip
    rise = STEP * 10.0 / 60.0 * 1.0
    value = 20.0 + 10.0  # half the pump's part, and K e
    scheme.give({"level.pv": 4.0})
    for _ in range(1000):
        found = scheme.scan()
        pump = 100.0 * (1.0 - min(value / 40.0, 1.0))
        valve = 100.0 * min(max((value - 60.0) / 40.0, 0.0), 1.0)
        assert found["pump.out"] == pytest.approx(pump, abs=BUMP)
        assert found["valve.out"] == pytest.approx(valve, abs=BUMP)
        if value >= 99.0:
            break
        value += rise
    assert value >= 99.0


# --- feedforward ------------------------------------------------------------------------------

TERM = {"feed_to_pump.gain": -1.5, "feed_to_pump.reference": 4.0}


def resting_feedforward(law, feed=7.0, **changed):
    return Scans(
        law, loop_settings("level", 10.0, 60.0) | TERM | changed, level_sp=5.0, level_pv=5.0,
        feed_pv=feed, pump_tracking=50.0, time_step=STEP,
    )  # fmt: skip


def test_static_feedforward_adds_its_gain_times_the_deviation():
    scheme = resting_feedforward(feedforward(dynamic=False))
    assert scheme.moved() == pytest.approx(50.0, abs=BUMP)
    assert scheme.moved(feed_pv=9.0) == pytest.approx(50.0 - 1.5 * 2.0, abs=BUMP)
    assert scheme.moved(feed_pv=4.0) == pytest.approx(50.0 + 1.5 * 3.0, abs=BUMP)
    # The loop beside it rests: its integral holds what the reference does not explain.
    assert scheme.state["level.integral"] == pytest.approx(50.0 + 1.5 * 3.0, abs=BUMP)


@pytest.mark.parametrize(("lead", "lag"), [(20.0, 5.0), (0.0, 5.0), (2.0, 12.0), (3.0, 0.0)])
def test_dynamic_feedforward_is_the_sampled_lead_lag(lead, lag):
    """(1 + lead s)/(1 + lag s) by backward differences, s → (1 − 1/z)/Δt, through SciPy."""
    scheme = resting_feedforward(
        feedforward(), feed=4.0, feed_to_pump_lead=lead, feed_to_pump_lag=lag
    )
    feed = 4.0 + 2.0 * np.random.default_rng(3).normal(size=300)
    numerator, denominator = np.array([[STEP + time, -time] for time in (lead, lag)])
    expected = 50.0 - 1.5 * lfilter(numerator, denominator, feed - 4.0)
    assert np.all((expected > -1e4) & (expected < 1e4))
    scheme.set(pump_low_limit=-1e4, pump_high_limit=1e4)
    found = np.array([scheme.moved(feed_pv=value) for value in feed])
    assert found == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("dynamic", [False, True])
def test_a_feedforward_signal_that_fails_leaves_its_term_and_the_loop_goes_on(dynamic):
    scheme = resting_feedforward(feedforward(dynamic=dynamic), feed_to_pump_lag=2.0)
    for _ in range(100):
        scheme.moved(feed_pv=9.0)
    for wrong in ({"feed.pv": math.nan}, {"feed.pv": 0.0, "feed.good": 0.0}):
        found = scheme.scan(**wrong)
        assert found["pump.out"] == pytest.approx(47.0, abs=1e-9)
        told = "sensor_fault" in read_status(int(found["pump.status"]))
        assert told == ("feed.good" in wrong)
    assert scheme.moved(level_pv=4.9) == pytest.approx(48.0, abs=1e-9)


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e308, -1e308])
def test_a_reference_that_is_no_number_leaves_the_term_where_it_was(dynamic, wrong):
    scheme = resting_feedforward(feedforward(dynamic=dynamic), feed_to_pump_lag=2.0)
    for _ in range(100):
        scheme.moved(feed_pv=9.0)
    state = dict(scheme.state)
    scheme.set(feed_to_pump_reference=wrong)
    assert scheme.moved() == pytest.approx(47.0, abs=1e-9)
    assert scheme.state == pytest.approx(state, abs=1e-9)


def test_inverted_decoupling_adds_what_the_other_loop_moved_at_last():
    law = decoupled()
    values = loop_settings("level", 10.0, 1e9) | loop_settings("flow", 2.0, 1e9)
    values |= {
        "valve_to_pump.gain": -0.3, "valve_to_pump.reference": 40.0,
        "pump_to_valve.gain": 0.2, "pump_to_valve.reference": 50.0,
    }  # fmt: skip
    scheme = Scans(
        law, values, level_sp=5.0, level_pv=5.0, flow_sp=8.0, flow_pv=8.0,
        pump_tracking=50.0, valve_tracking=40.0, time_step=STEP,
    )  # fmt: skip
    first = 50.0, 40.0
    parts = 10.0 * 0.4, 2.0 * 1.0
    for _ in range(40):
        found = scheme.scan(level_pv=4.6, flow_pv=7.0)
        last = first
        first = (
            50.0 + parts[0] - 0.3 * (last[1] - 40.0),
            40.0 + parts[1] + 0.2 * (last[0] - 50.0),
        )
        assert found["pump.out"] == pytest.approx(first[0], abs=1e-5)
        assert found["valve.out"] == pytest.approx(first[1], abs=1e-5)
    # At rest it is the decoupler in one matrix: u = (1 − F)⁻¹ v.
    solved = np.linalg.solve([[1.0, 0.3], [-0.2, 1.0]], parts)
    assert np.array(first) - (50.0, 40.0) == pytest.approx(solved, abs=1e-9)


# --- ratio ------------------------------------------------------------------------------------


def test_a_ratio_follows_the_wild_signal():
    scheme = Scans(ratio(), {"proportion.ratio": 3.5}, feed_pv=10.0, pump_tracking=35.0)
    for feed, expected in ((10.0, 35.0), (4.0, 14.0), (0.0, 0.0), (20.0, 70.0)):
        assert scheme.moved(feed_pv=feed) == expected
    assert scheme.moved(feed_pv=math.nan) == 70.0
    assert scheme.moved(feed_pv=3.0, feed_good=0.0) == 70.0
    scheme.set(proportion_ratio=50.0)
    assert scheme.moved(feed_pv=3.0, feed_good=1.0) == 100.0


def test_a_loop_trims_a_ratio_between_its_ends():
    values = loop_settings("level", 1.5, 30.0) | {
        "proportion.lowest_ratio": 2.0,
        "proportion.highest_ratio": 6.0,
    }
    scheme = Scans(
        ratio(PidForm()), values, feed_pv=10.0, level_sp=5.0, level_pv=5.0,
        pump_tracking=40.0, time_step=STEP,
    )  # fmt: skip
    assert scheme.moved() == pytest.approx(40.0, abs=BUMP)
    assert scheme.moved(feed_pv=5.0) == pytest.approx(20.0, abs=BUMP)  # at once
    assert scheme.moved(level_pv=4.0) == pytest.approx(5.0 * (4.0 + 1.5), abs=BUMP)
    assert scheme.twin().moved(level_pv=0.0) == pytest.approx(5.0 * 6.0, abs=BUMP)
    assert scheme.twin().moved(level_pv=10.0) == pytest.approx(5.0 * 2.0, abs=BUMP)
    # At the end of the ratio the integral follows: K e Tt/Ti above it, no further.
    for _ in range(2000):
        scheme.moved(level_pv=1.0)
    assert scheme.state["level.integral"] == pytest.approx(6.0, abs=1e-6)


# --- what stands between does not disturb the integral ----------------------------------------

BETWEEN = {
    "feedforward": (
        lambda form: feedforward(form, dynamic=False),
        {"feed_to_pump.gain": 23.1, "feed_to_pump.reference": 0.1},
        {"feed.pv": 1.7},
        1.0,
    ),
    "split-range": (
        lambda form: split_range((0.0, 70.0, 7.0, 93.0), (70.0, 100.0, 0.0, 90.0), form),
        {},
        {"valve.tracking": 0.0},
        86.0 / 70.0,
    ),
    "trimmed-ratio": (ratio, {"proportion.highest_ratio": 100.0}, {"feed.pv": 3.3}, 3.3),
}


@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)
@pytest.mark.parametrize("between", BETWEEN)
def test_rounding_on_the_way_is_not_taken_for_a_limit(between, anti_windup):
    """The loop integrates at K/Ti · e as if it moved the output itself."""
    make, values, given, slope = BETWEEN[between]
    law = make(PidForm(anti_windup=anti_windup))
    scheme = Scans(
        law, loop_settings("level", 0.7, 60.0) | values, level_sp=5.0, level_pv=5.0, **given,
        pump_tracking=30.0, time_step=STEP,
    )  # fmt: skip
    scheme.give({"level.pv": 3.7})
    first = scheme.moved()
    for samples in range(1, 200):
        expected = first + slope * samples * STEP * 0.7 / 60.0 * 1.3
        assert scheme.moved() == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)
def test_an_outer_loop_is_not_reset_by_rounding_in_the_inner_one(anti_windup):
    scheme = resting_cascade(cascade(PidForm(anti_windup=anti_windup)))
    scheme.give({"level.pv": 4.93})
    working = []
    for _ in range(100):
        # The flow follows its setpoint, so that the inner loop stays within its limits.
        scheme.moved(flow_pv=scheme.state["flow.working_setpoint"])
        working.append(scheme.state["flow.working_setpoint"])
    slope = STEP * 4.0 / 40.0 * 0.07
    assert np.diff(working) == pytest.approx(slope, abs=1e-12)
