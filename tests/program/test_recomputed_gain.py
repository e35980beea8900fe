"""The gain from a model that changes: it comes to that of the stationary regulator."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from clepsydra.program.routines.recomputed_gain import recomputed_gain

#: Stiff, coupled and oscillating.
A = np.array([[-1.5, 0.4, 0.0], [-0.4, -0.1, 0.2], [0.0, 0.3, -3.0]])


def held_by_exponentials(B, S, period):
    """[Φ Γ] and the cost of a sample by SciPy's exponential and Simpson's rule."""
    both = np.zeros((5, 5))
    both[:3, :3], both[:3, 3:] = A, B
    times = np.linspace(0.0, period, 2001)
    weights = np.full(2001, 2.0) * period / 6000.0
    weights[1::2] *= 2.0
    weights[[0, -1]] = period / 6000.0
    cost = sum(
        weight * expm(both.T * time) @ S @ expm(both * time)
        for weight, time in zip(weights, times, strict=True)
    )
    return expm(both * period)[:3], cost


@pytest.mark.parametrize("period", [0.1, 0.7, 6.0])
@pytest.mark.parametrize("steps", [1, 3])
def test_steps_come_to_the_stationary_regulator_of_the_sampled_plant(period, steps):
    """Held by SciPy's exponential, with its cost by Simpson's rule, and solved by SciPy."""
    random = np.random.default_rng(5)
    B, C, S = (random.normal(size=size) for size in ((3, 2), (1, 3), (5, 5)))
    S = S @ S.T
    doublings = max(0, math.ceil(math.log2(4 * np.linalg.norm(A, 1) * period)))
    entries = ca.SX.sym("p", 10)
    step = recomputed_gain(
        ca.SX(np.hstack([A, B])), ca.SX(S), ca.SX(C),
        ca.SX(ca.Sparsity.upper(4), entries), ca.SX(period), doublings, steps,
    )  # fmt: skip
    told = [ca.vertcat(*ca.triu(step.cost).nonzeros()), step.gain, step.definite]
    function = ca.Function("step", [entries], told)
    P, gain, definite = np.zeros(10), None, None
    for _ in range(3000):
        P, gain, definite = (np.array(each) for each in function(P))
    held, cost = held_by_exponentials(B, S, period)
    H, G = np.block([[held[:, :3], np.zeros((3, 1))], [C, np.eye(1)]]), np.zeros((4, 2))
    G[:3] = held[:, 3:]
    Q, N = np.eye(4), np.zeros((4, 2))
    Q[:3, :3], N[:3], R = cost[:3, :3] / period, cost[:3, 3:] / period, cost[3:, 3:] / period
    exact = solve_discrete_are(H, G, Q, R, s=N)
    K = np.linalg.solve(R + G.T @ exact @ G, G.T @ exact @ H + N.T)
    # Rounding and Simpson's rule leave 6e-12; two terms of the series fewer would leave 9e-10.
    upper = exact.T[np.tril_indices(4)]
    assert P.ravel() == pytest.approx(upper, rel=0, abs=1e-10 * np.abs(exact).max())
    assert gain == pytest.approx(K, rel=0, abs=1e-10 * np.abs(K).max())
    assert definite.item() == 1.0


def test_a_cost_that_is_not_definite_is_told():
    none, one = ca.SX(0), ca.SX(1)
    model, weight = ca.SX([[0.0, 1.0]]), ca.SX.eye(2)
    found = [
        recomputed_gain(model, weight, none, ca.diag(ca.vertcat(p, 1)), one, 0, 1)
        for p in (3.0, -3.0)
    ]
    assert [bool(ca.evalf(step.definite)) for step in found] == [True, False]
    assert all(np.isfinite(np.array(ca.evalf(step.gain))).all() for step in found)
