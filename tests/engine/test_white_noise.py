"""Noise from seed, stream and sample: any stretch, and its statistics on a million values."""

import zlib
from itertools import pairwise

import numpy as np
import pytest
from refusals import refused
from scipy import stats
from scipy.special import ndtri

import clepsydra as cl
from clepsydra.engine.philox import philox
from clepsydra.engine.white_noise import key_of, stream_of, white_noise

MILLION = 1_000_000


@pytest.fixture(scope="module")
def values():
    return white_noise(11, stream_of("level_1"), 0, MILLION)


@pytest.mark.parametrize(
    ("first", "count"), [(0, 0), (0, 1), (1, 1), (5, 20_000), (8191, 2), (8192, 8193), (99_999, 7)]
)
def test_any_stretch_is_that_of_the_whole(values, first, count):
    stretch = white_noise(11, stream_of("level_1"), first, count)
    assert np.array_equal(stretch, values[first : first + count])


@pytest.mark.parametrize("sample", [0, 1, 6, 4097, 2**33 + 5, 2**40])
@pytest.mark.parametrize("seed", [0, 1, 2**32 + 7, 2**64 - 1])
def test_a_sample_is_the_quantile_of_its_two_words(seed, sample):
    block, words = sample // 2, 2 * (sample % 2)
    counter = block % 2**32, block // 2**32, zlib.crc32(b"level_2"), 0
    upper, lower = philox(counter, (seed % 2**32, seed // 2**32))[words : words + 2]
    share = ((upper % 2**31) * 2**21 + lower // 2**11 + 0.5) / 2**53
    (found,) = white_noise(seed, stream_of("level_2"), sample, 1)
    assert found == pytest.approx(ndtri(share) * (1 if upper >= 2**31 else -1), abs=1e-8)


def test_a_million_values_are_normal(values):
    # A sound generator fails each of these once in ten thousand seeds.
    assert stats.kstest(values, "norm").pvalue > 1e-4
    assert abs(values.mean()) < 3.9 * np.sqrt(1 / MILLION)
    assert abs(values.var() - 1) < 3.9 * np.sqrt(2 / MILLION)
    assert abs(np.mean(values**3)) < 3.9 * np.sqrt(15 / MILLION)
    assert abs(np.mean(values**4) - 3) < 3.9 * np.sqrt(96 / MILLION)


@pytest.mark.parametrize("beyond", [3.0, 3.5, 4.0])
def test_as_many_lie_far_out_as_should(values, beyond):
    for side in (values, -values):
        share = stats.norm.sf(beyond)
        assert stats.binomtest(int(np.sum(side > beyond)), MILLION, share).pvalue > 1e-4


def test_samples_tell_nothing_of_those_after_them(values):
    for lag in (1, 2, 3, 4, 10, 8192):
        for one in (values, values**2 - 1, np.sign(values)):
            later = np.corrcoef(one[:-lag], one[lag:])[0, 1]
            assert abs(later) < 4.5 / np.sqrt(MILLION - lag)  # one of 18 in 10,000 seeds
    cells = np.floor(16 * stats.norm.cdf(values)).astype(int)
    pairs = np.bincount(16 * cells[:-1:2] + cells[1::2], minlength=256)
    assert stats.chisquare(pairs).pvalue > 1e-4


def test_streams_and_seeds_tell_nothing_of_each_other():
    count, names = 50_000, [f"level_{number}" for number in range(1, 13)]
    streams = [white_noise(1, stream_of(name), 0, count) for name in names]
    seeds = [white_noise(seed, stream_of("level_1"), 0, count) for seed in range(2, 10)]
    seeds += [white_noise(2**power + 1, stream_of("level_1"), 0, count) for power in (32, 64, 96)]
    table = np.corrcoef([*streams, *seeds])
    apart = table[np.triu_indices(len(table), 1)]
    # Of 253 coefficients one lies beyond this in 10,000 seeds.
    assert np.max(np.abs(apart)) < stats.norm.isf(1e-4 / (2 * len(apart))) / np.sqrt(count)
    for one, other in pairwise(streams):
        shift = np.corrcoef(one[1:], other[:-1])[0, 1]
        assert abs(shift) < 4.5 / np.sqrt(count)


def test_seeds_below_two_to_64_have_keys_of_their_own():
    seeds = [0, 1, 2**31, 2**32 - 1, 2**32, 2**32 + 1, 2**63, 2**64 - 1]
    assert [low + high * 2**32 for low, high in map(key_of, seeds)] == seeds


def test_every_bit_of_a_long_seed_counts():
    seed = 3**200
    keys = {key_of(seed ^ (1 << bit)) for bit in range(seed.bit_length() - 1)}
    assert len(keys) == seed.bit_length() - 1 and key_of(seed) not in keys
    assert len({key_of(5 << (64 * place)) for place in range(1, 6)}) == 5


@pytest.mark.parametrize("seed", [-1, 1.0, True, "1", None])
def test_a_seed_that_is_no_whole_number_from_0_is_refused(seed):
    with refused(place="seed", value=seed):
        white_noise(seed, 0, 0, 1)


def test_no_two_signals_of_a_process_share_a_stream():
    for entry in cl.catalogue():
        process = cl.load(entry.name).process
        names = [signal.name for signal in (*process.measurements, *process.disturbances)]
        assert len({stream_of(name) for name in names}) == len(names)


def test_numbered_signals_have_streams_of_their_own():
    names = [f"{kind}_{number}" for kind in ("level", "flow", "tank") for number in range(1, 1000)]
    assert len({stream_of(name) for name in names}) == len(names)
