"""The peak of the sensitivity: closed forms, dense grids, and unstable loops."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from scipy.optimize import minimize_scalar
from state_space_loops import closed_loop_poles, is_stable, maximum_sensitivity

from clepsydra.linear.frequency_peak import largest_gain
from clepsydra.linear.response import evaluate_transfer

ONE = np.ones((1, 1))


def sensitivity(system, omegas):
    L = evaluate_transfer(*system, 1j * np.asarray(omegas))
    return np.linalg.norm(np.linalg.inv(np.eye(L.shape[1]) + L), 2, axis=(1, 2))


def integrator_with_lag(gain):
    """Return L = k/(s (s + 1))."""
    A = np.array([[0.0, 1.0], [0.0, -1.0]])
    return A, np.array([[0.0], [gain]]), np.array([[1.0, 0.0]]), 0 * ONE


@pytest.mark.parametrize("gain", [0.05, 1.0, 30.0, 1e4])
def test_integrator_with_lag(gain):
    # S = (s² + s)/(s² + s + k), so |S|² = (w² + w)/((k - w)² + w) with w = ω². Its derivative
    # vanishes where -2 k w² + 2 k² w + k² = 0.
    w = (2 * gain**2 + math.sqrt(4 * gain**4 + 8 * gain**3)) / (4 * gain)
    expected = math.sqrt(w * (w + 1) / ((gain - w) ** 2 + w))
    found = maximum_sensitivity(*integrator_with_lag(gain))
    assert found.peak == pytest.approx(expected, rel=1e-8)
    assert found.frequency == pytest.approx(math.sqrt(w), rel=1e-3)


@pytest.mark.parametrize("damping", [1e-6, 1e-3, 0.3, 0.7])
def test_peak_of_a_resonance(damping):
    A = np.array([[0.0, 1.0], [-1.0, -2 * damping]])
    found = largest_gain(A, np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]]), 0 * ONE)
    assert found.peak == pytest.approx(1 / (2 * damping * math.sqrt(1 - damping**2)), rel=1e-8)


def test_a_hump_that_no_value_at_zero_or_infinity_shows():
    """G = (-0.742760 s - 0.00074308)/((s + 0.034)(s + 0.52)) + 0.026, on a fine grid."""
    A, B = np.array([[-0.034, 0.0], [0.079, -0.52]]), np.array([[0.076], [1.7]])
    found = largest_gain(A, B, np.array([[0.74, -0.47]]), 0.026 * ONE)
    s = 1j * np.logspace(-2, 2, 100_001)
    gains = abs((-0.742760 * s - 0.00074308) / ((s + 0.034) * (s + 0.52)) + 0.026)
    assert found.peak == pytest.approx(gains.max(), rel=1e-7)
    assert found.frequency == pytest.approx(s[gains.argmax()].imag, rel=1e-3)


def test_slow_tanks_in_a_row_have_their_peak_at_rest():
    """Three of them, far above the gain at infinity: D - C A⁻¹ B."""
    A = np.array([[-0.11, 0.0, 0.0], [7.3, -0.0026, 0.0], [0.0, 2.7, -0.0058]])
    B, C = np.array([[0.97], [0.79], [-0.28]]), np.array([[0.48, 0.2, -0.061]])
    first = 0.97 / 0.11
    second = (7.3 * first + 0.79) / 0.0026
    third = (2.7 * second - 0.28) / 0.0058
    found = largest_gain(A, B, C, 0.012 * ONE)
    expected = abs(0.48 * first + 0.2 * second - 0.061 * third + 0.012)
    assert found == (pytest.approx(expected, rel=1e-9), 0.0)


def test_a_narrow_resonance_beside_a_broad_one():
    A = scipy.linalg.block_diag([[0, 1], [-1, -0.4]], [[0, 1], [-1e4, -2e-5]], [[-1e-3]])
    B = np.array([[0.0, 1.0, 0.0, 1.0, 1e-3]]).T
    C = np.array([[1.0, 0.0, 1e-2, 0.0, 1.0]])
    found = largest_gain(A, B, C, 0 * ONE)
    assert found.frequency == pytest.approx(100.0, rel=1e-6)
    # Alone the resonance has 0.01/(2e-5 · 100) = 5; the broad mode adds about -1e-4 to it.
    assert found.peak == pytest.approx(5.0, rel=1e-4)


def test_a_first_order_loop_only_approaches_one():
    found = maximum_sensitivity(0 * ONE, ONE, 2 * ONE, 0 * ONE)
    assert found == (1.0, math.inf)


def test_largest_at_frequency_zero():
    found = maximum_sensitivity(-ONE, ONE, -0.5 * ONE, 0 * ONE)  # L = -0.5/(s + 1)
    assert found == (pytest.approx(2.0, rel=1e-12), 0.0)


def test_direct_term():
    assert maximum_sensitivity(-ONE, 0 * ONE, ONE, -0.5 * ONE).peak == pytest.approx(2.0)


@pytest.mark.parametrize("seed", range(12))
def test_random_loops_against_a_dense_grid_and_a_local_search(random_system, seed):
    raw = random_system(seed, 6, 2, 2)
    system = raw.A, raw.B, 0.3 * raw.C, raw.D
    assert np.all(np.linalg.eigvals(raw.A).real < 0)
    found = maximum_sensitivity(*system)
    closed = np.linalg.eigvals(raw.A - raw.B @ (0.3 * raw.C)).real.max()
    if closed > 0:
        assert found.peak == math.inf
        assert math.isnan(found.frequency)
        return
    omegas = np.concatenate([[0.0], np.logspace(-4, 4, 4000)])
    grid = sensitivity(system, omegas)
    best = int(np.argmax(grid))
    low, high = omegas[max(best - 1, 0)], omegas[min(best + 1, len(omegas) - 1)]
    refined = minimize_scalar(
        lambda w: -sensitivity(system, [w])[0], bounds=(low, high), method="bounded",
        options={"xatol": 1e-10 * high},
    )  # fmt: skip
    expected = max(-refined.fun, grid[0], 1.0)
    assert found.peak == pytest.approx(expected, rel=1e-8)
    if math.isfinite(found.frequency):
        assert sensitivity(system, [found.frequency])[0] == pytest.approx(found.peak, rel=1e-12)


def test_multiloop_peak_is_taken_over_directions():
    # Two independent loops: the peak is that of the worse one.
    first, second = integrator_with_lag(1.0), integrator_with_lag(9.0)
    joined = [scipy.linalg.block_diag(a, b) for a, b in zip(first, second, strict=True)]
    worse = maximum_sensitivity(*second)
    assert maximum_sensitivity(*joined).peak == pytest.approx(worse.peak, rel=1e-8)


def test_very_different_time_scales():
    # The same loop a million times slower has the same peak at a frequency a million times lower.
    A, B, C, D = integrator_with_lag(5.0)
    fast, slow = maximum_sensitivity(A, B, C, D), maximum_sensitivity(1e-6 * A, 1e-6 * B, C, D)
    assert slow.peak == pytest.approx(fast.peak, rel=1e-8)
    assert slow.frequency == pytest.approx(1e-6 * fast.frequency, rel=1e-3)


def test_stability_limit_of_three_equal_lags():
    # 1/(s + 1)³ is stable under proportional feedback up to a gain of eight.
    A = -np.eye(3) + np.diag([1.0, 1.0], 1)
    B, C = np.array([[0.0], [0.0], [1.0]]), np.array([[1.0, 0.0, 0.0]])
    assert is_stable(A, 7.99 * B, C, 0 * ONE)
    assert not is_stable(A, 8.01 * B, C, 0 * ONE)
    assert maximum_sensitivity(A, 8.01 * B, C, 0 * ONE).peak == math.inf
    near = maximum_sensitivity(A, 7.99 * B, C, 0 * ONE)
    assert near.peak == pytest.approx(
        sensitivity((A, 7.99 * B, C, 0 * ONE), np.linspace(1.7, 1.76, 20001)).max(), rel=1e-6
    )
    # (s + 1)³ + 7.99 = 0
    expected = -1 + 7.99 ** (1 / 3) * np.exp(1j * np.pi * np.array([1 / 3, 1, -1 / 3]))
    found = closed_loop_poles(A, 7.99 * B, C, 0 * ONE)
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected), rtol=1e-9)


def test_a_hidden_integrator_is_not_stable():
    # An integrator that the loop cannot move: it cancels in L but drifts in the plant.
    A, B, C = np.diag([0.0, -1.0]), np.array([[0.0], [1.0]]), np.array([[1.0, 1.0]])
    assert not is_stable(A, B, C, 0 * ONE)


def test_a_loop_that_is_not_well_posed():
    assert not is_stable(-ONE, ONE, ONE, -ONE)
    assert maximum_sensitivity(-ONE, ONE, ONE, -ONE).peak == math.inf
