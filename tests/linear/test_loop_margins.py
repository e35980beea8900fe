"""Margins of one loop, against closed forms, root finding and python-control."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from models_by_hand import lag, pi, pure_delay, rational, static
from refusals import refused
from scipy.optimize import brentq
from state_space_loops import is_stable, maximum_sensitivity

from clepsydra.linear.disk_margin import disk_margin
from clepsydra.linear.frequency_grid import frequency_grid
from clepsydra.linear.frequency_peak import responses_at_infinity
from clepsydra.linear.interconnection import feedback, series
from clepsydra.linear.loop_margins import loop_margins


def from_transfer(numerator, denominator):
    system = control.ss(control.tf(numerator, denominator))
    return rational(system.A, system.B, system.C, system.D)


def test_integrator_with_dead_time():
    """L = k e^{-sτ}/s: ω = k, phase margin π/2 - kτ, gain margin π/(2kτ)."""
    k, tau = 0.3, 2.0
    margins = loop_margins(series(rational(0.0, k, 1.0, 0.0), pure_delay(tau)))
    assert margins.stable
    assert margins.phase_margin == pytest.approx(math.pi / 2 - k * tau, rel=1e-12)
    assert margins.delay_margin == pytest.approx((math.pi / 2 - k * tau) / k, rel=1e-12)
    assert margins.gain_margin_up == pytest.approx(math.pi / (2 * k * tau), rel=1e-12)
    assert margins.gain_margin_down == 0.0
    # It crosses the negative real axis at every (π/2 + 2πi)/τ.
    up = np.array([crossing.frequency for crossing in margins.gain_crossings[:20]])
    np.testing.assert_allclose(up, (math.pi / 2 + 2 * math.pi * np.arange(20)) / tau, rtol=1e-11)


def test_peaks_of_an_integrator_with_dead_time():
    """|S|² = 1/(1 - 2 k/ω sin ωτ + k²/ω²), maximised by an own scan and root of its slope."""
    k, tau = 0.5, 1.0
    margins = loop_margins(series(rational(0.0, k, 1.0, 0.0), pure_delay(tau)))

    def inverse(w):
        return 1 - 2 * k / w * np.sin(w * tau) + (k / w) ** 2

    def slope(w):
        return 2 * k / w**2 * math.sin(w) - 2 * k / w * math.cos(w) - 2 * k**2 / w**3

    scan = np.linspace(0.01, 100.0, 2_000_001)
    near = scan[np.argmin(inverse(scan))]
    omega = brentq(slope, near - 1e-3, near + 1e-3, xtol=1e-14)
    assert margins.sensitivity.peak == pytest.approx(inverse(omega) ** -0.5, rel=1e-12)
    assert margins.sensitivity.frequency == pytest.approx(omega, rel=1e-6)
    complementary = np.abs(k / scan) / np.sqrt(inverse(scan))
    assert margins.complementary.peak == pytest.approx(max(1.0, complementary.max()), rel=1e-8)


def test_lag_with_dead_time_under_pi_control():
    """SIMC: K = T/(g τ 2), Ti = min(T, 8τ): L = e^{-sτ}/(2 τ s), margins known (M_S = 1.59)."""
    gain, time_constant, tau = 2.0, 5.0, 1.0
    controller = pi(time_constant / (2 * gain * tau), time_constant)
    margins = loop_margins(series(series(controller, lag(gain, time_constant)), pure_delay(tau)))
    assert margins.gain_margin_up == pytest.approx(math.pi, rel=1e-10)
    assert margins.phase_margin == pytest.approx(math.pi / 2 - 0.5, rel=1e-10)
    assert margins.delay_margin == pytest.approx(2 * (math.pi / 2 - 0.5), rel=1e-10)
    assert margins.sensitivity.peak == pytest.approx(1.59, abs=0.005)


def test_proportional_control_of_a_lag_with_dead_time():
    """ω T + tan-type equations solved by a root find; crossings beyond are ripples."""
    gain, tau = 3.0, 0.5
    margins = loop_margins(series(lag(gain, 1.0), pure_delay(tau)))
    ultimate = brentq(lambda w: math.atan(w) + w * tau - math.pi, 0.1, 10.0, xtol=1e-14)
    assert margins.gain_margin_up == pytest.approx(math.hypot(1, ultimate) / gain, rel=1e-12)
    unit = math.sqrt(gain**2 - 1)
    assert margins.phase_margin == pytest.approx(
        abs(math.pi - math.atan(unit) - unit * tau), rel=1e-11
    )
    scan = np.linspace(0.01, 12.0, 600_001)  # what comes after it is smaller
    loop = gain * np.exp(-1j * scan * tau) / (1 + 1j * scan)
    assert margins.sensitivity.peak == pytest.approx((1 / abs(1 + loop)).max(), rel=1e-9)
    assert margins.disk.size == pytest.approx(2 / np.abs((1 - loop) / (1 + loop)).max(), rel=1e-9)


def test_a_pure_dead_time_under_proportional_control():
    """|S| = 1/|1 + k e^{-jωτ}| reaches 1/(1 - k) again and again, T k/(1 - k)."""
    margins = loop_margins(series(static(0.4), pure_delay(3.0)))
    assert margins.sensitivity.peak == pytest.approx(1 / 0.6, rel=1e-9)
    assert margins.complementary.peak == pytest.approx(0.4 / 0.6, rel=1e-9)
    assert margins.gain_margin_up == pytest.approx(2.5, rel=1e-12)
    assert margins.phase_margin == math.inf and margins.delay_margin == math.inf
    assert margins.disk.size == pytest.approx(2 * 0.6 / 1.4, rel=1e-9)


def test_phases_of_two_dead_times_stand_for_all_at_infinity():
    """1/(1 + k e^(-jφ)) of two loops reaches 1/(1 - k) of the tighter one, at φ = π."""
    closed = feedback(series(static(np.diag([0.5, 0.4])), pure_delay(1.0, math.sqrt(2.0))))
    sensitivity = np.eye(2) - responses_at_infinity(closed)
    assert np.linalg.norm(sensitivity, 2, axis=(1, 2)).max() == pytest.approx(2.0, rel=1e-4)


def test_an_unstable_loop_is_reported_as_such():
    margins = loop_margins(series(lag(30.0, 1.0), pure_delay(0.5)))
    assert not margins.stable
    assert margins.gain_margin_up is None and margins.gain_margin_down is None
    assert margins.phase_margin is None and margins.delay_margin is None
    assert margins.sensitivity.peak == math.inf and margins.disk.size == 0.0
    assert min(crossing.margin for crossing in margins.gain_crossings) < 1.0


def test_conditionally_stable_loop():
    """k (s+1)²/s³ is stable for k > 1/2: a margin down only."""
    margins = loop_margins(from_transfer([2.0, 4.0, 2.0], [1.0, 0.0, 0.0, 0.0]))
    assert margins.stable
    assert margins.gain_margin_down == pytest.approx(0.25, rel=1e-9)
    assert margins.gain_margin_up == math.inf


def test_an_unstable_plant_with_its_margin_at_frequency_zero():
    """k/(s - 1) with k = 3 is stable for k > 1: the crossing at ω = 0 counts."""
    margins = loop_margins(rational(1.0, 3.0, 1.0, 0.0))
    assert margins.gain_margin_down == pytest.approx(1 / 3, rel=1e-12)
    assert margins.gain_crossings[0].frequency == 0.0


@pytest.mark.parametrize("seed", range(12))
def test_rational_loops_against_python_control(seed, random_system):
    system = random_system(seed, 4, 1, 1)
    loop = rational(system.A, system.B, system.C, system.D)
    peak = maximum_sensitivity(loop.A, loop.B, loop.C, loop.D)
    margins = loop_margins(loop)
    assert margins.stable is is_stable(loop.A, loop.B, loop.C, loop.D)
    assert margins.sensitivity.peak == pytest.approx(peak.peak, rel=1e-8)
    gains, phases, _, at_gain, at_phase, _ = control.stability_margins(
        loop.to_control(), returnall=True
    )
    ours = sorted(c.margin for c in margins.gain_crossings if 0 < c.frequency < math.inf)
    theirs = [gain for gain, omega in zip(gains, at_gain, strict=True) if omega > 0]
    np.testing.assert_allclose(ours, sorted(theirs), rtol=1e-6)
    ours = sorted(np.degrees(c.margin) for c in margins.phase_crossings)
    np.testing.assert_allclose(ours, sorted((phases + 180) % 360 - 180), rtol=1e-6)
    assert len(at_phase) == len(margins.phase_crossings)


def test_a_narrow_resonance_is_not_missed():
    """1/(s² + 2ζs + 1) with ζ = 1e-5 under a gain of 1e-6: S peaks by Hamiltonian eigenvalues."""
    zeta = 1e-5
    loop = rational([[0.0, 1.0], [-1.0, -2 * zeta]], [[0.0], [1e-6]], [[1.0, 0.0]], 0.0)
    exact = maximum_sensitivity(loop.A, loop.B, loop.C, loop.D).peak
    assert exact > 1.02
    assert loop_margins(loop).sensitivity.peak == pytest.approx(exact, rel=1e-7)


@pytest.mark.thorough
def test_disk_margin_of_the_paper():
    """Seiler, Packard and Gahinet's L: α = 0.46, gains 0.63 to 1.59, phase 25.8° of the text."""
    loop = from_transfer([25.0], [1.0, 10.0, 10.0, 10.0])
    margin = disk_margin(loop)
    assert margin.size == pytest.approx(0.46, abs=0.005)
    assert 1 / margin.gain == pytest.approx(0.63, abs=0.005)
    omegas = np.linspace(1.9, 2.0, 20001)
    theirs = control.disk_margins(loop.to_control(), omegas)
    assert margin.size == pytest.approx(theirs[0], rel=1e-8)
    assert 20 * math.log10(margin.gain) == pytest.approx(theirs[1], rel=1e-8)
    assert math.degrees(margin.phase) == pytest.approx(theirs[2], rel=1e-8)


