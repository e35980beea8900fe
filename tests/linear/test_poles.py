"""Poles and time constants."""

from __future__ import annotations

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.poles import integrators, poles, rightmost_first, time_constants


def model_of(A):
    n = len(A)
    empty = np.zeros((n, 0))
    states = tuple(f"x{i}" for i in range(n))
    return LinearModel(A, empty, empty, empty.T, np.zeros((0, 0)), states, (), (), ())


def test_time_constants_of_the_quadruple_tank(johansson):
    model = linearise(find_equilibrium(johansson.process))
    expected = johansson.time_constants(johansson.levels(johansson.voltage))
    slowest_first = np.sort(expected)[::-1]
    np.testing.assert_allclose(time_constants(model), slowest_first, rtol=1e-9)
    np.testing.assert_allclose(poles(model), -1 / slowest_first, rtol=1e-9)


def test_equal_tanks_in_series_keep_their_time_constant():
    # A triple pole: a general eigenvalue routine would scatter it by the cube root of rounding.
    A = -0.02 * np.eye(3) + 0.02 * np.diag([1.0, 1.0], -1)
    np.testing.assert_allclose(time_constants(model_of(A)), 50.0, rtol=1e-12)


def test_complex_integrating_and_unstable_poles():
    A = np.zeros((4, 4))
    A[:2, :2] = [[-0.1, 2.0], [-2.0, -0.1]]
    A[2, 2] = 0.25
    model = model_of(A)
    np.testing.assert_allclose(poles(model), [0.25, 0, -0.1 + 2j, -0.1 - 2j], atol=1e-15)
    np.testing.assert_allclose(time_constants(model), [-4, np.inf, 10, 10], rtol=1e-13)


@pytest.mark.parametrize("seed", range(5))
def test_integrators_in_series_stand_at_zero_in_any_basis(seed):
    A = np.diag([1.0, 1.0, 0.0], -1) + np.diag([0.0, 0.0, 0.0, -2.0])
    T = np.linalg.qr(np.random.default_rng(seed).standard_normal((4, 4)))[0] @ np.diag([1, 2, 3, 4])
    A = T @ A @ np.linalg.inv(T)
    assert np.sort(np.abs(np.linalg.eigvals(A)))[2] > 1e-6  # what rounding makes of them
    assert integrators(A) == 3
    np.testing.assert_array_equal(poles(model_of(A))[:3], 0.0)
    np.testing.assert_array_equal(time_constants(model_of(A))[:3], np.inf)


def test_integrators_are_counted_in_any_unit_of_time():
    A = np.array([[0.0, 0.0], [1.0, -1.0]])
    assert [integrators(scale * A) for scale in (1e-9, 1.0, 1e9)] == [1, 1, 1]
    assert integrators(np.diag([-1e-9, -1.0])) == 0


def test_order():
    roots = [-1, 2, -1 - 1j, -1 + 1j]
    np.testing.assert_array_equal(rightmost_first(roots), [2, -1 + 1j, -1, -1 - 1j])
