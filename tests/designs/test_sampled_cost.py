"""The cost of a held process between its samples, against closed forms and quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from clepsydra.designs.sampled.sampled_cost import sampled_cost


@pytest.mark.parametrize("rate", [0.0, 0.02, 3.0, 40.0, 2000.0])
def test_one_tank_has_the_closed_form(rate):
    """x(t) = e x + b (1 - e)/a u with e = exp(-a t): sums of exponentials, by hand."""
    a, b, q, r, period = rate, 0.3, 2.0, 5.0, 1.5
    cost = sampled_cost(np.array([[-a]]), np.array([[b]]), np.array([[q]]), np.array([[r]]), period)
    if a == 0.0:
        expected = [1.0, b * period, q * period, q * b * period**2 / 2,
                    q * b**2 * period**3 / 3 + r * period]  # fmt: skip
    else:
        once, twice = -np.expm1(-a * period) / a, -np.expm1(-2 * a * period) / (2 * a)
        expected = [
            np.exp(-a * period),
            b * once,
            q * twice,
            q * b / a * (once - twice),
            q * (b / a) ** 2 * (period - 2 * once + twice) + r * period,
        ]
    found = [cost.held, cost.moved, cost.Q, cost.N, cost.R]
    values = [float(matrix[0, 0]) for matrix in found]
    assert values == pytest.approx(expected, rel=1e-9, abs=1e-300)


@pytest.mark.parametrize("period", [0.01, 3.0, 500.0])
def test_a_cascade_agrees_with_quadrature(period):
    A = np.array([[-0.05, 0.03, 0.0], [0.0, -0.4, 0.2], [0.0, 0.0, -6.0]])
    B = np.array([[0.1, 0.0], [0.0, 0.2], [1.0, -1.0]])
    C = np.array([[1.0, 0.0, 0.5]])
    R = np.diag([0.3, 0.7])
    cost = sampled_cost(A, B, C.T @ C, R, period)
    both = np.zeros((5, 5))
    both[:3, :3], both[:3, 3:] = A, B
    whole = np.block([[cost.Q, cost.N], [cost.N.T, cost.R]])
    random = np.random.default_rng(1)
    for start in random.normal(size=(3, 5)):

        def rate(time, start=start):
            now = expm(both * time) @ start
            return float((C @ now[:3])[0] ** 2 + start[3:] @ R @ start[3:])

        marks = [mark for mark in (0.2, 1.0, 5.0, 30.0, 120.0) if mark < period]
        expected = quad(rate, 0.0, period, points=marks or None, limit=400, epsrel=1e-11)[0]
        assert start @ whole @ start == pytest.approx(expected, rel=1e-9)
        assert np.hstack([cost.held, cost.moved]) @ start == pytest.approx(
            (expm(both * period) @ start)[:3], rel=1e-9, abs=1e-12
        )


def test_the_cost_is_never_negative_however_long_the_period():
    """The exponential of the whole period would overflow here: exp(40 · 5000)."""
    A = np.diag([-40.0, -0.01])
    cost = sampled_cost(A, np.ones((2, 1)), np.eye(2), np.zeros((1, 1)), 5000.0)
    whole = np.block([[cost.Q, cost.N], [cost.N.T, cost.R]])
    assert np.linalg.eigvalsh(whole).min() > -1e-12 * np.abs(whole).max()
    assert np.diag(cost.Q) == pytest.approx([1 / 80.0, 50.0], rel=1e-12)
