"""Travel and reversals of signals whose moves can be counted."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from clepsydra.scores.effort import TOTAL_VARIATION, peak_move, reversals, travel, turns

HOUR = np.arange(3600.0)


def test_a_sine_travels_four_amplitudes_and_turns_twice_a_cycle() -> None:
    for cycles in (1, 6, 24):
        wave = 50.0 + 30.0 * np.sin(2 * np.pi * cycles * HOUR / 3600.0)
        # The actuator lags by at most the resolution at each turn.
        assert travel(HOUR, wave, 0.0, 100.0) == pytest.approx(120.0 * cycles, rel=0.005), cycles
        assert reversals(HOUR, wave, 0.0, 100.0) == 2 * cycles, cycles


def test_rounding_and_small_noise_wear_nothing_although_they_vary() -> None:
    noise = np.random.default_rng(1).uniform(-0.049, 0.049, HOUR.size)
    assert TOTAL_VARIATION.along(HOUR, 50.0 + noise) > 100.0
    assert travel(HOUR, 50.0 + noise, 0.0, 100.0) == 0.0
    assert reversals(HOUR, 50.0 + noise, 0.0, 100.0) == 0.0
    # On a ramp the same noise adds no way and no turns.
    ramp = 80.0 * HOUR / 3600.0
    assert travel(HOUR, 10.0 + ramp + noise, 0.0, 100.0) == pytest.approx(80.0, abs=0.2)
    assert reversals(HOUR, 10.0 + ramp + noise, 0.0, 100.0) == 0.0


def test_slow_creep_is_travelled_although_each_move_is_below_the_resolution() -> None:
    creep = 50.0 + 0.01 * np.arange(1000)
    assert travel(np.arange(1000.0) * 3.6, creep, 0.0, 100.0) == pytest.approx(9.99, abs=0.11)


@pytest.mark.parametrize(
    ("signal", "turns"),
    [
        ([5.0, 5.0, 5.0], 0),
        ([5.0, 6.0, 7.0], 0),
        ([5.0, 6.0, 5.0], 1),
        ([5.0, 4.0, 5.0, 4.0], 2),
        ([5.0, 6.0, 5.995, 6.0, 5.995], 0),
        ([5.0, 6.0, 5.995, 5.98], 1),
        ([5.0, 5.005, 4.996, 5.5], 0),
    ],
)
def test_turns_counted_by_hand(signal: list[float], turns: int) -> None:
    assert reversals(range(len(signal)), signal, 0.0, 10.0) == turns
    assert reversals(range(len(signal)), [-x for x in signal], -10.0, 0.0) == turns


def test_peak_move_is_from_the_beginning_whatever_the_zero() -> None:
    assert peak_move([0, 1, 2, 3], [2.0, 5.0, -4.0, 2.0]) == 6.0
    assert peak_move([0, 1, 2, 3], [102.0, 105.0, 96.0, 102.0]) == 6.0
    assert peak_move([0, 1], [0.0, math.nan]) == math.inf


def test_a_run_that_broke_off_is_infinitely_bad() -> None:
    for score in (travel, reversals):
        assert score([0, 1], [1.0, math.nan], 0.0, 10.0) == math.inf, score.__name__


signals = arrays(np.float64, 30, elements=st.integers(-50, 50).map(float))


@settings(max_examples=25, deadline=None)
@given(signals, st.sampled_from([0.25, 2.0, 1024.0]), st.sampled_from([0.5, 64.0]))
def test_both_are_free_of_unit_and_travel_falls_with_the_hours(
    signal: np.ndarray, unit: float, slower: float
) -> None:
    time = np.arange(30.0)
    way, turns = travel(time, signal, -64.0, 64.0), reversals(time, signal, -64.0, 64.0)
    scaled = (slower * time, -unit * signal, -64.0 * unit, 64.0 * unit)
    assert travel(*scaled) == pytest.approx(way / slower, rel=1e-12)
    assert reversals(*scaled) == turns


@settings(max_examples=25, deadline=None)
@given(signals)
def test_travel_is_the_total_variation_where_every_move_is_large(signal: np.ndarray) -> None:
    time = np.arange(30.0)
    share = TOTAL_VARIATION.along(time, signal) / 128.0
    assert travel(time, signal, -64.0, 64.0) == pytest.approx(100 * share * 120.0, rel=1e-12)


@settings(max_examples=25, deadline=None)
@given(signals)
def test_turns_are_the_changes_of_sign_of_the_moves(signal: np.ndarray) -> None:
    signs = [sign for sign in np.sign(np.diff(signal)) if sign]
    changes = sum(a != b for a, b in pairwise(signs))
    assert reversals(np.arange(30.0), signal, -64.0, 64.0) == changes


def turns_by_every_value(signal: list[float], band: float) -> int:
    """Return the turns by looking at every value in its turn, also where it only goes on."""
    extreme, found, up = [signal[0], signal[0]], [], None
    for value in signal:
        extreme = [min(extreme[0], value), max(extreme[1], value)]
        for rises in (False, True) if up is None else (not up,):
            if abs(value - extreme[0 if rises else 1]) > band:
                found.append(rises)
                up, extreme[rises] = rises, value
                break
    return len(found) - 1 if found else 0


@pytest.mark.parametrize("seed", range(20))
def test_what_lies_between_two_turns_does_not_count(seed: int) -> None:
    random = np.random.default_rng(seed)
    signal = np.cumsum(random.choice([0.0, 0.3, 1.0, -1.0, -0.4, 2.0, -2.0], 300))
    for band in (0.0, 0.5, 1.5, 4.0):
        assert turns(signal, band) == turns_by_every_value(signal.tolist(), band)
