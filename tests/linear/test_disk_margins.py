"""Structured singular values, which disk margins are made of, against closed forms and searches."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from clepsydra.linear.disk_margin import structured_singular_values


def test_the_spinning_satellite():
    """Each loop alone has 1/s; together T = [[1, a], [-a, 1]]/(s + 1), a = 10, leaves nothing.

    So S - T = T' has σ = |1 - s ± 2ja|/|s + 1|, twice the structured singular value of S - I/2.
    """
    s = 1j * np.linspace(0.0, 100.0, 2001)
    T = np.array([[1.0, 10.0], [-10.0, 1.0]]) / (s[:, None, None] + 1.0)
    expected = max((np.abs((s - 1 + sign * 20j) / (s + 1))).max() for sign in (1.0, -1.0))
    found = structured_singular_values(np.eye(2) / 2.0 - T).max()
    assert 2.0 * found == pytest.approx(expected, rel=1e-8)


def test_the_bound_is_reached_by_a_perturbation():
    """Two complex factors of the size found put det(I + diag(f) L) to zero."""
    L = np.array([[-0.8 - 0.5j, 0.4 + 0.2j], [-0.3 + 0.5j, 0.9 - 0.7j]])
    middle = np.linalg.inv(np.eye(2) + L) - np.eye(2) / 2.0
    size = 1.0 / structured_singular_values(middle[None])[0]
    assert 0.1 < size < 2.0

    def distance(phases):
        delta = size * np.exp(1j * phases)
        factors = (1 + delta / 2) / (1 - delta / 2)
        return abs(np.linalg.det(np.eye(2) + factors[:, None] * L))

    starts = np.linspace(0, 2 * np.pi, 7)[:-1]
    best = min(
        minimize(
            distance, [a, b], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12}
        ).fun
        for a in starts
        for b in starts
    )
    assert best < 1e-5 * distance(np.zeros(2))


def test_two_separate_channels_are_the_worse_one():
    values = np.diag([0.3 + 0.4j, -0.2j])
    assert structured_singular_values(values[None])[0] == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("q", [2, 3])
def test_structured_norm_is_attained(q):
    """max over phases of ρ(diag(e^{jθ}) M) equals the bound for two and three channels."""
    numbers = np.random.default_rng(q)
    for _ in range(4):
        M = numbers.standard_normal((q, q)) + 1j * numbers.standard_normal((q, q))

        def radius(phases, M=M):
            turned = np.exp(1j * np.concatenate([[0.0], phases]))[:, None] * M
            return -np.abs(np.linalg.eigvals(turned)).max()

        grid = np.linspace(0, 2 * np.pi, 9)[:-1]
        starts = np.stack(np.meshgrid(*[grid] * (q - 1)), -1).reshape(-1, q - 1)
        best = sorted(starts, key=radius)[:6]
        attained = max(
            -minimize(radius, start, method="Nelder-Mead",
                      options={"xatol": 1e-9, "fatol": 1e-12}).fun
            for start in best
        )  # fmt: skip
        assert structured_singular_values(M[None])[0] == pytest.approx(attained, rel=1e-5)
