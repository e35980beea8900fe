"""Shares of draws, their Wilson intervals and their words."""

import re

import numpy as np
import pytest
from refusals import refused
from scipy.stats import binom, binomtest

from clepsydra.studies.robustness.shares import share_of, wilson_interval


@pytest.mark.parametrize("level", [0.8, 0.95, 0.999])
def test_the_interval_is_that_of_scipy(level):
    for of in (1, 2, 7, 100, 10_000, 10**9):
        counts = sorted({0, 1, of // 3, of - 1, of})
        low, high = wilson_interval(np.array(counts), np.array(of), level)
        for n, count in enumerate(counts):
            theirs = binomtest(count, of).proportion_ci(level, method="wilson")
            # Both are roots of one quadratic; a small one is a difference of nearly equal terms.
            assert low[n] == pytest.approx(theirs.low, rel=1e-12, abs=1e-15)
            assert high[n] == pytest.approx(theirs.high, rel=1e-12, abs=1e-15)


def test_bounds_of_what_never_and_what_always_happened():
    never, always = share_of(0, 50), share_of(50, 50)
    assert (never.low, always.high) == (0.0, 1.0)
    assert never.high == pytest.approx(3.841458821 / (50 + 3.841458821), rel=1e-9)
    assert always.low == pytest.approx(1.0 - never.high, rel=1e-12)


@pytest.mark.parametrize(
    ("count", "of", "words"),
    [
        (0, 10_000, "0 of 10,000 draws, at most 0.04 %"),
        (320, 10_000, "3.2 % of 10,000 draws (2.9 to 3.6 %)"),
        (10_000, 10_000, "10,000 of 10,000 draws, at least 99.96 %"),
        (0, 20, "0 of 20 draws, at most 17 %"),
        (5, 20, "25 % of 20 draws (11 to 47 %)"),
        (9_680, 10_000, "96.8 % of 10,000 draws (96.4 to 97.1 %)"),
    ],
)
def test_words(count, of, words):
    assert str(share_of(count, of)) == words


@pytest.mark.parametrize("of", [3, 20, 100, 1000, 10**6])
def test_no_bound_is_rounded_to_never_or_always(of):
    for count in {1, 2, of // 2, of - 2, of - 1} - {0, of}:
        value, low, high = map(
            float,
            re.fullmatch(
                r"([\d.]+) % of .* \(([\d.]+) to ([\d.]+) %\)", str(share_of(count, of))
            ).groups(),
        )
        assert 0.0 < low < value < high < 100.0


def test_one_sided_bounds_are_rounded_outward():
    for of in range(2, 3000, 7):
        most = float(re.search(r"most ([\d.]+) %", str(share_of(0, of)))[1])
        least = float(re.search(r"least ([\d.]+) %", str(share_of(of, of)))[1])
        assert most >= 100.0 * share_of(0, of).high
        assert least <= 100.0 * share_of(of, of).low
        assert most <= 1.1 * 100.0 * share_of(0, of).high
        assert most + least == pytest.approx(100.0, rel=1e-12)


@pytest.mark.parametrize(("chance", "draws"), [(0.03, 200), (0.3, 50), (0.97, 1000)])
def test_the_interval_holds_as_often_as_it_should(chance, draws):
    """Of 400 repetitions; how often it holds is a sum of binomial chances, near 95 %."""
    low, high = wilson_interval(np.arange(draws + 1), np.array(draws))
    inside = (low <= chance) & (chance <= high)
    coverage = binom.pmf(np.arange(draws + 1)[inside], draws, chance).sum()
    assert 0.92 < coverage < 0.98
    held = 0
    for seed in range(400):
        happened = np.random.default_rng((seed, draws)).random(draws) < chance
        share = share_of(np.count_nonzero(happened), draws)
        held += share.low <= chance <= share.high
    assert binom.ppf(5e-4, 400, coverage) <= held <= binom.isf(5e-4, 400, coverage)


@pytest.mark.parametrize(("count", "of"), [(0, 0), (3, 2), (-1, 5)])
def test_what_is_no_share_is_refused(count, of):
    with refused(place="share of draws"):
        share_of(count, of)
