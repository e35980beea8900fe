"""Stability with dead time, against closed forms and Padé approximations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from models_by_hand import lag, late_feedback, pi, pure_delay, rational, static
from refusals import refused
from scipy.special import lambertw

from clepsydra.linear.dead_time import without_dead_time
from clepsydra.linear.interconnection import feedback, series
from clepsydra.linear.poles import poles
from clepsydra.linear.stability import asymptotically_stable, unstable_roots


@pytest.mark.parametrize("tau", [1e-3, 0.4, 50.0])
@pytest.mark.parametrize("k", [0.3, 1.5707, 1.5709, 7.8, 7.9, 40.0, 400.0, -0.5])
def test_the_tank_with_a_late_outflow(tau, k):
    """The roots of s + k/τ e^{-sτ} are W_b(-k)/τ over all branches b of Lambert's W."""
    branches = lambertw(-k, np.arange(-200, 201))
    assert unstable_roots(late_feedback(k / tau, tau)) == int(np.sum(branches.real > 0.0))


def test_a_root_on_the_axis_is_not_stable():
    assert unstable_roots(late_feedback(np.pi / 2.0, 1.0)) is None
    assert unstable_roots(late_feedback(0.0, 1.0)) is None  # it integrates
    assert not asymptotically_stable(late_feedback(np.pi / 2.0, 1.0))


@pytest.mark.parametrize("seed", range(25))
def test_the_number_of_roots_is_that_of_a_pade_approximation(seed):
    numbers = np.random.default_rng(seed)
    n = int(numbers.integers(1, 5))
    plant = rational(
        numbers.standard_normal((n, n)), numbers.standard_normal((n, 2)),
        numbers.standard_normal((2, n)), np.zeros((2, 2)),
    )  # fmt: skip
    late = pure_delay(*numbers.uniform(0.05, 0.4, 2))
    closed = feedback(series(series(late, plant), static(numbers.standard_normal((2, 2)))))
    approximate = poles(without_dead_time(closed, 8))
    assert np.abs(approximate.real).min() > 1e-3  # so that the approximation can tell
    assert unstable_roots(closed) == int(np.sum(approximate.real > 0.0))


def test_hidden_modes_count():
    hidden = rational(np.diag([-1.0, 0.5]), [[1.0], [0.0]], [[1.0, 0.0]], 0.0)
    assert unstable_roots(feedback(series(hidden, pure_delay(0.1)))) == 1


def test_undamped_resonance_beside_a_long_dead_time():
    """(s² + 2ζs + 1) with a faint late feedback: two roots cross, or do not."""
    for damping, stable in ((1e-4, True), (-1e-4, False)):
        plant = rational([[0.0, 1.0], [-1.0, -2 * damping]], [[0.0], [1.0]], [[1.0, 0.0]], 0.0)
        loop = series(series(plant, pure_delay(30.0)), static(1e-6))
        assert asymptotically_stable(feedback(loop)) is stable


def test_a_lag_with_dead_time_at_its_ultimate_gain():
    """K/(s + 1) e^{-s}: ω + tan ω = 0, K = √(1 + ω²)."""
    from scipy.optimize import brentq

    omega = brentq(lambda w: w + np.tan(w), np.pi / 2 + 1e-9, np.pi)
    ultimate = np.hypot(1.0, omega)
    for share, count in ((0.9999, 0), (1.0001, 2)):
        loop = series(lag(ultimate * share, 1.0), pure_delay(1.0))
        assert unstable_roots(feedback(loop)) == count


def test_difference_equations():
    """u(t) = r - k u(t - τ) dies out for |k| < 1."""
    assert asymptotically_stable(feedback(series(static(0.99), pure_delay(2.0))))
    assert not asymptotically_stable(feedback(series(static(1.01), pure_delay(2.0))))
    # A proportional and integral controller of a pure dead time: neutral, |K| < 1.
    assert asymptotically_stable(feedback(series(pi(0.5, 2.0), pure_delay(1.0))))
    assert unstable_roots(feedback(series(pi(1.2, 2.0), pure_delay(1.0)))) is None


def test_delayed_signals_that_feed_each_other():
    def coupled(late, through):
        return replace(late, delays=replace(late.delays, through=np.array(through)))

    two, three = pure_delay(1.0, 2.0), pure_delay(1.0, 2.0, 3.0)
    assert asymptotically_stable(coupled(two, [[0.0, 1.2], [-0.4, 0.0]]))  # √0.48 < 1
    assert not asymptotically_stable(coupled(two, [[0.0, 2.6], [-0.4, 0.0]]))  # √1.04
    # Whatever the phases, this shrinks by 0.97; but the sizes of its entries do not tell.
    orthogonal = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
    with refused(value="undecided"):
        asymptotically_stable(coupled(three, 0.97 * orthogonal))


@pytest.mark.parametrize("seed", range(8))
def test_without_dead_time_the_poles_decide(seed, random_system):
    system = random_system(seed, 4, 1, 1)
    model = rational(system.A + (seed % 2) * np.eye(4), system.B, system.C, system.D)
    assert asymptotically_stable(model) is (seed % 2 == 0)
