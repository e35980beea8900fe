"""What is kept of many draws: merged in any order, saved and read."""

import math

import numpy as np
import pytest
from refusals import refused

from clepsydra.studies.robustness import distribution
from clepsydra.studies.robustness.distribution import Distribution
from clepsydra.studies.robustness.quantiles import quantile


def scores_of_draws(count):
    """Some with ties, zeros of both signs, and loops that broke."""
    generator = np.random.default_rng(count)
    scores = generator.lognormal(0.0, 2.0, count)
    scores[::7] = np.round(scores[::7])
    scores[::11] *= -1.0
    scores[3::50] = math.inf
    scores[4::90] = -0.0
    return scores


@pytest.mark.parametrize("kept", [100, 999, 1000, 10_000])
def test_any_division_and_order_gives_the_same_bytes(kept):
    """On both sides of where scores are no longer kept, and at it."""
    scores = scores_of_draws(1000)
    whole = Distribution.of(scores, kept=kept)
    assert (whole.sketch is None) == (kept >= 1000)
    generator = np.random.default_rng(kept)
    for workers in (1, 2, 13, 40):
        draws = np.array_split(generator.permutation(1000), workers)
        parts = [Distribution.of(scores[part], part, kept=kept) for part in draws]
        at_once = parts[0].merged(*parts[1:])
        while len(parts) > 1:  # a tree of any shape
            one, other = (parts.pop(generator.integers(len(parts))) for _ in range(2))
            parts.append(one.merged(other))
        assert parts[0].as_bytes() == at_once.as_bytes() == whole.as_bytes()


def test_up_to_so_many_scores_quantiles_are_exact():
    scores = scores_of_draws(1000)
    found = Distribution.of(scores, kept=1000)
    assert found.relative_error == 0.0
    for chance in (0.001, 0.05, 0.5, 0.95, 0.98, 0.999):
        assert found.quantile(chance) == quantile(scores, chance)


def test_of_more_they_are_within_the_relative_error():
    scores = scores_of_draws(20_000)
    found = Distribution.of(scores, kept=1000)
    assert 0.0 < found.relative_error <= 1e-3
    for chance in (0.001, 0.05, 0.3, 0.5, 0.95, 0.97, 0.999):
        exact, sketched = quantile(scores, chance), found.quantile(chance)
        for one, other in (
            (exact.value, sketched.value),
            (exact.low, sketched.low),
            (exact.high, sketched.high),
        ):
            assert other == pytest.approx(one, rel=1e-3, abs=0.0)
    everyone = np.sort(scores)
    assert found.at(1) == everyone[0]
    assert found.extremes.largest.value == math.inf
    assert found.sums.of_finite().mean == pytest.approx(np.mean(scores[np.isfinite(scores)]))


def test_the_ends_are_exact_in_a_sketch():
    scores = np.array([0.1, 0.3, 0.7])
    found = Distribution.of(scores, kept=0)
    assert found.sketch is not None
    assert (found.at(1), found.at(3)) == (0.1, 0.7)
    assert found.at(2) != 0.3


def test_other_settings_do_not_merge():
    one = Distribution.of(np.array([1.0]))
    for other in (
        Distribution.of(np.array([1.0]), kept=5),
        Distribution.of(np.array([1.0]), relative_error=0.01),
    ):
        with pytest.raises(ValueError, match="different settings"):
            one.merged(other)


@pytest.mark.parametrize("kept", [5, 100])
def test_what_is_saved_is_read_as_it_was_and_merges_on(kept):
    scores = scores_of_draws(60)
    draws = np.arange(60)
    parts = [Distribution.of(scores[a:b], draws[a:b], kept) for a, b in ((0, 25), (25, 60))]
    read = [Distribution.from_bytes(part.as_bytes()) for part in parts]
    whole = Distribution.of(scores, kept=kept)
    assert read[1].merged(read[0]).as_bytes() == whole.as_bytes()


@pytest.mark.parametrize("kept", [5, 100])
def test_damage_is_refused(kept):
    saved = Distribution.of(scores_of_draws(40), kept=kept).as_bytes()
    for at in range(len(saved)):
        with refused(place="saved distribution", value="damaged bytes"):
            Distribution.from_bytes(saved[:at] + bytes([saved[at] ^ 0x10]) + saved[at + 1 :])
        with refused(place="saved distribution", value="damaged bytes"):
            Distribution.from_bytes(saved[:at])


def test_another_version_is_refused(monkeypatch):
    monkeypatch.setattr(distribution, "_FORMAT", 2)
    saved = Distribution.of(np.array([1.0])).as_bytes()
    monkeypatch.undo()
    with refused(place="saved distribution", value="format 2"):
        Distribution.from_bytes(saved)
