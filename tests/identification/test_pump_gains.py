"""The gain of a pump: exact data, coverage of the interval, and what is refused."""

import numpy as np
import pytest
from scipy.stats import binom

from clepsydra import InputError
from clepsydra.identification.pump_gains import pump_gain

AREA, GAIN = 15.5179e-4, 4.32e-6


def recorded(signal, step, noise=None):
    """Levels of a plugged tank, the flow held over each sample."""
    flow = GAIN * np.maximum(signal[:-1], 0.0) * (1.0 if noise is None else 1.0 + noise)
    return np.concatenate([[0.0], np.cumsum(flow * step / AREA)])


def test_exact_data_give_the_gain():
    signal = np.array([3.0, 5.0, 0.0, 7.5, 2.0, 1.0])
    gain, reach = pump_gain(np.arange(6.0) * 0.5, recorded(signal, 0.5), signal, AREA)
    assert gain == pytest.approx(GAIN, rel=1e-12)
    assert reach < 1e-9 * GAIN


def test_dead_band():
    signal = np.array([3.0, 5.0, 1.0, 7.5, 2.0, 1.0])
    level = recorded(signal - 1.5, 0.5)
    assert pump_gain(np.arange(6.0) * 0.5, level, signal, AREA, dead_band=1.5)[0] == (
        pytest.approx(GAIN, rel=1e-12)
    )


def test_the_interval_covers_the_truth_as_often_as_it_says():
    """400 fixed seeds, flow noise of 10 % in each of 40 samples: Student's interval is exact."""
    time, signal, covered = np.arange(41) * 0.05, np.full(41, 7.5), 0
    for seed in range(400):
        noise = 0.1 * np.random.default_rng(seed).standard_normal(40)
        gain, reach = pump_gain(time, recorded(signal, 0.05, noise), signal, AREA)
        covered += abs(gain - GAIN) <= reach
    low, high = binom.ppf([0.005, 0.995], 400, 0.95)
    assert low <= covered <= high


def test_the_interval_is_students():
    """Rises of 1, 2, 4, 5 and 8 m³ have the mean 4 and the standard error 1.2247."""
    level = np.concatenate([[0.0], np.cumsum([1.0, 2.0, 4.0, 5.0, 8.0])])
    gain, reach = pump_gain(np.arange(6.0), level, np.ones(6), 1.0)
    # t(0.975, 4) = 2.7764, from a table.
    assert (gain, reach) == pytest.approx((4.0, 1.2247 * 2.7764), abs=1e-3)


def test_a_pump_that_stands_still_is_refused():
    with pytest.raises(InputError, match="tells 1 parameters apart"):
        pump_gain(np.arange(4.0), np.arange(4.0), np.zeros(4), AREA)
