"""The noise that the page makes, beside that of Python."""

import numpy as np
from page_in_node import answered, source

from clepsydra.engine.white_noise import stream_of, white_noise, words_of

SCRIPT = f"""
import {{ whiteNoise }} from "{source("live/noise.ts")}";
answer(given.map(whiteNoise));
"""
#: Seed, signal, first sample, count and deviation.
CASES = [
    (1, "level_1", 0, 20_000, 0.05),
    (1, "level_2", 5401, 599, 0.05),
    (0, "pump_1.noise", 4096, 4097, 0.1),
    (7, "level_1", 3, 1, 1 / 3),
    (7, "level_1", 4, 0, 1.0),
    (2**31, "level_1", 2**32 - 3, 10, 1e-7),
    (2**32 + 5, "level_1", 2**33 - 5, 12, 4.0),
    (2**64 - 1, "flow", 2**34 + 1, 7, 1.0),
    (2**64, "flow", 0, 7, 1.0),
    (2**95 + 9, "flow", 0, 7, 1.0),
    (3**300, "flow", 0, 7, 1.0),
]


def test_every_bit_is_that_of_python(tmp_path):
    keys = ("seed", "stream", "first", "count", "deviation")
    given = [(words_of(seed), stream_of(signal), *rest) for seed, signal, *rest in CASES]
    cases = [dict(zip(keys, each, strict=True)) for each in given]
    found = answered(SCRIPT, cases, tmp_path)
    for (seed, signal, first, count, deviation), values in zip(CASES, found, strict=True):
        expected = deviation * white_noise(seed, stream_of(signal), first, count)
        assert np.array_equal(np.array(values, float), expected)
        assert len(values) == count
