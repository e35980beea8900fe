"""Static gains, finite and infinite."""

from __future__ import annotations

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.static_gain import static_gain


def model_of(A, B, C):
    names = [tuple(f"{kind}{i}" for i in range(size)) for kind, size in
             (("x", len(A)), ("u", B.shape[1]), ("y", len(C)))]  # fmt: skip
    D = np.zeros((len(C), B.shape[1]))
    return LinearModel(A, B, np.zeros((len(A), 0)), C, D, names[0], names[1], (), names[2])


def test_quadruple_tank_equals_the_closed_form(johansson):
    model = linearise(find_equilibrium(johansson.process))
    t1, t2, _, _ = johansson.time_constants(johansson.levels(johansson.voltage))
    (g1, g2), (k1, k2), (a1, a2, _, _) = johansson.gamma, johansson.gain, johansson.area
    first = 50 * t1 / a1 * np.array([g1 * k1, (1 - g2) * k2])
    second = 50 * t2 / a2 * np.array([(1 - g1) * k1, g2 * k2])
    gain = static_gain(model.select(outputs=["level_1", "level_2"]))
    np.testing.assert_allclose(gain, [first, second], rtol=1e-9)


def test_gain_equals_the_change_of_the_equilibrium(minimum):
    # Levels go with the square of the flow, so the differences are exact up to rounding.
    model = linearise(find_equilibrium(minimum.process))
    step = 0.01
    for column in range(2):
        ahead, behind = [3.0, 3.0], [3.0, 3.0]
        ahead[column] += step
        behind[column] -= step
        slope = 50 * (minimum.levels(tuple(ahead)) - minimum.levels(tuple(behind))) / (2 * step)
        np.testing.assert_allclose(static_gain(model)[:, column], slope, rtol=1e-11, atol=1e-12)


def test_integrators_show_only_where_they_act():
    # Tank 0 drains into tank 1, which has no outlet; pump 1 draws from tank 1.
    A = np.array([[-0.5, 0.0], [0.5, 0.0]])
    B = np.array([[1.0, 0.0], [0.0, -3.0]])
    gain = static_gain(model_of(A, B, np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])))
    np.testing.assert_array_equal(gain, [[2.0, 0.0], [np.inf, -np.inf], [np.inf, -np.inf]])


def test_a_cancelled_integrator_leaves_a_finite_gain():
    # The difference of two integrating tanks that are fed alike, in a mixed basis.
    T = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    A = T @ np.diag([0.0, 0.0, -2.0]) @ T.T
    gain = static_gain(model_of(A, T @ np.ones((3, 1)), np.array([[1.0, -1.0, 4.0]]) @ T.T))
    assert gain[0, 0] == pytest.approx(2.0, rel=1e-12)


def test_a_double_integrator_keeps_the_sign_of_its_growth():
    A = np.array([[0.0, 0.0], [-1.0, 0.0]])
    gain = static_gain(model_of(A, np.array([[1.0], [5.0]]), np.array([[0.0, 1.0]])))
    assert gain[0, 0] == -np.inf  # -1/s² + 5/s: falls in the end although it rises at first
