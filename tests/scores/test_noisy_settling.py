"""Settling under noise: the settling time without it, and what noise may not change."""

import math

import numpy as np
import pytest

from clepsydra.scores.load_response import offset
from clepsydra.scores.step_response import settling_time_under_noise

T = 40.0
PERIOD = 0.5
TIME = np.arange(0.0, 1200.0, PERIOD)
RESPONSE = 1.0 - np.exp(-TIME / T)


@pytest.mark.parametrize(("start", "target"), [(0.0, 1.0), (6.0, 8.5), (8.5, 6.0)])
def test_without_noise_it_is_the_settling_time_up_to_a_sample(start: float, target: float) -> None:
    output = start + (target - start) * RESPONSE
    for band, times in ((0.05, math.log(20.0)), (0.02, math.log(50.0))):
        seen = settling_time_under_noise(TIME, output, start, target, 0.0, band=band)
        assert 0.0 <= seen - times * T <= PERIOD, band


def test_noise_that_is_wider_than_the_band_widens_it() -> None:
    """With σ = 4 % of the step the band is 12 %, which an exponential enters after T ln(1/0.12)."""
    seen = settling_time_under_noise(TIME, RESPONSE, 0.0, 1.0, 0.04)
    assert 0.0 <= seen - T * math.log(1 / 0.12) <= PERIOD


@pytest.mark.parametrize("seed", range(10))
def test_noise_moves_the_answer_by_less_than_it_moves_the_response(seed: int) -> None:
    """Three σ either side of the band's edge, the exponential crosses within a known stretch."""
    deviation = 0.02
    noisy = RESPONSE + np.random.default_rng(seed).normal(0.0, deviation, TIME.size)
    seen = settling_time_under_noise(TIME, noisy, 0.0, 1.0, deviation)
    band = 3 * deviation
    assert T * math.log(1 / (band + 2.5 * deviation)) <= seen
    assert seen <= T * math.log(1 / (band - 2.5 * deviation)) + 3 * PERIOD
    # A rule without allowance for noise finds single samples outside until late in the record.
    outside = np.flatnonzero(np.abs(noisy - 1.0) > band)
    assert TIME[outside[-1]] > 2 * seen


def test_single_samples_outside_do_not_count_and_three_do() -> None:
    for count, settled in ((1, 0.0), (2, 0.0), (3, 53 * PERIOD)):
        output = np.ones(100)
        output[50 : 50 + count] = 1.2
        assert settling_time_under_noise(TIME[:100], output, 0.0, 1.0, 0.0) == settled, count
    output = np.ones(100)
    output[50:53] = [1.2, 0.8, 1.2]
    assert settling_time_under_noise(TIME[:100], output, 0.0, 1.0, 0.0) == 0.0


def test_what_ends_outside_never_settles() -> None:
    assert settling_time_under_noise(TIME, 0.9 * RESPONSE, 0.0, 1.0, 0.0) == math.inf
    assert settling_time_under_noise([0, 1], [0.0, math.nan], 0.0, 1.0, 0.0) == math.inf
    assert settling_time_under_noise([0, 1], [0.0, 0.5], 0.0, 1.0, 0.0) == math.inf
    assert settling_time_under_noise([0, 1], [0.0, 1.0], 0.0, 1.0, 0.0) == 0.0


def test_it_scales_with_units_and_ignores_place() -> None:
    noisy = RESPONSE + np.random.default_rng(3).normal(0.0, 0.01, TIME.size)
    plain = settling_time_under_noise(TIME, noisy, 0.0, 1.0, 0.01)
    # Powers of two, so that no comparison at the edge of the band is rounded otherwise.
    moved = settling_time_under_noise(64 * TIME, -4 * noisy, 0.0, -4.0, 0.04)
    assert moved == 64 * plain


def test_offset_of_an_exponential_and_of_a_ramp() -> None:
    """The mean of e^(-t/T) over [0.9 L, L], and of r t over the same."""
    time = np.linspace(0.0, 200.0, 20001)
    setpoint = np.full_like(time, 2.0)
    mean = T * (math.exp(-180.0 / T) - math.exp(-200.0 / T)) / 20.0
    output = 2.0 - 0.3 - np.exp(-time / T)
    assert offset(time, setpoint, output) == pytest.approx(0.3 + mean, rel=1e-6)
    assert offset(time, setpoint, 2.0 + 0.01 * time) == pytest.approx(-0.01 * 190.0, rel=1e-9)
    assert offset(time, 10 * setpoint, 10 * output) == pytest.approx(10 * (0.3 + mean), rel=1e-6)
    assert offset(time, setpoint, np.where(time > 5, math.nan, 1.0)) == math.inf
    assert offset([0.0, 1.0], [1.0, 1.0], [0.5, 0.0]) == 0.75
