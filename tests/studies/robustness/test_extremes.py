"""The worst of many draws."""

import math

import numpy as np
import pytest
from refusals import refused

from clepsydra.studies.robustness.extremes import Extreme, Extremes


def test_of_equal_scores_the_draw_with_the_lowest_number_is_named():
    scores = np.array([3.0, math.inf, 1.0, math.inf, 1.0])
    found = Extremes.of(scores, np.array([40, 31, 9, 20, 17]))
    assert found.worst() == Extreme(math.inf, 20)
    assert found.worst(larger_is_better=True) == Extreme(1.0, 9)


def test_the_sign_of_a_zero_is_nothing():
    found = Extremes.of(np.array([0.0, -0.0]))
    assert [math.copysign(1.0, end.value) for end in (found.least, found.largest)] == [1.0, 1.0]


def test_any_order_of_merging_names_the_same_draws():
    generator = np.random.default_rng(5)
    scores = generator.integers(0, 5, 200).astype(float)
    whole = Extremes.of(scores)
    for _ in range(20):
        parts = np.array_split(generator.permutation(200), 7)
        merged = Extremes.of(scores[parts[0]], parts[0])
        for part in parts[1:]:
            merged = Extremes.of(scores[part], part).merged(merged)
        assert merged == whole


@pytest.mark.parametrize("scores", [[], [1.0, math.nan]])
def test_what_has_no_extremes_is_refused(scores):
    with refused(place="scores"):
        Extremes.of(np.array(scores))
