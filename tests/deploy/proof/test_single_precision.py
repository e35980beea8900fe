"""Singles as doubles: one more rounding gives the bits of single-precision arithmetic."""

import itertools
import math
import operator

import numpy as np
import pytest
from tools import need_grammar

from clepsydra.deploy.proof.text.interpreter import function_block
from clepsydra.deploy.proof.text.operations import quotient, rounding, square_root

OPERATIONS = {
    "+": (operator.add, np.add),
    "-": (operator.sub, np.subtract),
    "*": (operator.mul, np.multiply),
    "/": (quotient, np.divide),
}
single = rounding()


def bits(table: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(table), np.int32(-1), table.view(np.int32))


def nasty() -> np.ndarray:
    """Zeros, infinities, not a number, powers of two, subnormals, and the neighbours of all."""
    information = np.finfo(np.float32)
    powers = np.ldexp(np.float32(1.0), np.arange(-149, 128, 7)).astype(np.float32)
    edges = np.array(
        [0.0, information.tiny, information.max, information.smallest_subnormal, 1.0, 3.0, 1 / 3,
         2.0**24, 2.0**24 - 1.0, 2.0**-126 * 1.5, math.inf, math.nan],
        dtype=np.float32,
    )  # fmt: skip
    found = np.concatenate([powers, edges])
    with np.errstate(all="ignore"):
        near = [np.nextafter(found, np.float32(side)) for side in (-math.inf, math.inf)]
    found = np.concatenate([found, *near])
    return np.unique(np.concatenate([found, -found]).view(np.int32)).view(np.float32)


def any_bits(count: int, seed: int) -> np.ndarray:
    """Singles of random bits: every exponent, subnormals and none-numbers too."""
    random = np.random.default_rng(seed)
    return random.integers(0, 2**32, count, dtype=np.uint64).astype(np.uint32).view(np.float32)


def doubles(singles: np.ndarray) -> list[float]:
    with np.errstate(all="ignore"):  # a signalling not-a-number becomes a quiet one
        return singles.astype(float).tolist()


def operands() -> tuple[np.ndarray, np.ndarray]:
    edges = nasty()
    first, second = np.array(list(itertools.product(edges, edges)), dtype=np.float32).T
    # Quotients and products that fall among the subnormals: exponents that meet there.
    random = np.random.default_rng(5)
    small = np.ldexp(random.uniform(1, 2, 20_000), random.integers(-149, -60, 20_000))
    large = np.ldexp(random.uniform(1, 2, 20_000), random.integers(0, 60, 20_000))
    first = np.concatenate([first, any_bits(60_000, 1), small.astype(np.float32)])
    second = np.concatenate([second, any_bits(60_000, 2), large.astype(np.float32)])
    return first, second


@pytest.mark.parametrize("sign", OPERATIONS)
def test_an_operation_rounded_once_more_has_the_bits_of_single_precision(sign):
    in_double, in_single = OPERATIONS[sign]
    first, second = operands()
    with np.errstate(all="ignore"):
        expected = in_single(first, second)
    pairs = zip(doubles(first), doubles(second), strict=True)
    found = np.array([single(in_double(a, b)) for a, b in pairs])
    assert np.array_equal(found, found.astype(np.float32).astype(float), equal_nan=True)
    assert np.array_equal(bits(found.astype(np.float32)), bits(expected))
    subnormal = (np.abs(expected) < np.finfo(np.float32).tiny) & (expected != 0.0)
    assert subnormal.sum() > 500


def test_a_root_rounded_once_more_has_the_bits_of_single_precision():
    values = np.concatenate([nasty(), any_bits(100_000, 3)])
    with np.errstate(all="ignore"):
        expected = np.sqrt(values)
    found = np.array([single(square_root(a)) for a in doubles(values)])
    assert np.array_equal(bits(found.astype(np.float32)), bits(expected))


def test_doubles_are_rounded_as_a_cast_does():
    random = np.random.default_rng(4)
    middles = nasty().astype(float)
    with np.errstate(all="ignore"):
        middles = (middles + np.nextafter(nasty(), np.float32(math.inf)).astype(float)) / 2
        near = [np.nextafter(middles, side) for side in (-math.inf, math.inf)]
        values = np.concatenate(
            [
                middles,
                *near,
                np.ldexp(random.normal(size=50_000), random.integers(-160, 140, 50_000)),
            ]
        )
        expected = values.astype(np.float32)
    found = np.array([single(value) for value in values.tolist()]).astype(np.float32)
    assert np.array_equal(bits(found), bits(expected))


def test_a_text_in_reals_has_the_bits_of_single_precision():
    need_grammar()
    law = function_block(
        "FUNCTION_BLOCK law VAR_INPUT p : REAL; q : REAL; n : DINT; END_VAR "
        "VAR_OUTPUT a : REAL; b : REAL; c : REAL; d : REAL; e : REAL; f : REAL; END_VAR "
        "a := p + q; b := p - q; c := p * q; d := p / q; e := SQRT(ABS(p)); "
        "f := DINT_TO_REAL(n) * -q; END_FUNCTION_BLOCK"
    )
    first, second = operands()
    chosen = np.random.default_rng(7).choice(len(first), 4000)
    count = 2**24 + 1
    for p, q in zip(first[chosen], second[chosen], strict=True):
        with np.errstate(all="ignore"):
            expected = [p + q, p - q, p * q, p / q, np.sqrt(abs(p)), np.float32(count) * -q]
        found = law(p=float(p), q=float(q), n=count).values()
        for each, wanted in zip(found, expected, strict=True):
            assert np.array_equal(bits(np.array([each], np.float32)), bits(np.array([wanted])))
