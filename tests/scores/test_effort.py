"""Total variation and time in saturation of signals whose moves can be counted."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from refusals import refused

from clepsydra.scores.effort import TOTAL_VARIATION, time_in_saturation


def test_bang_bang_moves_the_whole_range_at_each_switch() -> None:
    time = np.arange(0.0, 50.0, 0.5)
    switches = 9
    signal = np.where((np.arange(100) // 10) % 2 == 0, 10.0, 0.0)
    assert TOTAL_VARIATION.along(time, signal) == switches * 10.0
    assert time_in_saturation(time, signal, 0.0, 10.0) == 50.0


def test_a_monotonic_signal_varies_by_its_ends() -> None:
    time = np.linspace(0.0, 10.0, 101)
    varied = TOTAL_VARIATION.along(time, 4.0 - np.exp(-time))
    assert varied == pytest.approx(1 - math.exp(-10), rel=1e-12)


def test_a_sine_varies_by_four_amplitudes_a_cycle() -> None:
    time = np.arange(0.0, 12.0 + 0.005, 0.01)
    wave = 3.0 * np.sin(2 * np.pi * time / 4.0)
    assert TOTAL_VARIATION.along(time, wave) == pytest.approx(3 * 4 * 3.0, rel=1e-12)


def test_a_limited_ramp_stands_at_its_limit_from_the_sample_that_reaches_it() -> None:
    time = np.arange(0.0, 20.0, 1.0)
    held = np.minimum(time, 10.0)
    assert time_in_saturation(time, held, 0.0, 10.0) == 11.0  # 1 s at 0, then from 10 s to 20 s
    assert time_in_saturation(time, held, -1.0, 11.0) == 0.0
    assert time_in_saturation(time, held, -math.inf, 10.0) == 10.0
    assert time_in_saturation(time, held, -math.inf, math.inf) == 0.0


def test_uneven_samples_weigh_by_their_length() -> None:
    assert time_in_saturation([0.0, 1.0, 4.0, 5.0], [1.0, 5.0, 1.0, 5.0], 0.0, 5.0) == 3.0 + 1.0


def test_close_to_a_limit_is_not_at_it() -> None:
    time = [0.0, 1.0]
    assert time_in_saturation(time, [9.999, 9.999], 0.0, 10.0) == 0.0
    assert time_in_saturation(time, [10.0 - 1e-12, 10.0 + 1e-12], 0.0, 10.0) == 2.0


def test_a_run_that_broke_off_is_infinitely_bad() -> None:
    assert TOTAL_VARIATION.along([0, 1], [1.0, math.nan]) == math.inf
    assert time_in_saturation([0, 1], [1.0, math.nan], 0.0, 5.0) == math.inf


def test_limits_in_the_wrong_order_are_refused() -> None:
    with refused(expected="a low limit below the high limit"):
        time_in_saturation([0, 1], [1.0, 1.0], 5.0, 0.0)


signals = arrays(np.float64, 15, elements=st.floats(-100.0, 100.0))
TIME = np.arange(15.0)


@settings(max_examples=25, deadline=None)
@given(signals, st.floats(-1e3, 1e3), st.floats(0.01, 100.0), st.floats(-50.0, 50.0))
def test_variation_ignores_the_hour_and_the_zero_and_scales_with_the_unit(
    signal: np.ndarray, shift: float, unit: float, zero: float
) -> None:
    moved = TOTAL_VARIATION.along(TIME + shift, zero - unit * signal)
    assert moved == pytest.approx(unit * TOTAL_VARIATION.along(TIME, signal), rel=1e-9, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(signals)
def test_variation_is_at_least_the_span(signal: np.ndarray) -> None:
    assert TOTAL_VARIATION.along(TIME, signal) >= (np.max(signal) - np.min(signal)) * (1 - 1e-12)


@settings(max_examples=25, deadline=None)
@given(signals, st.floats(1.0, 60.0))
def test_both_limits_count_alike_and_in_proportion_to_the_period(
    signal: np.ndarray, period: float
) -> None:
    limited = np.clip(signal, -40.0, 60.0)
    seen = time_in_saturation(period * TIME, limited, -40.0, 60.0)
    mirrored = time_in_saturation(period * TIME, -limited, -60.0, 40.0)
    counted = np.count_nonzero((signal <= -40.0) | (signal >= 60.0))
    near = np.count_nonzero((np.abs(signal + 40.0) < 1e-6) | (np.abs(signal - 60.0) < 1e-6))
    assert seen == pytest.approx(mirrored, rel=1e-12)
    assert period * counted * (1 - 1e-12) <= seen <= period * (counted + near) * (1 + 1e-12)
