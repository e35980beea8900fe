"""Quantiles from counts of buckets."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refused

from clepsydra.studies.robustness.sketch import Sketch, steps_for

SMALLEST_NORMAL = 2.0**-1022
LARGEST = float(np.finfo(float).max)


@pytest.mark.parametrize("error", [0.1, 0.01, 1e-3, 1e-6])
@settings(max_examples=200, deadline=None)
@given(values=st.lists(st.floats(allow_nan=False), min_size=1, max_size=40))
def test_every_place_is_within_the_relative_error(error, values):
    sketch = Sketch.of(np.array(values), error)
    assert sketch.relative_error <= error
    for place, true in enumerate(sorted(values), 1):
        found = sketch.at(place)
        if math.isinf(true) or true == 0.0:
            assert found == true
        else:
            # The last term is what the middle itself is rounded by.
            most = error * max(abs(true), SMALLEST_NORMAL) + 2.0**-52 * abs(true)
            assert abs(found - true) <= most


@pytest.mark.parametrize("error", [0.1, 0.01, 1e-3, 1e-6])
def test_edges_of_buckets(error):
    """Where the error is largest: at a power of two and just below the next step."""
    step = 2.0 ** -steps_for(error)
    for low in (1.0, 2.0**-700, 2.0**1000, LARGEST / (2.0 - 2.0**-52)):
        for value in (low, math.nextafter(low * (1.0 + step), 0.0)):
            found = Sketch.of(np.array([value]), error).at(1)
            assert abs(found - value) == pytest.approx(
                value * Sketch.of(np.array([1.0]), error).relative_error, rel=1e-6
            )


def test_the_largest_double_is_told_from_infinity():
    sketch = Sketch.of(np.array([LARGEST, math.inf, -LARGEST, -math.inf]))
    found = [sketch.at(place) for place in (1, 2, 3, 4)]
    assert found[0] == -math.inf and found[3] == math.inf
    assert found[2] == pytest.approx(LARGEST, rel=1e-3) and found[1] == -found[2]


def test_it_is_no_finer_than_it_must_be():
    """Half the steps would miss the error, so no more memory is taken than the error needs."""
    for error in (0.1, 0.01, 1e-3, 1e-6):
        assert 1.0 / (2.0 ** steps_for(error) + 1.0) > error


def test_memory_depends_on_decades_and_not_on_how_many_there_are():
    generator = np.random.default_rng(1)
    few, many = (Sketch.of(10.0 ** generator.uniform(-3.0, 3.0, n)) for n in (10**5, 10**6))
    assert len(many.buckets) <= 1701 * 6 + 1
    assert len(many.buckets) <= 1.01 * len(few.buckets)
    assert many.count == 10**6
    assert many.buckets.nbytes + many.counts.nbytes <= 164_000


def test_how_values_lie_in_memory_is_nothing():
    values = np.random.default_rng(2).lognormal(size=1001)
    one = Sketch.of(values)
    other = Sketch.of(np.repeat(values, 3)[::3])
    assert np.array_equal(one.buckets, other.buckets) and np.array_equal(one.counts, other.counts)


def test_merging_is_exact_in_any_order():
    generator = np.random.default_rng(3)
    values = generator.normal(size=3000)
    whole = Sketch.of(values)
    for _ in range(5):
        parts = [Sketch.of(part) for part in np.array_split(generator.permutation(values), 11)]
        one_by_one = parts[0]
        for part in parts[1:]:
            one_by_one = part.merged(one_by_one)
        for merged in (one_by_one, parts[3].merged(*parts[:3], *parts[4:])):
            assert np.array_equal(merged.buckets, whole.buckets)
            assert np.array_equal(merged.counts, whole.counts)


def test_sketches_of_other_errors_do_not_merge():
    with pytest.raises(ValueError, match="different relative errors"):
        Sketch.of(np.array([1.0]), 0.01).merged(Sketch.of(np.array([1.0]), 0.001))


@pytest.mark.parametrize("error", [0.0, 1e-7, 0.2, math.nan])
def test_an_error_out_of_range_is_refused(error):
    with refused(place="relative error of quantiles"):
        Sketch.of(np.array([1.0]), error)
