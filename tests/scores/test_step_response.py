"""Overshoot, rise and settling against the closed forms of first and second order."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clepsydra import InputError
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment
from clepsydra.scores.step_response import (
    overshoot,
    overshoots,
    rise_time,
    rise_times,
    settling_time,
    settling_times,
)

TIME_CONSTANT = 40.0
PERIOD = 0.05
TIME = np.arange(0.0, 20 * TIME_CONSTANT, PERIOD)
FIRST_ORDER = 1.0 - np.exp(-TIME / TIME_CONSTANT)
#: The line between samples misses the exponential's crossing by at most period²/(8 T).
BETWEEN_SAMPLES = PERIOD**2 / (8 * TIME_CONSTANT)


def second_order(damping: float, time: np.ndarray, frequency: float = 0.1) -> np.ndarray:
    """Return the unit step response of ω²/(s² + 2 ζ ω s + ω²)."""
    damped = frequency * math.sqrt(1.0 - damping**2)
    return 1.0 - np.exp(-damping * frequency * time) * (
        np.cos(damped * time) + damping * frequency / damped * np.sin(damped * time)
    )


@pytest.mark.parametrize(("start", "target"), [(0.0, 1.0), (6.0, 8.5), (8.5, 6.0), (-1.0, -4.0)])
def test_first_order_up_and_down(start: float, target: float) -> None:
    output = start + (target - start) * FIRST_ORDER
    assert overshoot(TIME, output, start, target) == 0.0
    for seen, exact in (
        (rise_time(TIME, output, start, target), TIME_CONSTANT * math.log(9.0)),
        (settling_time(TIME, output, start, target), TIME_CONSTANT * math.log(20.0)),
        (settling_time(TIME, output, start, target, band=0.02), TIME_CONSTANT * math.log(50.0)),
    ):
        assert seen == pytest.approx(exact, abs=2 * BETWEEN_SAMPLES), exact


@pytest.mark.parametrize("damping", [0.1, 0.2, 0.456, 0.7, 0.9])
def test_second_order_overshoot(damping: float) -> None:
    time = np.arange(0.0, 200.0, 0.01)
    exact = 100.0 * math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    # Near its top the response is a parabola: half a period off costs less than ω² period²/8.
    assert overshoot(time, second_order(damping, time), 0.0, 1.0) == pytest.approx(
        exact, abs=100.0 * (0.1 * 0.01) ** 2 / 8
    )


@pytest.mark.parametrize(("start", "target"), [(0.0, 1.0), (8.5, 6.0)])
def test_outputs_side_by_side_are_scored_as_alone(start: float, target: float) -> None:
    time = np.arange(0.0, 120.0, 0.05)
    relative = [second_order(damping, time) for damping in (0.1, 0.3, 0.6, 0.9)]
    # One stops short, one stands at its target from the start, and one breaks off.
    relative += [0.5 * relative[0], np.ones_like(time), np.where(time < 60.0, relative[0], np.nan)]
    outputs = start + (target - start) * np.array(relative)
    for several, alone in (
        (overshoots, overshoot), (rise_times, rise_time), (settling_times, settling_time)
    ):  # fmt: skip
        found = several(time, outputs, start, target)
        assert found.tolist() == [alone(time, output, start, target) for output in outputs]
        assert len(set(found.tolist())) >= 5
        assert found[-1] == math.inf


def test_settling_is_the_last_entry_into_the_band_not_the_first() -> None:
    damping, frequency = 0.2, 0.1
    time = np.arange(0.0, 400.0, 0.01)
    response = second_order(damping, time, frequency)
    found = settling_time(time, response, 0.0, 1.0)
    at_entry = second_order(damping, np.array([found]), frequency)[0]
    assert abs(at_entry - 1.0) == pytest.approx(0.05, abs=1e-7)
    assert np.all(np.abs(response[time > found] - 1.0) <= 0.05)
    # The fourth extremum, at 4π/ω_d, is the last that leaves the band: e^(-4 π ζ/√…) > 5 %.
    damped = frequency * math.sqrt(1.0 - damping**2)
    assert 4 * math.pi / damped < found < 5 * math.pi / damped


def test_a_ramp_rises_in_eight_tenths_of_its_length() -> None:
    time, output = np.array([3.0, 7.0, 11.0]), np.array([20.0, 10.0, 10.0])
    assert rise_time(time, output, 20.0, 10.0) == pytest.approx(0.8 * 4.0, rel=1e-14)
    assert settling_time(time, output, 20.0, 10.0) == pytest.approx(0.95 * 4, rel=1e-14)


def test_inverse_response_counts_from_the_first_ten_percent() -> None:
    time = np.array([0.0, 1.0, 2.0])
    assert rise_time(time, np.array([0.0, -1.0, 1.0]), 0.0, 1.0) == pytest.approx(0.4, rel=1e-14)


def test_what_lies_before_the_step_does_not_count() -> None:
    before = np.array([9.0, -9.0])
    time = np.concatenate([[-2.0, -1.0], TIME])
    output = np.concatenate([before, FIRST_ORDER])
    segment = Segment("setpoint", "y", 0.0, float(TIME[-1]), 1.0)
    setpoint = np.where(time < 0.0, 0.0, 1.0)
    found = score_run(ScoredRun(time, {"y": setpoint}, {"y": output}, {}, {}, [segment]))
    for score in (overshoot, rise_time, settling_time):
        own = score(TIME, FIRST_ORDER, 0.0, 1.0)
        assert found[f"{score.__name__}[y]"] == own, score.__name__
    assert overshoot(time, output, 0.0, 1.0) == 800.0


def test_what_is_never_reached_takes_for_ever() -> None:
    short = 0.8 * FIRST_ORDER
    assert rise_time(TIME, short, 0.0, 1.0) == math.inf
    assert settling_time(TIME, short, 0.0, 1.0) == math.inf
    assert overshoot(TIME, short, 0.0, 1.0) == 0.0
    offset = 0.94 * FIRST_ORDER
    assert math.isfinite(rise_time(TIME, offset, 0.0, 1.0))
    assert settling_time(TIME, offset, 0.0, 1.0) == math.inf


def test_an_output_at_its_target_from_the_start_takes_no_time() -> None:
    there = np.ones(3)
    assert rise_time([0, 1, 2], there, 0.0, 1.0) == 0.0
    assert settling_time([0, 1, 2], there, 0.0, 1.0) == 0.0


def test_a_run_that_broke_off_is_infinitely_bad() -> None:
    output = np.array([0.0, 1.0, math.nan])
    for score in (overshoot, rise_time, settling_time):
        assert score([0, 1, 2], output, 0.0, 1.0) == math.inf, score.__name__


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"target": 0.0}, "setpoint step: got 'from 0.0 to 0.0', expected a step from one"),
        ({"target": math.nan}, "setpoint step: got 'from 0.0 to nan'"),
    ],
)
def test_unusable_requests_are_refused(change: dict[str, float], message: str) -> None:
    request = {"start": 0.0, "target": 1.0, "band": 0.05} | change
    with pytest.raises(InputError) as refusal:
        settling_time([0.0, 1.0, 2.0], [0.0, 1.0, 1.0], **request)
    assert str(refusal.value).startswith(message)


@settings(max_examples=25, deadline=None)
@given(
    damping=st.floats(0.05, 0.95),
    start=st.floats(-100.0, 100.0),
    size=st.floats(0.1, 100.0),
    shift=st.floats(-1e3, 1e3),
)
def test_scores_do_not_depend_on_sign_place_size_and_hour(
    damping: float, start: float, size: float, shift: float
) -> None:
    time = np.arange(0.0, 600.0, 1.0)
    response = second_order(damping, time)
    for score in (overshoot, rise_time, settling_time):
        up = score(time, response, 0.0, 1.0)
        for step in (size, -size):
            moved = score(time + shift, start + step * response, start, start + step)
            assert moved == pytest.approx(up, rel=1e-6, abs=1e-6), (score.__name__, step)


def test_an_output_that_is_shorter_than_the_time_has_no_overshoot() -> None:
    with pytest.raises(InputError, match="3 times and 2 values"):
        overshoot([0.0, 1.0, 2.0], [0.0, 1.0], start=0.0, target=1.0)
