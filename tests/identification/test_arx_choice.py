"""ARX with a constant against numpy.linalg.lstsq and a recursion by hand."""

import numpy as np
import pytest
from refusals import refused
from scipy.signal import lfilter

from clepsydra.identification.arx import choose_arx, fit_arx
from clepsydra.identification.uncertainty import uncertainty


@pytest.fixture(scope="module")
def record():
    random = np.random.default_rng(8)
    u = 5.0 + np.repeat(random.choice([-1.0, 1.0], 40), 5)
    late = np.concatenate([np.zeros(3), u - 5.0])[:200]
    noise = lfilter([1.0], [1.0, -1.5, 0.56], random.normal(0.0, 0.05, 200))
    return u, 12.0 + lfilter([0.0, 0.3, 0.1], [1.0, -1.5, 0.56], late) + noise


def test_it_is_the_least_squares_solution(record):
    u, y = record
    fit = fit_arx(u, y, order=2, delay=3, period=1.0, offset=True)
    rows = range(5, 200)
    F = np.array([[-y[k - 1], -y[k - 2], u[k - 4], u[k - 5], 1.0] for k in rows])
    theta, cost, *_ = np.linalg.lstsq(F, y[5:], rcond=None)
    found = [*fit.model.denominator, *fit.model.numerator, fit.offset]
    assert found == pytest.approx(theta, rel=1e-9)
    assert fit.residuals @ fit.residuals == pytest.approx(cost[0], rel=1e-9)
    covariance = cost[0] / (195 - 5) * np.linalg.inv(F.T @ F)
    sure = uncertainty(fit.jacobian, fit.residuals)
    assert sure.deviations == pytest.approx(np.sqrt(np.diag(covariance)), rel=1e-6)


def test_it_finds_order_and_delay(record):
    model = choose_arx(*record, 1.0).model
    assert (model.order, model.delay) == (2, 3)


def test_simulation_is_the_recursion(record):
    u, y = record
    fit = fit_arx(u, y, order=2, delay=3, period=1.0, offset=True)
    (a1, a2), (b1, b2) = fit.model.denominator, fit.model.numerator
    before = np.concatenate([np.full(5, u[0]), u])  # u stood at its first value
    expected = [y[0], y[1]]
    for k in range(2, 200):
        driven = b1 * before[5 + k - 4] + b2 * before[5 + k - 5]
        expected.append(-a1 * expected[-1] - a2 * expected[-2] + driven + fit.offset)
    assert fit.simulated(u, y) == pytest.approx(expected, rel=1e-9)


def test_a_single_pulse_of_two_samples_is_refused():
    u = np.zeros(60)
    with refused(expected="tells its parameters apart"):
        choose_arx(u, np.sin(np.arange(60.0)), 1.0)


def test_an_output_that_moves_once_and_then_stands_still_is_fitted():
    """Past its first rows nothing is left to choose a model by."""
    signal, output = np.eye(40)[10], np.eye(40)[10]
    fit = choose_arx(signal, output, 1.0)
    assert np.all(np.isfinite(fit.residuals))
