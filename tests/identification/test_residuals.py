"""Noise models, tests of residuals and widened intervals against explicit matrices."""

import numpy as np
import pytest
from refusals import refused
from scipy.linalg import solve_toeplitz, toeplitz
from scipy.signal import lfilter
from scipy.stats import f, linregress

from clepsydra.identification.residual_tests import (
    NoiseModel,
    ResidualTests,
    noise_model,
    residual_tests,
)
from clepsydra.identification.uncertainty import uncertainty

SHAPE = np.stack([np.ones(400), np.sin(np.arange(400) / 30.0)], axis=1)


def coloured(seed, c=0.8):
    white = np.random.default_rng(seed).normal(0.0, 1.0, 400)
    return lfilter([1.0], [1.0, -c], white)


def test_levinson_and_durbin_solve_the_yule_walker_equations():
    residuals = coloured(3)
    model = noise_model(residuals)
    order = len(model.coefficients) - 1
    r = np.array([residuals[k:] @ residuals[: 400 - k] for k in range(order + 1)]) / 400
    assert model.coefficients[1:] == pytest.approx(-solve_toeplitz(r[:-1], r[1:]), rel=1e-9)
    assert model.variance == pytest.approx(r @ model.coefficients, rel=1e-9)


def test_white_residuals_need_no_noise_model():
    """Schwarz's criterion takes an order above zero for few of them."""
    records = [np.random.default_rng(seed).normal(0.0, 1.0, 400) for seed in range(50)]
    assert sum(len(noise_model(white).coefficients) > 1 for white in records) <= 5


def test_widened_covariance_is_that_of_the_whole_noise_covariance():
    """(J'J)⁻¹ J'ΩJ (J'J)⁻¹ with Ω written out, r(k) = 0.8^k / (1 − 0.64)."""
    noise = NoiseModel(np.array([1.0, -0.8]), 1.0)
    residuals = coloured(5)
    Ω = toeplitz(0.8 ** np.arange(400) / (1.0 - 0.64))
    inverse = np.linalg.inv(SHAPE.T @ SHAPE)
    expected = inverse @ SHAPE.T @ Ω @ SHAPE @ inverse * 400 / 398
    found = uncertainty(SHAPE, residuals, [noise])
    # The filter starts from rest, which leaves out a few samples of 400.
    assert found.deviations == pytest.approx(np.sqrt(np.diag(expected)), rel=0.02)
    assert 2.0 < found.widening < 3.1  # √((1 + 0.8)/(1 − 0.8)) = 3 for a constant


def test_no_interval_gets_narrower_by_its_colour():
    residuals = lfilter([1.0], [1.0, 0.8], np.random.default_rng(2).normal(0.0, 1.0, 400))
    white = uncertainty(SHAPE, residuals)
    found = uncertainty(SHAPE, residuals, [noise_model(residuals)])
    assert found.deviations == pytest.approx(white.deviations, rel=1e-9)


def test_intervals_of_a_line_are_those_of_linear_regression():
    x = np.arange(30.0)
    y = 2.0 + 0.5 * x + np.random.default_rng(6).normal(0.0, 1.0, 30)
    line = linregress(x, y)
    J = np.stack([np.ones(30), x], axis=1)
    left = y - line.intercept - line.slope * x
    found = uncertainty(J, left)
    assert found.deviations == pytest.approx([line.intercept_stderr, line.stderr], rel=1e-9)
    assert found.reach_of(np.array([0.0, 1.0])) == pytest.approx(found.reach[1], rel=1e-12)


def test_columns_that_depend_on_each_other_are_refused():
    J = np.stack([np.ones(30), np.full(30, 2.0)], axis=1)
    with refused(expected="tells 2 parameters apart"):
        uncertainty(J, np.ones(30))


def test_the_tests_tell_slow_noise_from_missing_dynamics():
    u = np.repeat(np.random.default_rng(4).choice([-1.0, 1.0], 50), 8)[:, None]
    slow = residual_tests(coloured(7), SHAPE, u)
    assert not slow.white and slow.independent and "disturbances are slow" in slow.words
    white = np.random.default_rng(8).normal(0.0, 1.0, 400)
    missed = lfilter([0.0, 0.5], [1.0, -0.8], u[:, 0])
    short = residual_tests(white + missed, SHAPE, u)
    assert not short.independent and "the process does more" in short.words
    good = residual_tests(white, SHAPE, u)
    assert good.white and good.independent and good.noise is None


SMOOTH = np.cos(np.pi * np.outer(np.arange(80.0) + 0.5, np.arange(9.0)) / 80.0)


def left_by_fit(values):
    """Return what a fit of nine cosines leaves of values [80]."""
    return values - SMOOTH @ np.linalg.lstsq(SMOOTH, values, rcond=None)[0]


def written_out(residuals, jacobian, moved):
    """Return the probability of the F test of two nested regressions, by their sums of squares."""
    return nested(residuals, jacobian, late_by(moved))


