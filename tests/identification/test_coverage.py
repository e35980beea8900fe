"""Of 200 records, the 95 % intervals hold the truth as often as 95 % intervals do."""

import functools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

import clepsydra as cl
from clepsydra.identification.arx import choose_arx, fit_arx
from clepsydra.identification.output_error import fit_output_error
from clepsydra.identification.process_batch import ProcessBatch
from clepsydra.identification.record import Record
from clepsydra.identification.residual_tests import residual_tests
from clepsydra.identification.structures import FOPDT, IPDT, SOPDT
from clepsydra.identification.uncertainty import uncertainty

pytestmark = pytest.mark.thorough

SEEDS = 200
FEWEST, MOST = (int(binom.ppf(p, SEEDS, 0.95)) for p in (0.005, 0.995))
PERIOD = 2.0
ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"


def test_the_bounds_are_those_of_the_binomial_distribution():
    assert (FEWEST, MOST) == (181, 197)
    assert binom.cdf(FEWEST - 1, SEEDS, 0.95) <= 0.005 < binom.cdf(FEWEST, SEEDS, 0.95)
    assert binom.sf(MOST, SEEDS, 0.95) <= 0.005 < binom.sf(MOST - 1, SEEDS, 0.95)


def steps(samples: int, each: int, size: float) -> np.ndarray:
    """Return an input that stands at 3 V and then moves up or down every few samples."""
    signs = np.random.default_rng(7).choice([-size, size], size=samples // each + 1)
    u = 3.0 + np.repeat(signs, each)[:samples]
    u[:6] = 3.0
    return u


def lagged(u: np.ndarray, delay: float, lags: tuple[float, ...]) -> np.ndarray:
    """Return the output of lags and dead time by integrating the states over fine steps.

    A route of its own: zero-order hold by recursion on a grid that the dead time is a multiple of.
    """
    fine = 20
    late = round(delay * fine / PERIOD)
    held = np.repeat(u - u[0], fine)
    signal = np.concatenate([np.zeros(late), held])[: len(held)]
    h = PERIOD / fine
    state = np.zeros(len(lags) or 1)
    from scipy.linalg import expm

    if lags:
        A = np.diag([-1.0 / lag for lag in lags])
        A += np.diag([1.0 / lag for lag in lags[1:]], -1)
        B = np.array([1.0 / lags[0], *[0.0] * (len(lags) - 1)])
    else:
        A, B = np.zeros((1, 1)), np.ones(1)
    n = len(B)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = A, B
    whole = expm(block * h)
    output = np.empty(len(u))
    for k, value in enumerate(signal):
        if k % fine == 0:
            output[k // fine] = state[-1]
        state = whole[:n, :n] @ state + whole[:n, n] * value
    return output


@pytest.mark.parametrize(
    ("structure", "gain", "lags", "samples"),
    [(FOPDT, 4.0, (25.0,), 120), (SOPDT, 4.0, (30.0, 8.0), 160), (IPDT, 0.05, (), 120)],
    ids=["FOPDT", "SOPDT", "IPDT"],
)
def test_transfer_functions(structure, gain, lags, samples):
    u, delay = steps(samples, 8, 0.5), 5.3
    truth = np.array([gain, *np.log(lags), delay])
    clean = 12.0 + gain * lagged(u, delay, lags)
    told = np.zeros(len(truth), int)
    alarms = np.zeros(2, int)
    for seed in range(SEEDS):
        y = clean + np.random.default_rng(seed).normal(0.0, 0.15, samples)
        fit = fit_output_error(structure, u, y, PERIOD)
        tests = residual_tests(fit.residuals, fit.jacobian, u[:, None])
        reach = uncertainty(fit.jacobian, fit.residuals, [tests.noise]).reach
        found = np.array([fit.gain, *np.log(fit.lags), fit.delay])
        told += np.abs(found - truth) <= np.delete(reach, range(1, 1 + len(fit.free)))
        alarms += np.array([tests.whiteness, tests.independence]) < 0.05
    assert np.all((told >= FEWEST) & (told <= MOST)), told
    # And the tests of white residuals speak falsely as often as they say.
    assert np.all(alarms <= binom.ppf(0.995, SEEDS, 0.05)), alarms
    assert np.all(alarms >= binom.ppf(0.005, SEEDS, 0.05)), alarms


def test_arx():
    u = steps(200, 5, 1.0)
    A, B, delay = [1.0, -1.5, 0.56], [0.0, 0.3, 0.1], 3
    late = np.concatenate([np.zeros(delay), u - 3.0])[: len(u)]
    truth = np.array([*A[1:], *B[1:]])
    told = np.zeros(4, int)
    right = 0
    for seed in range(SEEDS):
        noise = np.random.default_rng(seed).normal(0.0, 0.05, len(u))
        y = 12.0 + lfilter(B, A, late) + lfilter([1.0], A, noise)
        fit = fit_arx(u, y, order=2, delay=delay, period=PERIOD, offset=True)
        reach = uncertainty(fit.jacobian, fit.residuals).reach[:4]
        found = np.array([*fit.model.denominator, *fit.model.numerator])
        told += np.abs(found - truth) <= reach
        if seed < 100:
            chosen = choose_arx(u, y, PERIOD).model
            right += (chosen.order, chosen.delay) == (2, delay)
    assert np.all((told >= FEWEST) & (told <= MOST)), told
    assert right >= 95  # of 100: Schwarz's criterion finds order and delay


@functools.cache
def tank():
    return replace(cl.load(ONE_TANK).process, sampling_period=5.0)


def test_hole_and_pump_of_a_tank():
    process, u = tank(), steps(180, 12, 0.4) - 1.5
    names = ["outlet_1.area", "pump_1.gain"]
    clean = ProcessBatch(process, {"pump_1": u}).measured({}, np.full((1, 2), 0.05))[0, 0]
    signals = (process.inputs[0], process.measurements[0])
    truth = [*(process.signal(name).initial for name in names), 0.05]
    # The search begins elsewhere than at the truth.
    began = cl.Plant(process).with_values(
        {p.name: f"{1.2 * p.initial} {p.unit}" for p in process.parameters if p.name in names}
    )
    told = np.zeros(3, int)
    for seed in range(SEEDS):
        noise = np.random.default_rng(seed).normal(0.0, 0.001, len(u))
        record = Record("tank", signals, {"pump_1": u, "level_1": clean + noise}, 5.0)
        fit = cl.identify(record, plant=began, parameters=names)
        found = [*fit.estimates, *fit.start]
        told += [each.low <= true <= each.high for each, true in zip(found, truth, strict=True)]
    assert np.all((told >= FEWEST) & (told <= MOST)), told


def test_coloured_noise_is_covered_by_wider_intervals_only():
    """White intervals hold the truth far too seldom under coloured noise; the widened ones do."""
    u, gain, lag, delay = steps(300, 15, 0.5), 4.0, 25.0, 5.3
    clean = 12.0 + gain * lagged(u, delay, (lag,))
    seeds = 100
    told = np.zeros((2, 3), int)
    for seed in range(seeds):
        white = np.random.default_rng(seed).normal(0.0, 0.1, len(u))
        y = clean + lfilter([1.0], [1.0, -0.7], white)
        fit = fit_output_error(FOPDT, u, y, PERIOD)
        tests = residual_tests(fit.residuals, fit.jacobian, u[:, None])
        found = np.array([fit.gain, np.log(fit.lags[0]), fit.delay])
        error = np.abs(found - [gain, np.log(lag), delay])
        for row, noises in enumerate(([None], [tests.noise])):
            reach = uncertainty(fit.jacobian, fit.residuals, noises).reach
            told[row] += error <= np.delete(reach, [1, 2])
    assert np.all(told[0, :2] < 0.75 * seeds), told
    assert np.all(told[1] >= binom.ppf(0.005, seeds, 0.93)), told
