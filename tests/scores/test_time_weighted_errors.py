"""ITAE, ITSE, IE and ISEG against closed forms, and their symmetries."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from clepsydra import InputError
from clepsydra.scores.generalised_squared_error import generalised_squared_error
from clepsydra.scores.integral_errors import (
    integral_absolute_error,
    integral_error,
    integral_squared_error,
)
from clepsydra.scores.time_weighted_errors import (
    integral_time_absolute_error,
    integral_time_squared_error,
)

T = 60.0
STEP = 2.5


def first_order(period: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    time = np.arange(0.0, 40 * T + period / 2, period)
    return time, np.full_like(time, STEP), STEP * (1.0 - np.exp(-time / T))


def test_first_order_step() -> None:
    """∫ t e^(-t/T) = T², ∫ t e^(-2t/T) = T²/4, ∫ e^(-t/T) = T."""
    run = first_order(0.1)
    assert integral_time_absolute_error(*run) == pytest.approx(STEP * T**2, rel=1e-6)
    assert integral_time_squared_error(*run) == pytest.approx(STEP**2 * T**2 / 4, rel=1e-6)
    assert integral_error(*run) == pytest.approx(STEP * T, rel=1e-6)


def test_generalised_error_of_an_exponential() -> None:
    """∫ e² + a ė² = S² (T/2 + a/(2 T)); the two parts are told apart by their weights."""
    run = first_order(0.05)
    for weight in (0.0, 0.5, 400.0):
        exact = STEP**2 * (T / 2 + weight / (2 * T))
        assert generalised_squared_error(*run, weight) == pytest.approx(exact, rel=1e-6), weight
    assert generalised_squared_error(*run) == generalised_squared_error(*run, 0.5)


@pytest.mark.parametrize("period", [0.1, 0.01])
def test_a_setpoint_step_counts_in_the_generalised_error_as_in_the_document(period: float) -> None:
    """At rest, and then off by a step for two samples of straight return: a S²/Δt and a S²/(2Δt).

    The first is the part that does not depend on the controller.
    """
    time = period * np.arange(4)
    setpoint, output = np.array([0.0, STEP, STEP, STEP]), np.array([0.0, 0.0, STEP / 2, STEP])
    error_squared = integral_squared_error(time, setpoint, output)
    rate_part = 0.5 * (STEP**2 / period + 2 * (STEP / 2) ** 2 / period)
    assert generalised_squared_error(time, setpoint, output) == pytest.approx(
        error_squared + rate_part, rel=1e-12
    )


def test_a_sine_cancels_in_the_integral_of_the_error_and_not_in_its_magnitude() -> None:
    time = np.linspace(0.0, 10.0, 10001)
    output = np.sin(2 * np.pi * time / 2.0)
    assert integral_error(time, 0 * time, output) == pytest.approx(0.0, abs=1e-12)
    assert integral_absolute_error(time, 0 * time, output) == pytest.approx(
        10.0 * 2 / np.pi, rel=1e-6
    )


def test_straight_lines_are_weighted_exactly_however_coarse_the_samples() -> None:
    """e = 3 - t on [0, 4]: the polynomials t |e| and t e² integrated by hand."""
    absolute = (3 * 9 / 2 - 27 / 3) + ((64 / 3 - 3 * 16 / 2) - (27 / 3 - 3 * 9 / 2))
    squared = 9 * 16 / 2 - 6 * 64 / 3 + 256 / 4
    for time in ([0.0, 4.0], [0.0, 1.3, 2.9, 4.0], np.linspace(0.0, 4.0, 9)):
        run = (time, np.full(len(time), 3.0), time)
        assert integral_time_absolute_error(*run) == pytest.approx(absolute, rel=1e-13), time
        assert integral_time_squared_error(*run) == pytest.approx(squared, rel=1e-13), time


def test_time_counts_from_the_last_step() -> None:
    """Twice the same response costs twice, wherever in the run it stands."""
    time, setpoint, output = first_order(1.0)
    once = [
        score(time, setpoint, output)
        for score in (integral_time_absolute_error, integral_time_squared_error)
    ]
    later = np.concatenate([time, time[-1] + 1.0 + time])
    twice = (later, np.tile(setpoint, 2), np.tile(output, 2))
    # The sample between the two holds no error at its start, and the line to the second start
    # jumps: the setpoint steps there too.
    jump = later.size // 2
    twice[1][:jump] -= STEP
    twice[2][:jump] -= STEP
    for score, value in zip(
        (integral_time_absolute_error, integral_time_squared_error), once, strict=True
    ):
        starts = [later[jump]]
        assert score(*twice, starts) == pytest.approx(2 * value, rel=1e-9), score.__name__
        assert score(*twice) > 10 * value, score.__name__
        # A step that rounding put just behind its sample is that sample's.
        rounded = score(*twice, [later[jump] * (1 + 1e-12)])
        assert rounded == pytest.approx(2 * value, rel=1e-9), score.__name__
        assert score(*twice, [-5.0, later[jump], 0.0]) == score(*twice, starts), score.__name__


def test_a_value_that_is_not_finite_makes_the_score_infinite() -> None:
    for score in (
        integral_error,
        integral_time_absolute_error,
        integral_time_squared_error,
        generalised_squared_error,
    ):
        for bad in (math.nan, math.inf, -math.inf):
            assert score([0, 1, 2], [1, 1, 1], [0, bad, 1]) == math.inf, (score.__name__, bad)


def test_unusable_requests_are_refused() -> None:
    with pytest.raises(InputError, match="steps: got"):
        integral_time_absolute_error([0, 1], [1, 1], [0, 0], [math.nan])
    for weight in (-1.0, math.nan):
        with pytest.raises(InputError, match="weight: got"):
            generalised_squared_error([0, 1], [1, 1], [0, 0], weight)


values = st.floats(-1e3, 1e3)
trajectory = arrays(np.float64, 12, elements=values)
clock = arrays(np.float64, 12, elements=st.floats(0.01, 100.0)).map(np.cumsum)


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory, st.floats(0.01, 100.0), st.floats(0.01, 100.0))
def test_integrals_scale_with_the_units_of_signal_and_time(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray, unit: float, minute: float
) -> None:
    steps = [time[4], time[7]]
    for signal_power, time_power, score, more in (
        (1, 1, integral_error, ()),
        (1, 2, integral_time_absolute_error, (steps,)),
        (2, 2, integral_time_squared_error, (steps,)),
        (2, 1, generalised_squared_error, (0.0,)),
    ):
        scaled = (tuple(minute * np.array(s) for s in more[0]),) if more == (steps,) else more
        assert score(minute * time, unit * setpoint, unit * output, *scaled) == pytest.approx(
            minute**time_power * unit**signal_power * score(time, setpoint, output, *more),
            rel=1e-9,
            abs=1e-6,
        ), score.__name__


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_up_and_down_cost_the_same(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    for score in (
        integral_time_absolute_error,
        integral_time_squared_error,
        generalised_squared_error,
    ):
        assert score(time, -setpoint, -output) == score(time, setpoint, output), score.__name__
    assert integral_error(time, -setpoint, -output) == -integral_error(time, setpoint, output)


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_the_magnitude_of_the_integral_is_at_most_the_integral_of_the_magnitude(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    magnitude = integral_absolute_error(time, setpoint, output)
    assert abs(integral_error(time, setpoint, output)) <= magnitude * (1 + 1e-9)
    assert integral_time_absolute_error(time, setpoint, output) <= magnitude * (
        time[-1] - time[0]
    ) * (1 + 1e-9)
