"""Random words against the published ones, and what a changed bit does to them."""

import numpy as np
import pytest

from clepsydra.engine.philox import philox

#: Counter, key and random words of `philox4x32 10` in tests/kat_vectors of Random123 1.14.
PUBLISHED = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000",
     "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff",
     "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0",
     "d16cfe09 94fdcceb 5001e420 24126ea1"),
]  # fmt: skip


def words(text: str) -> tuple[int, ...]:
    return tuple(int(word, 16) for word in text.split())


@pytest.mark.parametrize(("counter", "key", "random"), PUBLISHED)
def test_the_published_words_come_out(counter, key, random):
    assert philox(words(counter), words(key)) == words(random)


def test_arrays_of_counters_give_what_each_gives_alone():
    key = words("a4093822 299f31d0")
    counters = np.random.default_rng(1).integers(0, 2**32, (4, 100), dtype=np.uint64)
    found = np.array(philox(tuple(counters), key))
    for column, counter in enumerate(counters.T.tolist()):
        assert tuple(found[:, column]) == philox(tuple(counter), key)


def test_a_changed_bit_of_counter_or_key_changes_half_of_all_bits():
    random = np.random.default_rng(2)
    counters = random.integers(0, 2**32, (4, 1000), dtype=np.uint64)
    key = [int(word) for word in random.integers(0, 2**32, 2)]
    before = np.array(philox(tuple(counters), tuple(key)))
    for place in range(6):
        for bit in range(32):
            changed, other_key = counters.copy(), list(key)
            if place < 4:
                changed[place] ^= np.uint64(1 << bit)
            else:
                other_key[place - 4] ^= 1 << bit
            flips = before ^ np.array(philox(tuple(changed), tuple(other_key)))
            share = np.bitwise_count(flips).sum() / (128 * 1000)
            # 128,000 fair coins, of which 192 sets are seen: five deviations.
            assert abs(share - 0.5) < 5 * 0.5 / np.sqrt(128 * 1000)
