"""Disk margins of several loops together, against closed forms and searches."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from models_by_hand import lag, pi, pure_delay, rational, static
from scipy.optimize import minimize

from clepsydra.linear.disk_margin import disk_margin, structured_singular_values
from clepsydra.linear.interconnection import feedback, parallel_channels, series
from clepsydra.linear.loop_margins import loop_margins
from clepsydra.linear.response import transfer_at

# The spinning satellite, a plant that no single loop shows to be fragile.
SATELLITE = rational([[0.0, 10.0], [-10.0, 0.0]], np.eye(2), [[1.0, 10.0], [-10.0, 1.0]],
                     np.zeros((2, 2)))  # fmt: skip


def test_the_spinning_satellite():
    """Loop at a time L = 1/s: disk 2, 90°; together T has |T| up to 10 and nothing is left."""
    for channel, name in enumerate(SATELLITE.outputs):
        others = feedback(SATELLITE, [1 - channel])
        loop = loop_margins(others.select(outputs=[name], inputs=[SATELLITE.inputs[channel]]))
        assert loop.gain_margin_up == math.inf and loop.gain_margin_down == 0.0
        assert loop.phase_margin == pytest.approx(math.pi / 2, rel=1e-9)
        assert loop.disk.size == pytest.approx(2.0, rel=1e-6)
    # T = [[1, a], [-a, 1]]/(s + 1), a = 10, so S - T = T' has σ = |1 - s ± 2ja|/|s + 1|.
    omegas = np.linspace(0.0, 100.0, 1_000_001)
    s = 1j * omegas
    expected = max((np.abs((s - 1 + sign * 20j) / (s + 1))).max() for sign in (1.0, -1.0))
    assert disk_margin(SATELLITE).size == pytest.approx(2 / expected, rel=1e-8)


def test_multiloop_disk_is_reached_by_a_perturbation():
    """Two complex factors of the size found put det(I + diag(f) L) to zero."""
    plant = rational(
        np.diag([-1.0, -0.5, -2.0]), [[1.0, 0.4], [0.2, 1.0], [0.5, 0.5]],
        [[1.0, 0.0, 1.0], [0.3, 1.0, 0.0]], np.zeros((2, 2)),
    )  # fmt: skip
    loop = series(series(static([[2.0, 0.5], [0.25, 1.5]]), plant), pure_delay(0.2, 0.3))
    margin = disk_margin(loop)
    assert 0.1 < margin.size < 2.0
    L = transfer_at(loop, np.array([1j * margin.frequency]))[0]

    def distance(phases):
        delta = margin.size * np.exp(1j * phases)
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


@pytest.mark.thorough
def test_two_separate_loops_are_two_single_ones():
    one = series(pi(1.0, 5.0), series(lag(2.0, 5.0), pure_delay(1.0)))
    two = series(pi(0.5, 3.0), series(lag(1.0, 2.0), pure_delay(0.5)))
    both = replace(parallel_channels(one, two), inputs=("r1", "r2"), outputs=("y1", "y2"))
    smallest = min(loop_margins(single).disk.size for single in (one, two))
    assert disk_margin(both).size == pytest.approx(smallest, rel=1e-8)


def test_an_unstable_pair_of_loops():
    assert disk_margin(series(static(-np.eye(2)), SATELLITE)).size == 0.0


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
