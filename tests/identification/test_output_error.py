"""Output-error fits against SciPy's curve_fit, and where the minimum has neighbours."""

import numpy as np
import pytest
from scipy.optimize import curve_fit

from clepsydra.identification.output_error import fit_output_error, held_response
from clepsydra.identification.structures import FOPDT, IPDT, SOPDT
from clepsydra.identification.uncertainty import uncertainty


def moves(samples=180, each=9, seed=3):
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], samples // each + 1)
    u = 3.0 + np.repeat(signs, each)[:samples]
    u[:4] = 3.0
    return u


def simulated(structure, u, period, gain, lags, delay, free):
    time = period * np.arange(len(u))
    found = structure.responses(np.maximum(time - delay, 0.0), time, np.array(lags))
    return gain * held_response(u, found.step) + found.free @ np.array(free)


@pytest.mark.parametrize(
    ("structure", "lags", "free"),
    [
        (FOPDT, [25.0], [12.0, 1.5]),
        (SOPDT, [30.0, 9.0], [12.0, 0.5, 0.3]),
        (IPDT, [], [12.0, 0.02]),
    ],
    ids=["FOPDT", "SOPDT", "IPDT"],
)
@pytest.mark.parametrize("delay", [0.0, 5.3, 44.7])
def test_without_noise_the_truth_is_found(structure, lags, free, delay):
    """Also the initial motion, no dead time at all, and one of 22 samples."""
    u = moves()
    y = simulated(structure, u, 2.0, -0.7, lags, delay, free)
    fit = fit_output_error(structure, u, y, 2.0)
    assert fit.gain == pytest.approx(-0.7, rel=1e-6)
    assert fit.lags == pytest.approx(lags, rel=1e-5)
    assert fit.delay == pytest.approx(delay, abs=1e-4)
    assert fit.free == pytest.approx(free, rel=1e-4)
    assert np.max(np.abs(fit.residuals)) < 1e-6
    assert fit.simulated(u) == pytest.approx(y, abs=1e-6)


def test_estimates_and_covariance_are_those_of_curve_fit():
    """The same model handed to SciPy as a black box, with its own numeric Jacobian."""
    u, period = moves(), 2.0
    truth = [4.0, 12.0, 1.5, np.log(25.0), 5.3]
    random = np.random.default_rng(11)

    def model(_, gain, rest, moving, log_lag, delay):
        return simulated(FOPDT, u, period, gain, [np.exp(log_lag)], delay, [rest, moving])

    y = model(None, *truth) + random.normal(0.0, 0.2, len(u))
    found, covariance = curve_fit(
        model, np.arange(len(u)), y, p0=truth, xtol=1e-12, ftol=1e-12, gtol=1e-12
    )
    fit = fit_output_error(FOPDT, u, y, period)
    ours = [fit.gain, *fit.free, np.log(fit.lags[0]), fit.delay]
    deviations = np.sqrt(np.diag(covariance))
    assert np.max(np.abs(ours - found) / deviations) < 1e-3
    sure = uncertainty(fit.jacobian, fit.residuals)
    assert sure.deviations == pytest.approx(deviations, rel=1e-3)
    assert sure.covariance == pytest.approx(
        covariance, rel=5e-3, abs=1e-3 * np.min(deviations) ** 2
    )


def test_the_jacobian_is_that_of_finite_differences():
    u, period = moves(), 2.0
    y = simulated(SOPDT, u, period, 4.0, [30.0, 9.0], 5.3, [12.0, 0.5, 0.3])
    y += np.random.default_rng(2).normal(0.0, 0.1, len(u))
    fit = fit_output_error(SOPDT, u, y, period)
    at = np.array([fit.gain, *fit.free, *np.log(fit.lags), fit.delay])

    def output(p):
        return simulated(SOPDT, u, period, p[0], np.exp(p[4:6]), p[6], p[1:4])

    for place in range(len(at)):
        h = 1e-5 * np.eye(len(at))[place]
        slope = (output(at + h) - output(at - h)) / 2e-5
        assert fit.jacobian[:, place] == pytest.approx(slope, abs=1e-6), place


def test_a_model_runs_on_beyond_its_record():
    """Simulating 60 rows more changes nothing in the rows before."""
    u = moves(240)
    y = simulated(FOPDT, u, 2.0, 4.0, [25.0], 5.3, [12.0, 1.5])
    fit = fit_output_error(FOPDT, u[:180], y[:180], 2.0)
    assert fit.simulated(u) == pytest.approx(y, abs=1e-5)
    assert fit.simulated(u)[:180] == pytest.approx(fit.simulated(u[:180]), abs=1e-9)


def test_a_long_record_is_fitted_from_a_coarse_grid():
    """20,000 rows; the dead time is 700 of them."""
    u = moves(20_000, 500)
    y = simulated(FOPDT, u, 0.1, 4.0, [40.0], 70.03, [12.0, 1.5])
    y += np.random.default_rng(4).normal(0.0, 0.1, len(u))
    fit = fit_output_error(FOPDT, u, y, 0.1)
    found = np.array([fit.gain, np.log(fit.lags[0]), fit.delay])
    reach = 2.0 * uncertainty(fit.jacobian, fit.residuals).reach
    assert np.all(np.abs(found - [4.0, np.log(40.0), 70.03]) < np.delete(reach, [1, 2]))


def test_a_process_of_first_order_sends_the_second_lag_to_its_bound():
    u = moves()
    y = simulated(FOPDT, u, 2.0, 4.0, [25.0], 6.0, [12.0, 0.0])
    y += np.random.default_rng(1).normal(0.0, 0.01, len(u))
    fit = fit_output_error(SOPDT, u, y, 2.0)
    assert fit.lags[1] < 2.0 and fit.lags[0] == pytest.approx(25.0, rel=0.02)
