"""Philox 4×32-10: four random words from a counter of four and a key of two, by integers alone."""

from __future__ import annotations

import numpy as np

#: A word of 32 bits; here it lies in the lower half of 64, where products of two have room.
WORD = 0xFFFFFFFF
Word = int | np.ndarray
ROUNDS = 10
MULTIPLIERS = 0xD2511F53, 0xCD9E8D57
#: What the key grows by each round: the golden ratio and √3 − 1, as fractions of 2³².
GROWTH = 0x9E3779B9, 0xBB67AE85


def philox(
    counter: tuple[Word, Word, Word, Word], key: tuple[int, int]
) -> tuple[Word, Word, Word, Word]:
    """Return the random words of counters under a key.

    Parameters
    ----------
    counter : tuple of four int or ndarray of uint64
        Each number below 2³².
    key : tuple of two int
        Likewise.

    References
    ----------
    J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as
    1, 2, 3, SC'11, 2011, section 3.3, doi:10.1145/2063384.2063405.

    Examples
    --------
    >>> [f"{word:08x}" for word in philox((0, 0, 0, 0), (0, 0))]
    ['6627e8d5', 'e169c58d', 'bc57ac4c', '9b00dbd8']
    """
    first, second, third, fourth = counter
    left, right = key
    for _ in range(ROUNDS):
        one, other = first * MULTIPLIERS[0], third * MULTIPLIERS[1]
        first, second = (other >> 32) ^ second ^ left, other & WORD
        third, fourth = (one >> 32) ^ fourth ^ right, one & WORD
        left, right = (left + GROWTH[0]) & WORD, (right + GROWTH[1]) & WORD
    return first, second, third, fourth
