"""White, normal noise that follows from a seed, a stream and the place of a sample alone."""

from __future__ import annotations

import zlib

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.engine.normal_quantile import normal_deviates
from clepsydra.engine.philox import WORD, philox

#: What the last word of a counter says it counts.
_SAMPLES, _WORDS_OF_SEED = 0, 1
#: Blocks of two samples that are made at a time, so that they stay in the cache.
_AT_A_TIME = 4096


def check_seed(seed: int) -> None:
    """Raise an InputError unless a seed is a whole number from 0.

    Examples
    --------
    >>> check_seed(-1)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: seed: got -1, expected a whole number from 0; choose another seed.
    """  # noqa: E501
    if not _is_whole(seed):
        raise InputError("seed", seed, "a whole number from 0", "choose another seed")


def check_below(place: str, value: int, power: int) -> None:
    """Raise an InputError unless a value is a whole number from 0 and below a power of 2.

    Examples
    --------
    >>> check_below("stream", 2**32, 32)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: stream: got 4294967296, expected a whole number from 0, below 2^32; choose another one.
    """  # noqa: E501
    if not _is_whole(value) or value >> power:
        expected = f"a whole number from 0, below 2^{power}"
        raise InputError(place, value, expected, "choose another one")


def _is_whole(value: object) -> bool:
    """Whether a value is a whole number from 0; a truth value is none."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and int(value) >= 0


def words_of(seed: int) -> tuple[int, ...]:
    """Return the words of 32 bits of a seed, the lowest first.

    Raises
    ------
    InputError
        The seed is no whole number from 0.

    Examples
    --------
    >>> words_of(1), words_of(2**32 + 5)
    ((1,), (5, 1))
    """
    check_seed(seed)
    rest, found = int(seed), list[int]()
    while rest or not found:
        found.append(rest & WORD)
        rest >>= 32
    return tuple(found)


def key_of(seed: int) -> tuple[int, int]:
    """Return the key of a seed: its two words.

    Further words are mixed in by two, the higher one 0 if it is missing: they and their place are
    the counter whose first two random words, under the key so far, are the next key.

    Examples
    --------
    >>> key_of(1), key_of(2**32 + 5)
    ((1, 0), (5, 1))
    """
    lower, upper, *further = (*words_of(seed), 0)
    key = lower, upper
    for place in range(0, len(further) - 1, 2):
        counter = further[place], further[place + 1], place // 2 + 1, _WORDS_OF_SEED
        first, second, *_ = philox(counter, key)
        key = int(first), int(second)
    return key


def seed_of(seed: int, number: int) -> int:
    """Return the seed of one of many scenarios, which is the seed itself for number 0.

    The number is the upper word of the seed's key. So scenarios that run side by side share the
    lower one, and each has noise that is independent of that of all others.

    Parameters
    ----------
    seed, number : int
        From 0 to 2³² − 1.

    Raises
    ------
    InputError
        One of them is no such number.

    Examples
    --------
    >>> seed_of(7, 0), key_of(seed_of(7, 3))
    (7, (7, 3))
    """
    check_below("seed", seed, 32)
    check_below("number of a scenario", number, 32)
    return int(seed) + (int(number) << 32)


def stream_of(name: str) -> int:
    """Return the stream of a signal: the CRC-32 of its name.

    So a signal keeps its noise where others come or go. Names that differ within four letters
    that follow each other, as `level_1` and `level_2`, have different ones for certain.

    Examples
    --------
    >>> stream_of("level_1")
    3726182077
    """
    return zlib.crc32(name.encode())


def white_noise(seed: int, stream: int, first: int, count: int) -> np.ndarray:
    """Return noise of standard deviation 1 at samples that follow each other.

    Sample k takes two words of block k // 2 of its stream (`philox`), the first two where k is
    even, for a normal deviate (`normal_deviates`). Nothing else is asked, so any stretch can be
    made alone, and continued.

    Parameters
    ----------
    seed : int
        Not negative.
    stream : int
        Which of 2³² that are independent of each other.
    first : int
        The first sample, not negative.
    count : int
        Number of samples.

    Raises
    ------
    InputError
        The seed is no whole number from 0.

    Examples
    --------
    >>> noise = white_noise(1, stream_of("level_1"), 0, 6)
    >>> bool(np.all(noise[4:] == white_noise(1, stream_of("level_1"), 4, 2)))
    True
    """
    key, before = key_of(seed), first // 2
    count_of_blocks = (first + count + 1) // 2 - before
    noise = np.empty(2 * count_of_blocks)
    for low in range(0, count_of_blocks, _AT_A_TIME):
        high = min(low + _AT_A_TIME, count_of_blocks)
        blocks = np.arange(before + low, before + high, dtype=np.uint64)
        words = np.column_stack(philox((blocks & WORD, blocks >> 32, stream, _SAMPLES), key))
        pairs = (words[:, 0::2] << 32) | words[:, 1::2]
        noise[2 * low : 2 * high] = normal_deviates(pairs.ravel())
    return noise[first % 2 :][:count]
