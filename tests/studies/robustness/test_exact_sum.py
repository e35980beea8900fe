"""Sums without rounding."""

import math
import statistics
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clepsydra.studies.robustness import exact_sum
from clepsydra.studies.robustness.exact_sum import UNIT, ExactSum

finite = st.floats(allow_nan=False, allow_infinity=False)


@settings(max_examples=300, deadline=None)
@given(st.lists(finite, min_size=1, max_size=30))
def test_sums_are_those_of_fractions(values):
    found = ExactSum.of(np.array(values))
    assert Fraction(found.total, 2**UNIT) == sum(map(Fraction, values))
    assert Fraction(found.squares, 2 ** (2 * UNIT)) == sum(Fraction(x) ** 2 for x in values)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.floats(-1e150, 1e150), min_size=2, max_size=30))
def test_mean_and_variance_are_rounded_once(values):
    found = ExactSum.of(np.array(values))
    assert found.mean == float(statistics.mean(map(Fraction, values)))
    assert found.variance == float(statistics.variance(map(Fraction, values)))


def test_what_doubles_lose_is_kept():
    values = np.array([1e16, 1.0, -1e16, 1e-300])
    assert np.sum(values) != 1.0
    assert ExactSum.of(values).mean == 0.25
    shifted = ExactSum.of(1e9 + np.array([4.0, 7.0, 13.0, 16.0]))
    assert shifted.variance == 30.0  # the usual example of what n Σx² − (Σx)² loses


def test_any_division_and_order_gives_the_same_sums():
    generator = np.random.default_rng(2)
    values = generator.normal(size=1000) * 10.0 ** generator.integers(-200, 200, 1000)
    values[:3] = math.inf
    whole = ExactSum.of(values)
    for _ in range(10):
        merged = ExactSum.of(np.array([]))
        for part in np.array_split(generator.permutation(values), generator.integers(1, 30)):
            merged = ExactSum.of(part).merged(merged)
        assert merged == whole


def test_many_values_of_one_size_do_not_overflow():
    """As many as are added at once, all with the largest halves that there are."""
    most = math.nextafter(2.0, 0.0)
    found = ExactSum.of(np.full(exact_sum._BLOCK + 5, most))
    count = exact_sum._BLOCK + 5
    assert Fraction(found.total, 2**UNIT) == count * Fraction(most)
    assert Fraction(found.squares, 2 ** (2 * UNIT)) == count * Fraction(most) ** 2


def test_infinite_values_are_counted_beside():
    found = ExactSum.of(np.array([1.0, math.inf, 4.0]))
    assert found.mean == math.inf
    assert math.isnan(found.variance)
    assert (found.of_finite().count, found.of_finite().mean) == (2, 2.5)
    assert ExactSum.of(np.array([1.0, -math.inf])).mean == -math.inf
    assert math.isnan(ExactSum.of(np.array([math.inf, -math.inf])).mean)


@pytest.mark.parametrize("values", [[], [3.0]])
def test_too_few_have_no_variance(values):
    assert math.isnan(ExactSum.of(np.array(values)).variance)


def test_the_variance_of_the_largest_doubles_is_infinite():
    found = ExactSum.of(np.array([1e308, -1e308, 1.7e308]))
    assert found.variance == math.inf
    assert found.mean == pytest.approx(1.7e308 / 3.0, rel=1e-15)
