"""Step responses, against closed forms and a second integrator."""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from models_by_hand import (
    feedback,
    lag,
    late_feedback,
    pi,
    pure_delay,
    rational,
    series,
    static,
)
from refusals import refused

from clepsydra.linear.dead_time import without_dead_time
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.step_response import step_response


def test_rational_against_python_control(random_system):
    system = random_system(1, 5, 2, 3, direct=True)
    model = rational(system.A, system.B, system.C, system.D)
    times = np.linspace(0.0, 5.0, 101)
    _, theirs = control.step_response(model.to_control(), times)
    np.testing.assert_allclose(
        step_response(model, times), np.moveaxis(theirs, 2, 0), rtol=1e-9, atol=1e-11
    )


def test_uneven_times_and_two_at_once():
    found = step_response(lag(2.0, 5.0), [0.0, 0.1, 0.1, 3.7, 40.0])[:, 0, 0]
    expected = 2 * (1 - np.exp(-np.array([0.0, 0.1, 0.1, 3.7, 40.0]) / 5))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_late_feedback_by_the_method_of_steps():
    """h(t) of 1/(s + k e^{-sτ}): Σ (-k)^i (t - iτ)^{i+1}/(i+1)! over t > iτ."""
    k, tau = 1.2, 0.7
    times = np.linspace(0.0, 9.0, 181)
    expected = np.zeros_like(times)
    for i in range(14):
        late = np.maximum(times - i * tau, 0.0)
        expected += (-k) ** i * late ** (i + 1) / math.factorial(i + 1)
    found = step_response(late_feedback(k, tau), times)[:, 0, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


def test_a_pure_dead_time_jumps_where_it_should():
    found = step_response(pure_delay(2.0), [0.0, 1.9999, 2.0, 2.5])[:, 0, 0]
    np.testing.assert_allclose(found, [0.0, 0.0, 1.0, 1.0], atol=1e-12)


def test_a_difference_equation_is_a_staircase():
    """y(t) = Σ (-1)^{i+1} k^i over the dead times that have passed."""
    times = np.array([0.5, 1.5, 2.5, 3.5])
    closed = feedback(series(static(0.5), pure_delay(1.0)))
    np.testing.assert_allclose(
        step_response(closed, times)[:, 0, 0], [0.0, 0.5, 0.25, 0.375], atol=1e-12
    )


def test_a_loop_settles_at_its_static_gain_and_agrees_with_pade():
    plant = series(lag(2.0, 5.0), pure_delay(1.0))
    closed = feedback(series(pi(1.0, 5.0), plant))
    times = np.array([0.0, 1.0, 2.0, 3.0, 6.0, 10.0, 200.0])
    found = step_response(closed, times)[:, 0, 0]
    np.testing.assert_allclose(found[:2], 0.0, atol=1e-13)
    assert found[-1] == pytest.approx(static_gain(closed)[0, 0], rel=1e-9)
    approximate = step_response(without_dead_time(closed, 10), times)[:, 0, 0]
    np.testing.assert_allclose(found[2:], approximate[2:], atol=2e-3)
    # Until 2 s the loop is as if open, and L = 0.4 e^{-s}/s is a late ramp.
    assert found[2] == pytest.approx(0.4 * 1.0, rel=1e-11)


def test_two_dead_times_with_a_common_measure():
    """e^{-0.3s} and e^{-0.5s} into one tank: the sum of two late ramps."""
    tank = rational(0.0, [[1.0, 2.0]], 1.0, [[0.0, 0.0]])
    times = np.array([0.2, 0.4, 1.0])
    found = step_response(series(pure_delay(0.3, 0.5), tank), times)[:, 0]
    np.testing.assert_allclose(found[:, 0], np.maximum(times - 0.3, 0), atol=1e-12)
    np.testing.assert_allclose(found[:, 1], 2 * np.maximum(times - 0.5, 0), atol=1e-12)


def test_units_of_the_states_do_not_matter():
    base = feedback(series(lag(1.0, 3.0), series(lag(1.0, 2.0), pure_delay(1.0))))
    sizes = np.array([1.0, 1e6])
    late = base.delays
    other = replace(
        base, A=base.A * sizes / sizes[:, None], B=base.B / sizes[:, None], C=base.C * sizes,
        delays=replace(late, to_states=late.to_states / sizes[:, None],
                       from_states=late.from_states * sizes),
    )  # fmt: skip
    times = np.linspace(0, 20, 11)
    np.testing.assert_allclose(
        step_response(other, times), step_response(base, times), rtol=1e-9, atol=1e-11
    )


def test_what_is_refused():
    with refused(expected="not falling"):
        step_response(lag(1.0, 1.0), [1.0, 0.5])
    with refused(expected="not falling"):
        step_response(lag(1.0, 1.0), [-1.0])
    with refused(expected="common measure"):
        step_response(pure_delay(1.0, math.sqrt(2.0)), [3.0])
    with refused(expected="common measure longer than"):
        step_response(pure_delay(1e-4), [100.0])