def test_a_factor_on_the_rim_of_the_disk_destabilises():
    loop = from_transfer([25.0], [1.0, 10.0, 10.0, 10.0])
    margin = disk_margin(loop)
    L = complex(loop.to_control()(1j * margin.frequency))
    delta = 2 * (1 + L) / (1 - L)  # f = (1 + δ/2)/(1 - δ/2) with 1 + f L = 0
    assert abs(delta) == pytest.approx(margin.size, rel=1e-8)


def test_grid_stands_around_resonances_and_follows_the_dead_time():
    model = series(rational([[0.0, 1.0], [-1.0, -2e-4]], [[0.0], [1.0]], [[1.0, 0.0]], 0.0),
                   pure_delay(20.0))  # fmt: skip
    grid = frequency_grid(model)
    assert np.all(np.diff(grid) > 0) and grid[0] < 0.01 and grid[-1] > 99.0
    near = grid[np.abs(grid - 1.0) < 1e-3]
    assert np.diff(near).min() < 1e-4
    below = grid[grid < 15.0]
    assert np.diff(below).max() * 20.0 < np.pi / 16 * 1.0001


def test_no_pole_stands_on_the_grid():
    """k (s + 1)/(s² + 1) with its poles at ±j: stable for any k > 0, and never at -180°."""
    swing = rational([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]], [[0.5, 0.5]], 0.0)
    assert 1.0 in np.geomspace(0.01, 100.0, 241)
    assert np.abs(frequency_grid(swing) - 1.0).min() > 1e-7
    margins = loop_margins(swing)
    assert margins.stable and margins.gain_margin_up == math.inf
    assert len(margins.phase_crossings) == 2  # |L| = 1 below and above the resonance


def test_several_loops_are_refused():
    with refused(remedy="select the channel"):
        loop_margins(pure_delay(1.0, 2.0))
