"""Normal deviates beside SciPy's inverse of the distribution, whose algorithm is another one."""

import numpy as np
from scipy.special import log_ndtr, ndtri

from clepsydra.engine.normal_quantile import normal_deviates, quantile_table

#: What docstring and decision promise, in standard deviations.
WITHIN = 1e-8


def shares_of(words: np.ndarray) -> np.ndarray:
    """Return the share of the distribution that each word stands for."""
    return ((words >> 11 & (2**52 - 1)).astype(float) + 0.5) / 2.0**53


def words_of(shares: np.ndarray) -> np.ndarray:
    return (shares * 2.0**53).astype(np.uint64) << 11


def test_deviates_are_the_quantiles_down_to_the_smallest_share():
    random = np.random.default_rng(1)
    words = words_of(
        np.concatenate([2.0 ** -random.uniform(1, 54, 200_000), random.uniform(0, 0.5, 200_000)])
    )
    assert np.max(np.abs(normal_deviates(words) + ndtri(shares_of(words)))) < WITHIN


def test_both_ends_of_every_piece_are_quantiles_too():
    powers, parts = np.meshgrid(np.arange(-54.0, -1.0), np.arange(8.0))
    ends = (2.0**powers * (1.0 + parts / 8.0)).ravel()
    steps = np.concatenate([words_of(ends), words_of(ends[ends >= 2.0**-53]) - (1 << 11)])
    assert np.max(np.abs(normal_deviates(steps) + ndtri(shares_of(steps)))) < WITHIN


def test_the_ends_are_beyond_8_and_next_to_0():
    farthest, nearest = normal_deviates(np.array([0, 2**63 - 1], np.uint64))
    assert abs(log_ndtr(-farthest) + 54 * np.log(2.0)) < 1e-7  # d ln q/dw is 8.4 there
    assert 8.2 < farthest < 8.3 and abs(nearest) < WITHIN


def test_the_first_bit_is_the_sign_and_nothing_else():
    words = np.random.default_rng(2).integers(0, 2**63, 10_000, dtype=np.uint64)
    above, below = normal_deviates(words), normal_deviates(words | np.uint64(1 << 63))
    assert np.array_equal(above, -below)
    assert above.min() > -WITHIN


def test_the_last_eleven_bits_do_nothing():
    words = np.random.default_rng(3).integers(0, 2**63, 1000, dtype=np.uint64)
    assert np.array_equal(normal_deviates(words), normal_deviates(words ^ np.uint64(2047)))


def test_a_smaller_share_is_farther_out():
    words = np.sort(np.random.default_rng(4).integers(0, 2**63, 100_000, dtype=np.uint64))
    steps = np.diff(normal_deviates(words))
    assert steps.max() < 2 * WITHIN  # pieces do not meet to the last digit


def test_every_operation_rounds_once():
    """The table by Python's own numbers, in plain loops, has the bits of that by arrays."""
    words = np.random.default_rng(5).integers(0, 2**64, 2000, dtype=np.uint64)
    columns = quantile_table().T.tolist()
    for word, deviate in zip(words.tolist(), normal_deviates(words).tolist(), strict=True):
        share = ((word >> 11 & (2**52 - 1)) + 0.5) * 2.0**-53
        mantissa, exponent = np.frexp(share)
        piece = 8 * (int(exponent) + 53) + int(16 * mantissa) - 8
        centre, *rising = columns[piece]
        value = rising[-1]
        for coefficient in rising[-2::-1]:
            value = value * (share - centre) + coefficient
        assert deviate == (-value if word >> 63 else value)
