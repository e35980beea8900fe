"""Least squares: exact on its own class, honest intervals, and what is refused."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

from clepsydra import InputError
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.identification.arx import fit_arx, regressors
from clepsydra.identification.uncertainty import uncertainty

TRUE = SampledModel((0.05, 0.03), (-1.4, 0.5), 3, 60.0)
NOISE = 0.02


def record(seed, samples=300, noise=NOISE):
    """An ARX process with white noise e(k): y = z^-d B/A u + e/A."""
    random = np.random.default_rng(seed)
    u, e = random.normal(size=samples), noise * random.normal(size=samples)
    return u, TRUE.output(u) + lfilter([1.0], TRUE.A, e)


def test_without_noise_the_model_is_found():
    fit = fit_arx(*record(0, noise=0.0), order=2, delay=3, period=60.0)
    assert fit.coefficients == pytest.approx([-1.4, 0.5, 0.05, 0.03], abs=1e-12)
    assert fit.model.period == 60.0 and fit.model.delay == 3


def test_the_estimate_is_that_of_the_normal_equations():
    """(12), and the covariance s² (FᵀF)⁻¹."""
    u, y = record(1)
    fit = fit_arx(u, y, order=2, delay=3, period=60.0)
    rows = [[-y[k - 1], -y[k - 2], u[k - 4], u[k - 5]] for k in range(5, 300)]
    F, target = np.array(rows), y[5:]
    assert np.array_equal(regressors(u, y, 2, 3)[0], F)
    theta = np.linalg.solve(F.T @ F, F.T @ target)
    assert fit.coefficients == pytest.approx(theta, rel=1e-9)
    assert fit.cost == pytest.approx(np.sum((target - F @ theta) ** 2), rel=1e-9)
    variance = fit.cost / (len(target) - 4)
    sure = uncertainty(fit.jacobian, fit.residuals)
    assert sure.covariance == pytest.approx(variance * np.linalg.inv(F.T @ F), rel=1e-7)


def test_intervals_cover_the_truth_as_often_as_they_say():
    """400 records: for each parameter the count lies inside the binomial 99 % bounds."""
    truth, covered = np.array([-1.4, 0.5, 0.05, 0.03]), np.zeros(4)
    for seed in range(400):
        fit = fit_arx(*record(seed), order=2, delay=3, period=60.0)
        reach = uncertainty(fit.jacobian, fit.residuals).reach
        covered += np.abs(fit.coefficients - truth) <= reach
    low, high = binom.interval(0.99, 400, 0.95)
    assert np.all((covered >= low) & (covered <= high)), covered


def test_data_that_cannot_be_fitted_are_refused():
    """A step that comes too late for any answer, and nine samples of four parameters."""
    _, y = record(3)
    with pytest.raises(InputError, match="more than a step"):
        fit_arx(np.arange(300.0) >= 298, y, order=2, delay=3, period=60.0)
    with pytest.raises(InputError, match="tells 4 parameters apart"):
        fit_arx(np.arange(9.0), np.arange(9.0) ** 2, order=2, delay=3, period=60.0)
