"""Of what is told in per cent, a tenth of one is nothing to compare controllers by."""

import pytest

from clepsydra.scores.score import SCORES


@pytest.mark.parametrize("key", [key for key, each in SCORES.items() if each.unit.startswith("%")])
def test_a_score_in_percent_says_what_counts_as_nothing(key):
    assert SCORES[key].negligible, f"give {key} a value of `negligible`, in {SCORES[key].unit}"