def late_by(moved):
    """Return a signal [N] late by each lag that is tried."""
    lags = np.unique(np.rint(np.geomspace(1, len(moved) // 8, 6)).astype(int))
    return np.stack([np.concatenate([np.zeros(k), moved[:-k]]) for k in lags], axis=1)


def nested(residuals, jacobian, late):
    both = np.concatenate([jacobian, late], axis=1)
    left = [np.linalg.lstsq(each, residuals, rcond=None)[1][0] for each in (jacobian, both)]
    further, freedom = late.shape[1], len(residuals) - both.shape[1]
    return f.sf((left[0] - left[1]) / further / (left[1] / freedom), further, freedom)


@pytest.mark.parametrize("seed", range(4))
def test_independence_is_the_f_test_of_two_nested_regressions(seed):
    generator = np.random.default_rng(seed)
    u = 3.0 + np.repeat(generator.choice([-1.0, 1.0], 16), 5)
    residuals = left_by_fit(generator.normal(0.0, 1.0, 80) + 0.3 * np.roll(u, 2))
    found = residual_tests(residuals, SMOOTH, u[:, None])
    assert found.white
    expected = written_out(residuals, SMOOTH, u - u[0])
    assert 1e-6 < expected < 0.9
    assert found.independence == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_whiteness_is_the_f_test_of_lags_less_what_the_fit_makes_of_white_noise(seed):
    """With all matrices written out: e = M w for white w, and E[e'Lₖe] = s² tr(M Lₖ)."""
    residuals = left_by_fit(lfilter([1.0, 0.3], [1.0], np.random.default_rng(seed).normal(size=80)))
    M = np.eye(80) - SMOOTH @ np.linalg.solve(SMOOTH.T @ SMOOTH, SMOOTH.T)
    lags = [np.eye(80, k=-k) for k in range(1, 7)]  # a twelfth of the record
    late = np.stack([L @ residuals for L in lags], axis=1)
    by_chance = residuals @ residuals / (80 - 9) * np.array([np.trace(M @ L) for L in lags])
    products = late.T @ residuals - by_chance
    explained = products @ np.linalg.solve(late.T @ M @ late, products)
    freedom = 80 - 9 - 6
    ratio = explained / 6 / ((residuals @ residuals - explained) / freedom)
    found = residual_tests(residuals, SMOOTH, SMOOTH[:, :0])
    assert found.whiteness == pytest.approx(f.sf(ratio, 6, freedom), rel=1e-6)


def test_an_input_given_twice_tells_nothing_more():
    generator = np.random.default_rng(1)
    u = np.repeat(generator.choice([-1.0, 1.0], 16), 5)
    residuals = left_by_fit(generator.normal(0.0, 1.0, 80) + 0.3 * np.roll(u, 2))
    once = residual_tests(residuals, SMOOTH, u[:, None]).independence
    twice = residual_tests(residuals, SMOOTH, np.stack([u, 3.0 * u], axis=1)).independence
    assert twice == pytest.approx(once, rel=1e-6) and 1e-6 < once < 0.9


def test_a_test_speaks_below_one_in_a_hundred():
    for probability, silent in ((0.0101, True), (0.0099, False)):
        assert ResidualTests(probability, 1.0, None).white is silent, probability
        assert ResidualTests(1.0, probability, None).independent is silent, probability


def test_of_coloured_residuals_everything_is_whitened_first():
    generator = np.random.default_rng(2)
    u = np.repeat(generator.choice([-1.0, 1.0], 16), 5)
    residuals = lfilter([1.0], [1.0, -0.9], generator.normal(0.0, 1.0, 80))
    jacobian = SMOOTH[:, :2]
    found = residual_tests(residuals, jacobian, u[:, None])
    assert not found.white
    white = [
        lfilter(found.noise.coefficients, [1.0], each, axis=0)
        for each in (residuals, jacobian, late_by(u - u[0]))
    ]
    assert found.independence == pytest.approx(nested(*white), rel=1e-6)


def test_what_the_fit_itself_takes_out_is_no_sign_of_colour():
    """White noise less nine smooth columns is correlated, and seldom called so."""
    chances = []
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0.0, 1.0, 80)
        chances.append(residual_tests(left_by_fit(noise), SMOOTH, SMOOTH[:, :0]).whiteness)
    assert np.mean(np.array(chances) < 0.2) < 0.28  # binomial 99.9 % bound of 20 % of 200


def test_what_rounding_leaves_tells_nothing():
    u = np.repeat([1.0, -1.0], 40)[:, None]
    found = residual_tests(1e-15 * u[:, 0], SMOOTH[:, :1], u, rounding=1e-14)
    assert (found.whiteness, found.independence, found.noise) == (1.0, 1.0, None)
    assert not residual_tests(1e-13 * u[:, 0], SMOOTH[:, :1], u, rounding=1e-14).white


def test_coloured_noise_alone_raises_no_alarm_about_the_input():
    """Whitened, the second test speaks falsely about as often as it says."""
    u = np.repeat(np.random.default_rng(4).choice([-1.0, 1.0], 50), 8)[:, None]
    alarms = sum(
        residual_tests(coloured(seed), SHAPE, u).independence < 0.05 for seed in range(200)
    )
    assert 1 <= alarms <= 22  # binomial 99.9 % bounds of 5 % of 200
