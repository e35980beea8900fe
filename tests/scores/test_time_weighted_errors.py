"""ITAE, ITSE, IE and ISEG against closed forms, and their symmetries."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from clepsydra.scores.iae import IAE, ISE, ISEG, ITAE, ITSE, SIGNED_ERROR

T = 60.0
STEP = 2.5


def first_order(period: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    time = np.arange(0.0, 40 * T + period / 2, period)
    return time, np.full_like(time, STEP), STEP * (1.0 - np.exp(-time / T))


def test_first_order_step() -> None:
    """∫ t e^(-t/T) = T², ∫ t e^(-2t/T) = T²/4, ∫ e^(-t/T) = T."""
    run = first_order(0.1)
    assert ITAE.along(*run) == pytest.approx(STEP * T**2, rel=1e-6)
    assert ITSE.along(*run) == pytest.approx(STEP**2 * T**2 / 4, rel=1e-6)
    assert SIGNED_ERROR.along(*run) == pytest.approx(STEP * T, rel=1e-6)


def test_generalised_error_of_an_exponential() -> None:
    """∫ e² + 0.5 ė² = S² (T/2 + 0.5/(2 T)); the two parts are told apart."""
    run = first_order(0.05)
    assert ISE.along(*run) == pytest.approx(STEP**2 * T / 2, rel=1e-6)
    rate = ISEG.along(*run) - ISE.along(*run)
    assert rate == pytest.approx(0.5 * STEP**2 / (2 * T), rel=1e-6)


@pytest.mark.parametrize("period", [0.1, 0.01])
def test_a_setpoint_step_counts_in_the_generalised_error_as_in_the_document(period: float) -> None:
    """At rest, and then off by a step for two samples of straight return: a S²/Δt and a S²/(2Δt).

    The first is the part that does not depend on the controller.
    """
    time = period * np.arange(4)
    setpoint, output = np.array([0.0, STEP, STEP, STEP]), np.array([0.0, 0.0, STEP / 2, STEP])
    error_squared = ISE.along(time, setpoint, output)
    rate_part = 0.5 * (STEP**2 / period + 2 * (STEP / 2) ** 2 / period)
    assert ISEG.along(time, setpoint, output) == pytest.approx(error_squared + rate_part, rel=1e-12)


def test_a_sine_cancels_in_the_integral_of_the_error_and_not_in_its_magnitude() -> None:
    time = np.linspace(0.0, 10.0, 10001)
    output = np.sin(2 * np.pi * time / 2.0)
    assert SIGNED_ERROR.along(time, 0 * time, output) == pytest.approx(0.0, abs=1e-12)
    assert IAE.along(time, 0 * time, output) == pytest.approx(10.0 * 2 / np.pi, rel=1e-6)


def test_straight_lines_are_weighted_exactly_however_coarse_the_samples() -> None:
    """e = 3 - t on [0, 4]: the polynomials t |e| and t e² integrated by hand."""
    absolute = (3 * 9 / 2 - 27 / 3) + ((64 / 3 - 3 * 16 / 2) - (27 / 3 - 3 * 9 / 2))
    squared = 9 * 16 / 2 - 6 * 64 / 3 + 256 / 4
    for time in ([0.0, 4.0], [0.0, 1.3, 2.9, 4.0], np.linspace(0.0, 4.0, 9)):
        run = (time, np.full(len(time), 3.0), time)
        assert ITAE.along(*run) == pytest.approx(absolute, rel=1e-13), time
        assert ITSE.along(*run) == pytest.approx(squared, rel=1e-13), time


def test_time_counts_from_the_last_step() -> None:
    """Twice the same response costs twice, wherever in the run it stands."""
    time, setpoint, output = first_order(1.0)
    once = [score.along(time, setpoint, output) for score in (ITAE, ITSE)]
    later = np.concatenate([time, time[-1] + 1.0 + time])
    twice = (later, np.tile(setpoint, 2), np.tile(output, 2))
    # The sample between the two holds no error at its start, and the line to the second start
    # jumps: the setpoint steps there too.
    jump = later.size // 2
    twice[1][:jump] -= STEP
    twice[2][:jump] -= STEP
    for score, value in zip((ITAE, ITSE), once, strict=True):
        starts = [later[jump]]
        assert score.along(*twice, steps=starts) == pytest.approx(2 * value, rel=1e-9), score.key
        assert score.along(*twice) > 10 * value, score.key
        once_more = score.along(*twice, steps=starts)
        # A step that rounding put just behind its sample is that sample's.
        rounded = score.along(*twice, steps=[later[jump] * (1 + 1e-12)])
        assert rounded == pytest.approx(2 * value, rel=1e-9), score.key
        assert score.along(*twice, steps=[-5.0, later[jump], 0.0]) == once_more, score.key


def test_a_value_that_is_not_finite_makes_the_score_infinite() -> None:
    for score in (
        SIGNED_ERROR,
        ITAE,
        ITSE,
        ISEG,
    ):
        for bad in (math.nan, math.inf, -math.inf):
            assert score.along([0, 1, 2], [1, 1, 1], [0, bad, 1]) == math.inf, (score.key, bad)


values = st.floats(-1e3, 1e3)
trajectory = arrays(np.float64, 12, elements=values)
clock = arrays(np.float64, 12, elements=st.floats(0.01, 100.0)).map(np.cumsum)


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory, st.floats(0.01, 100.0), st.floats(0.01, 100.0))
def test_integrals_scale_with_the_units_of_signal_and_time(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray, unit: float, minute: float
) -> None:
    steps = [time[4], time[7]]
    later = [minute * step for step in steps]
    for score in (SIGNED_ERROR, ISE, ITAE, ITSE):
        scaled = score.along(minute * time, unit * setpoint, unit * output, steps=later)
        one = score.along(time, setpoint, output, steps=steps)
        expected = unit ** score.powers[0] * minute ** score.powers[1] * one
        assert scaled == pytest.approx(expected, rel=1e-9, abs=1e-6), score.key


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_up_and_down_cost_the_same(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    for score in (ITAE, ITSE, ISEG):
        up, down = score.along(time, setpoint, output), score.along(time, -setpoint, -output)
        assert up == down, score.key
    up, down = (SIGNED_ERROR.along(time, s * setpoint, s * output) for s in (1.0, -1.0))
    assert up == -down


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_the_magnitude_of_the_integral_is_at_most_the_integral_of_the_magnitude(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    magnitude = IAE.along(time, setpoint, output)
    assert abs(SIGNED_ERROR.along(time, setpoint, output)) <= magnitude * (1 + 1e-9)
    assert ITAE.along(time, setpoint, output) <= magnitude * (time[-1] - time[0]) * (1 + 1e-9)
