"""Minimal realisations: same transfer function, fewest states."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from clepsydra.linear.minimal_realisation import (
    minimal_realisation,
    reachable_basis,
    scaled_system,
)
from clepsydra.linear.response import evaluate_transfer

POINTS = 1j * np.array([0.0, 0.1, 1.0, 10.0])


@pytest.mark.parametrize("seed", range(5))
def test_idle_states_leave_and_the_response_stays(random_system, seed):
    core, idle = random_system(seed, 3, 2, 2, direct=True), random_system(seed + 9, 2, 2, 2)
    A = scipy.linalg.block_diag(core.A, idle.A)
    B, C = np.vstack([core.B, idle.B]), np.hstack([core.C, idle.C])
    C[:, 3:] = 0
    T = np.diag([1e4, 1, 1e-3, 1e2, 1e-2]) @ scipy.linalg.orth(
        np.random.default_rng(seed).standard_normal((5, 5))
    )
    A, B, C = T @ A @ np.linalg.inv(T), 1e3 * T @ B, C @ np.linalg.inv(T)
    small = minimal_realisation(A, B, C, core.D)
    assert small[0].shape == (3, 3)
    np.testing.assert_allclose(
        evaluate_transfer(*small, POINTS),
        evaluate_transfer(core.A, 1e3 * core.B, core.C, core.D, POINTS),
        rtol=1e-8,
    )


def test_element_of_the_quadruple_tank_has_two_states(minimum):
    A, B, C = minimum.matrices(minimum.levels(minimum.voltage))
    small = minimal_realisation(A, B[:, [1]], C[[0]], np.zeros((1, 1)))
    t1, _, t3, _ = minimum.time_constants(minimum.levels(minimum.voltage))
    np.testing.assert_allclose(
        np.sort(np.linalg.eigvals(small[0])), np.sort([-1 / t1, -1 / t3]), rtol=1e-12
    )


def test_nothing_remains_of_a_zero_gain():
    one = np.ones((1, 1))
    A, B, C, D = minimal_realisation(-one, 0 * one, one, 2 * one)
    assert (A.shape, B.shape, C.shape) == ((0, 0), (0, 1), (1, 0))
    assert D[0, 0] == 2.0


def test_scaling_keeps_the_transfer_function_in_every_bit(minimum):
    A, B, C = minimum.matrices(minimum.levels(minimum.voltage))
    scaled = scaled_system(A, B, C, np.zeros((4, 2)))
    moment = A @ B
    back = scaled.rate * scaled.output_sizes[:, None] * scaled.input_sizes
    np.testing.assert_array_equal(C @ B, back * (scaled.C @ scaled.B))
    np.testing.assert_allclose(
        C @ moment, back * scaled.rate * (scaled.C @ scaled.A @ scaled.B), rtol=1e-15
    )
    assert np.log2(scaled.rate) % 1 == 0


def test_reachable_basis_is_orthonormal_and_invariant(random_system):
    system = random_system(2, 6, 1, 1)
    A = system.A.copy()
    A[3:, :3] = 0
    B = system.B.copy()
    B[3:] = 0
    basis = reachable_basis(A, B)
    assert basis.shape == (6, 3)
    np.testing.assert_allclose(basis.T @ basis, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(basis[3:], 0, atol=1e-14)
