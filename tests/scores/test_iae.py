"""IAE and ISE against closed forms, and their symmetries."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from clepsydra.scores.iae import IAE, ISE

TIME_CONSTANT = 60.0
STEP = 2.5


def first_order(period: float, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    time = np.arange(0.0, length + period / 2, period)
    output = STEP * (1.0 - np.exp(-time / TIME_CONSTANT))
    return time, np.full_like(time, STEP), output


def test_first_order_step_costs_its_time_constant_times_its_size() -> None:
    time, setpoint, output = first_order(period=0.1, length=40 * TIME_CONSTANT)
    # The line between the samples lies above the exponential by a share of (period/T)²/12.
    assert IAE.along(time, setpoint, output) == pytest.approx(TIME_CONSTANT * STEP, rel=3e-7)
    assert ISE.along(time, setpoint, output) == pytest.approx(TIME_CONSTANT * STEP**2 / 2, rel=1e-6)


def test_error_of_the_rule_falls_with_the_square_of_the_period() -> None:
    errors = []
    for period in (4.0, 2.0, 1.0):
        time, setpoint, output = first_order(period, length=40 * TIME_CONSTANT)
        errors.append(IAE.along(time, setpoint, output) / (TIME_CONSTANT * STEP) - 1.0)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.01)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.01)


def test_straight_lines_are_integrated_exactly_however_coarse_the_samples() -> None:
    # e(t) = 3 - t on [0, 4]: |e| encloses two triangles, 9/2 + 1/2; e² gives (3³ + 1³)/3.
    for time in ([0.0, 4.0], [0.0, 1.3, 2.9, 4.0], np.linspace(0.0, 4.0, 9)):
        setpoint = np.full(len(time), 3.0)
        assert IAE.along(time, setpoint, time) == pytest.approx(5.0, rel=1e-14), time
        assert ISE.along(time, setpoint, time) == pytest.approx(28 / 3, rel=1e-14), time


def test_a_setpoint_step_does_not_cost_the_sample_before_it() -> None:
    # The output follows in the sample after the step, on a line: one triangle of 2 s × 5 / 2.
    time = [0.0, 2.0, 4.0, 6.0]
    assert IAE.along(time, [0, 5, 5, 5], [0, 0, 5, 5]) == 5.0


def test_a_value_that_is_not_finite_makes_the_score_infinite() -> None:
    for bad in (math.nan, math.inf, -math.inf):
        assert IAE.along([0, 1, 2], [1, 1, 1], [0, bad, 1]) == math.inf, bad
        assert ISE.along([0, 1, 2], [1, 1, bad], [0, 0, 1]) == math.inf, bad


values = st.floats(-1e3, 1e3)
trajectory = arrays(np.float64, 12, elements=values)
clock = arrays(np.float64, 12, elements=st.floats(0.01, 100.0)).map(np.cumsum)


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory, st.floats(-1e3, 1e3))
def test_integrals_do_not_depend_on_when_the_run_began(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray, shift: float
) -> None:
    for score in (IAE, ISE):
        assert score.along(time + shift, setpoint, output) == pytest.approx(
            score.along(time, setpoint, output), rel=1e-9
        ), score.key


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_up_and_down_cost_the_same(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    for score in (IAE, ISE):
        up, down = (score.along(time, s * setpoint, s * output) for s in (1.0, -1.0))
        assert up == down, score.key


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory, st.floats(0.01, 100.0), st.floats(0.01, 100.0))
def test_integrals_scale_with_the_units(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray, unit: float, minute: float
) -> None:
    for score in (IAE, ISE):
        assert score.along(minute * time, unit * setpoint, unit * output) == pytest.approx(
            unit ** score.powers[0] * minute * score.along(time, setpoint, output), rel=1e-9
        ), score.key


@settings(max_examples=25, deadline=None)
@given(clock, trajectory, trajectory)
def test_the_mean_square_is_at_least_the_square_of_the_mean(
    time: np.ndarray, setpoint: np.ndarray, output: np.ndarray
) -> None:
    duration = time[-1] - time[0]
    mean = IAE.along(time, setpoint, output) / duration
    mean_square = ISE.along(time, setpoint, output) / duration
    assert mean_square >= mean**2 * (1 - 1e-12)
