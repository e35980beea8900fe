"""Margins of several loops together, against Hamiltonian peaks, python-control and searches."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from models_by_hand import lag, pi, pure_delay, rational, static
from refusals import refused
from scipy.optimize import minimize
from state_space_loops import maximum_sensitivity

from clepsydra.linear.disk_margin import disk_margin, structured_singular_values
from clepsydra.linear.interconnection import feedback, parallel_channels, series
from clepsydra.linear.loop_margins import loop_margins
from clepsydra.linear.multivariable_margins import (
    loop_at_input,
    loop_at_output,
    multivariable_margins,
)
from clepsydra.linear.response import transfer_at
from clepsydra.linear.sensitivity import largest_gain

# The spinning satellite, a plant that no single loop shows to be fragile.
SATELLITE = rational([[0.0, 10.0], [-10.0, 0.0]], np.eye(2), [[1.0, 10.0], [-10.0, 1.0]],
                     np.zeros((2, 2)))  # fmt: skip


def random_loop(random_system, seed):
    system = random_system(seed, 4, 2, 2)
    plant = rational(system.A, 0.3 * system.B, system.C, system.D)
    other = random_system(seed + 100, 2, 2, 2, direct=True)
    return plant, rational(other.A, 0.2 * other.B, other.C, 0.2 * other.D)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(8))
def test_peaks_against_hamiltonian_eigenvalues(seed, random_system):
    plant, controller = random_loop(random_system, seed)
    margins = multivariable_margins(plant, controller)
    for loop, found in (
        (loop_at_output(plant, controller), margins.at_output),
        (loop_at_input(plant, controller), margins.at_input),
    ):
        exact = maximum_sensitivity(loop.A, loop.B, loop.C, loop.D)
        assert margins.stable is math.isfinite(exact.peak)
        assert found.sensitivity.peak == pytest.approx(exact.peak, rel=1e-8)
        if margins.stable:
            closed = feedback(loop)
            exact = largest_gain(closed.A, closed.B, closed.C, closed.D)
            assert found.complementary.peak == pytest.approx(exact.peak, rel=1e-8)
            # The multiloop disk lies between the full-block bound and each single loop.
            half = largest_gain(closed.A, closed.B, closed.C, closed.D - np.eye(2) / 2)
            smallest = min(loop.disk.size for loop in found.loops.values())
            assert 1 / half.peak * (1 - 1e-8) <= found.disk.size <= smallest * (1 + 1e-8)
            assert margins.disk.size <= min(found.disk.size, 2.0) * (1 + 1e-8)


def test_the_spinning_satellite():
    """Loop at a time L = 1/s: disk 2, 90°; together T has |T| up to 10 and nothing is left."""
    margins = multivariable_margins(SATELLITE, static(np.eye(2)))
    assert margins.stable
    for loop in margins.at_output.loops.values():
        assert loop.gain_margin_up == math.inf and loop.gain_margin_down == 0.0
        assert loop.phase_margin == pytest.approx(math.pi / 2, rel=1e-9)
        assert loop.disk.size == pytest.approx(2.0, rel=1e-6)
    # T = [[1, a], [-a, 1]]/(s + 1), a = 10, so S - T = T' has σ = |1 - s ± 2ja|/|s + 1|.
    omegas = np.linspace(0.0, 100.0, 1_000_001)
    s = 1j * omegas
    expected = max((np.abs((s - 1 + sign * 20j) / (s + 1))).max() for sign in (1.0, -1.0))
    assert margins.at_output.disk.size == pytest.approx(2 / expected, rel=1e-8)
    assert margins.at_output.complementary.peak == pytest.approx(math.sqrt(101), rel=1e-6)


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
    margins = multivariable_margins(both, static(np.eye(2)))
    singles = [loop_margins(one), loop_margins(two)]
    for loop, single in zip(margins.at_output.loops.values(), singles, strict=True):
        assert loop.gain_margin_up == pytest.approx(single.gain_margin_up, rel=1e-9)
        assert loop.phase_margin == pytest.approx(single.phase_margin, rel=1e-9)
        assert loop.disk.size == pytest.approx(single.disk.size, rel=1e-8)
    assert margins.at_output.disk.size == pytest.approx(
        min(single.disk.size for single in singles), rel=1e-8
    )
    assert margins.at_output.sensitivity.peak == pytest.approx(
        max(single.sensitivity.peak for single in singles), rel=1e-8
    )


def test_an_unstable_pair_of_loops():
    margins = multivariable_margins(SATELLITE, static(-np.eye(2)))
    assert not margins.stable
    assert margins.at_input.sensitivity.peak == math.inf
    assert margins.at_output.disk.size == 0.0 == margins.disk.size


def test_input_and_output_differ_for_an_ill_conditioned_plant():
    """With G = diag(1, 100) R(45°)/(s + 1) and a controller in one direction of it."""
    turn = np.array([[1.0, -1.0], [1.0, 1.0]]) / math.sqrt(2)
    plant = rational(-np.eye(2), np.eye(2), np.diag([1.0, 100.0]) @ turn, np.zeros((2, 2)))
    controller = static(turn.T @ np.diag([1.0, 0.05]))
    margins = multivariable_margins(plant, controller)
    at_output = series(controller, plant)
    assert margins.at_output.sensitivity.peak == pytest.approx(
        maximum_sensitivity(at_output.A, at_output.B, at_output.C, at_output.D).peak, rel=1e-8
    )
    assert margins.at_output.disk.size > margins.disk.size


def test_a_controller_that_does_not_fit():
    with refused(remedy="an output for every input of the plant"):
        multivariable_margins(SATELLITE, static(np.ones((3, 2))))
    twins = replace(SATELLITE, outputs=("y", "y"))
    with refused(expected="each name once"):
        multivariable_margins(twins, static(np.eye(2)))
    with refused(place="series connection"):
        multivariable_margins(SATELLITE, static(np.ones((2, 3))))


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
