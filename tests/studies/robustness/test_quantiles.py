"""Quantiles of draws and the intervals that order statistics give them."""

import math
from fractions import Fraction

import numpy as np
import pytest
from refusals import refused
from scipy.stats import binom, quantile_test

from clepsydra.studies.robustness.quantiles import (
    draws_for_bounds,
    places,
    quantile,
    quantile_table,
)


def chances_of_counts(draws, chance):
    """How probable 0, 1, … of so many draws are, without rounding."""
    p = Fraction(str(chance))
    return [math.comb(draws, k) * p**k * (1 - p) ** (draws - k) for k in range(draws + 1)]


@pytest.mark.parametrize("chance", [0.05, 0.1, 0.5, 0.75, 0.95, 0.99])
@pytest.mark.parametrize("level", [0.5, 0.9, 0.95])
def test_bounds_are_the_innermost_places_that_hold(chance, level):
    for draws in (1, 2, 5, 6, 17, 60):
        exact = chances_of_counts(draws, chance)
        most = (1 - Fraction(str(level))) / 2
        # The place k is above the quantile where fewer than k draws are below it.
        low = [k for k in range(1, draws + 1) if sum(exact[:k]) <= most]
        high = [k for k in range(1, draws + 1) if sum(exact[k:]) <= most]
        found = places(draws, chance, level)
        assert found.low == (max(low) if low else None)
        assert found.high == (min(high) if high else None)
        fails = (sum(exact[: max(low)]) if low else 0) + (sum(exact[min(high) :]) if high else 0)
        assert found.coverage == pytest.approx(float(1 - fails), abs=1e-12)
        assert found.coverage >= level - 1e-9


def test_a_bound_that_fails_exactly_as_often_as_it_may_is_taken():
    """Of one draw of a median, half are below it; at a level of nothing that is allowed."""
    assert places(1, 0.5, 0.0)[:3] == (1, 1, 1)


@pytest.mark.parametrize("draws", [10, 30, 100, 1000])
@pytest.mark.parametrize("chance", [0.05, 0.25, 0.5, 0.9, 0.95])
def test_bounds_are_those_of_scipy(draws, chance):
    scores = np.random.default_rng(draws).normal(size=draws)
    theirs = quantile_test(scores, q=0.0, p=chance).confidence_interval(0.95)
    ours = quantile(scores, chance)
    assert [math.nan if bound is None else bound for bound in (ours.low, ours.high)] == (
        pytest.approx([theirs.low, theirs.high], abs=0.0, nan_ok=True)
    )


def test_the_quantile_is_the_score_of_a_draw():
    scores = np.random.default_rng(1).permutation(np.arange(1.0, 101.0))
    for percent in range(1, 100):
        # In doubles 0.07 · 100 is above 7, and the eighth would be found.
        assert quantile(scores, percent / 100).value == percent
    assert quantile(scores, 0.9999).value == 100.0
    assert quantile(scores, 1e-9).value == 1.0


def test_a_broken_loop_is_the_end_of_the_order():
    scores = np.append(np.arange(1.0, 91.0), np.full(10, np.inf))
    assert quantile(scores, 0.9).value == 90.0
    assert quantile(scores, 0.9).high == math.inf
    assert quantile(scores, 0.91).value == math.inf
    lower = quantile(-scores, 0.1)
    assert (lower.value, lower.low) == (-math.inf, -math.inf)
    words = quantile(scores, 0.9).words("{:.0f} s")
    assert words == "90 % of draws at or below 90 s (84 s to infinity)"


@pytest.mark.parametrize(
    ("draws", "chance", "words"),
    [
        (1, 0.5, "50 % of draws at or below 1 (no bounds: they take 6 draws)"),
        (100, 0.005, "0.5 % of draws at or below 1 (at most 3; a lower bound takes 736 draws)"),
        (6, 0.5, "50 % of draws at or below 3 (1 to 6)"),
    ],
)
def test_words(draws, chance, words):
    assert str(quantile(np.arange(1.0, draws + 1.0), chance)) == words


@pytest.mark.parametrize("chance", [0.01, 0.5, 0.8, 0.95, 0.99])
@pytest.mark.parametrize("level", [0.9, 0.95])
def test_so_many_draws_give_bounds_and_one_less_does_not(chance, level):
    needed = draws_for_bounds(chance, level)
    assert None not in places(needed, chance, level)
    assert None in places(needed - 1, chance, level)


def test_a_table_has_the_quantiles_of_each_score():
    scores = np.random.default_rng(3).normal(size=(60, 4))
    scores[:3, 1] = np.inf
    chances = [0.05, 0.5, 0.95]
    table = quantile_table(scores, chances)
    assert table.shape == (3, 3, 4)
    for row, chance in enumerate(chances):
        for column in range(4):
            one = quantile(scores[:, column], chance)
            assert table[0, row, column] == one.value
            assert table[1, row, column] == (-math.inf if one.low is None else one.low)
            assert table[2, row, column] == (math.inf if one.high is None else one.high)


def drain_times(areas):
    """Return how long tanks of uniform area [m²] take to drain through an orifice [s].

    From A dh/dt = −a √(2 g h): t = (A / a) √(2 h / g), with a = 1 cm² and h = 2 m.
    """
    return areas / 1e-4 * math.sqrt(2.0 * 2.0 / 9.81)


@pytest.mark.parametrize(("draws", "chance"), [(50, 0.5), (100, 0.9), (150, 0.95), (1000, 0.99)])
def test_quantiles_of_the_time_to_drain_lie_in_their_intervals(draws, chance):
    """In at least 95 % of repetitions: as often as the order statistics promise, exactly."""
    true = drain_times(0.8 + 0.4 * chance)
    held = 0
    for seed in range(400):
        areas = np.random.default_rng((seed, draws)).uniform(0.8, 1.2, draws)
        found = quantile(drain_times(areas), chance)
        held += found.low <= true <= found.high
    coverage = places(draws, chance).coverage
    assert coverage >= 0.95
    assert binom.ppf(5e-4, 400, coverage) <= held <= binom.isf(5e-4, 400, coverage)


def test_the_interval_of_a_few_values_holds_too():
    """Where scores tie the interval holds at least as often as it promises."""
    held = 0
    for seed in range(400):
        scores = np.random.default_rng(seed).integers(0, 4, 80).astype(float)
        found = quantile(scores, 0.6)
        held += found.low <= 2.0 <= found.high
    assert held >= binom.ppf(1e-3, 400, places(80, 0.6).coverage)


@pytest.mark.parametrize(
    ("scores", "chance", "place"),
    [
        ([], 0.5, "quantile"),
        ([1.0], 0.0, "quantile"),
        ([1.0], 1.0, "quantile"),
        ([1.0, math.nan], 0.5, "scores"),
    ],
)
def test_what_has_no_quantile_is_refused(scores, chance, place):
    with refused(place=place):
        quantile(np.array(scores), chance)
