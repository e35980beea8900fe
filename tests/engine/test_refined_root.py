"""A root out of multiply-adds is the double next to it, as that of the divider is."""

import ctypes
import math
from functools import cache

import numpy as np
import pytest

from clepsydra.engine.compiler import CompiledFunction
from clepsydra.engine.host import host
from clepsydra.engine.refined_root import (
    FIRST_ERROR,
    LARGEST,
    SMALLEST,
    SMALLEST_ENDLESS,
    endless_root,
    improved_root,
    refined_root,
)
from clepsydra.engine.unprinted import Unprinted
from clepsydra.engine.vector_text import VectorText

#: Squares of odd numbers within so many 2⁻¹⁰⁶ of a double: roots within 2⁻⁴⁴ of a unit in the last
#: place of the middle of two doubles. Further ones are decided by the error before the rounding.
NEAREST = 2**12
LANES = 8
#: Loops over the numbers of a batch [n, lanes], with what is near their reciprocal roots.
CODE = """
{declarations}
define void @roots(ptr %x, ptr %near, ptr %root, i64 %n) {{
entry:
  br label %turn
turn:
  %k = phi i64 [ 0, %entry ], [ %next, %turn ]
  %at = mul i64 %k, {lanes}
  %from = getelementptr double, ptr %x, i64 %at
  %also = getelementptr double, ptr %near, i64 %at
  %to = getelementptr double, ptr %root, i64 %at
  %given = load {real}, ptr %from, align 8
  %first = load {real}, ptr %also, align 8
{lines}
  store {real} {result}, ptr %to, align 8
  %next = add i64 %k, 1
  %more = icmp slt i64 %next, %n
  br i1 %more, label %turn, label %done
done:
  ret void
}}
"""
#: Counts, of n vectors of scattered operands between 2⁻⁹⁰⁰ and 2¹⁰⁰⁰, those where roots differ.
COUNTING = """
{declarations}
declare i64 @llvm.vector.reduce.add.v8i64(<8 x i64>)
define i64 @differing(i64 %n, i64 %seed) {{
entry:
  %begin = insertelement <8 x i64> poison, i64 %seed, i32 0
  %spread = shufflevector <8 x i64> %begin, <8 x i64> poison, <8 x i32> zeroinitializer
  %start = add <8 x i64> %spread, <i64 0, i64 1, i64 2, i64 3, i64 4, i64 5, i64 6, i64 7>
  br label %turn
turn:
  %k = phi i64 [ 0, %entry ], [ %next, %turn ]
  %place = phi <8 x i64> [ %start, %entry ], [ %moved, %turn ]
  %found = phi <8 x i64> [ zeroinitializer, %entry ], [ %now, %turn ]
  %moved = add <8 x i64> %place, splat (i64 8)
  %mixed = mul <8 x i64> %place, splat (i64 -7046029254386353131)
  %high = lshr <8 x i64> %mixed, splat (i64 29)
  %folded = xor <8 x i64> %mixed, %high
  %again = mul <8 x i64> %folded, splat (i64 -4658895280553007687)
  %fraction = and <8 x i64> %again, splat (i64 4503599627370495)
  %top = lshr <8 x i64> %mixed, splat (i64 40)
  %which = urem <8 x i64> %top, splat (i64 1899)
  %biased = add <8 x i64> %which, splat (i64 124)
  %exponent = shl <8 x i64> %biased, splat (i64 52)
  %bits = or <8 x i64> %fraction, %exponent
  %given = bitcast <8 x i64> %bits to <8 x double>
{lines}
  %right = call <8 x double> @llvm.sqrt.v8f64(<8 x double> %given)
  %same = fcmp oeq <8 x double> %right, {result}
  %wrong = select <8 x i1> %same, <8 x i64> zeroinitializer, <8 x i64> splat (i64 1)
  %now = add <8 x i64> %found, %wrong
  %next = add i64 %k, 1
  %more = icmp slt i64 %next, %n
  br i1 %more, label %turn, label %done
done:
  %sum = call i64 @llvm.vector.reduce.add.v8i64(<8 x i64> %now)
  ret i64 %sum
}}
"""

has_instruction = pytest.mark.skipif(not host().refines, reason="has no AVX-512")


def computed(x, near, root=refined_root):
    """Return roots from what is near their reciprocals; from the instruction's if that is None."""
    text = VectorText(LANES)
    result = root(text, "%given") if near is None else improved_root(text, "%given", "%first")
    code = CODE.format(
        declarations="\n".join(sorted(text.declarations)),
        lines="\n".join(text.lines), lanes=LANES, real=text.real, result=result,
    )  # fmt: skip
    signature = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 3, ctypes.c_int64)
    function = CompiledFunction(Unprinted(code, lambda: code), "roots", signature)
    more = -len(x) % LANES
    given = [np.append(each, np.ones(more)) for each in (x, x if near is None else near)]
    found = np.empty(len(given[0]))
    function.call(*(each.ctypes.data for each in (*given, found)), len(found) // LANES)
    return found[: len(x)]


def odd_roots(rest, power):
    """Return the odd y below 2^power with y² ≡ rest (1 modulo 8) modulo 2^power."""
    y = 1
    for k in range(3, power):
        if (y * y - rest) % 2 ** (k + 1):
            y += 2 ** (k - 1)
    half = 2 ** (power - 1)
    return {(sign * y + shift) % 2**power for sign in (1, -1) for shift in (0, half)}


@cache
def hard_operands():
    """Return doubles from 1 to 4 whose roots are nearest to the middle of two doubles."""
    found = []
    for rest in range(1 - NEAREST, NEAREST, 8):
        for power, low, high in (54, 1.0, 2.0), (55, 2.0, 4.0):
            for y in odd_roots(rest, power):
                x, left = divmod(y * y - rest, 2**power)
                value = x * 2.0 ** (power - 106)
                if x.bit_length() == 53 and low <= value < high:
                    assert left == 0 and int(value * 2.0 ** (106 - power)) == x
                    found.append(value)
    return np.array(found)


def scattered(count, seed=1):
    random = np.random.default_rng(seed)
    exponents = random.uniform(math.log2(SMALLEST), math.log2(LARGEST), count)
    return np.exp2(exponents) * random.uniform(1.0, 1.0 + 2.0**-20, count)


def firsts(x, seed=2):
    """Return numbers that are as far from 1/√x as they may be, or nearer."""
    random = np.random.default_rng(seed)
    share = random.choice([-1.0, 1.0, 0.0, *random.uniform(-1.0, 1.0, 61)], len(x))
    return (1.0 + 0.999 * FIRST_ERROR * share) / np.sqrt(x)


def test_hard_operands_are_hard():
    hard = hard_operands()
    assert len(hard) > 1000 and len(np.unique(hard)) == len(hard)
    for value in hard[::97]:
        numerator = int(value * 2**52) << 200
        root = math.isqrt(numerator)  # √value·2^126
        unit = 2 ** (126 - 52)
        assert abs(root % unit - unit // 2) < unit * 2.0**-43


@pytest.mark.parametrize("power", [-898, -40, -2, 0, 2, 40, 996])
@pytest.mark.parametrize("seed", range(4))
def test_the_hardest_operands_have_their_roots(power, seed):
    x = hard_operands() * 2.0**power
    np.testing.assert_array_equal(computed(x, firsts(x, seed)), np.sqrt(x))


def test_scattered_operands_have_their_roots():
    x = scattered(1_000_000)
    np.testing.assert_array_equal(computed(x, firsts(x)), np.sqrt(x))


def test_the_error_before_the_rounding_leaves_the_others_alone():
    # The first approximation as far off as it may be, and the residual as it is rounded.
    x = scattered(200_000)
    for share in (-1.0, 1.0):
        near = (1.0 + share * FIRST_ERROR) / np.sqrt(x)
        np.testing.assert_array_equal(computed(x, near), np.sqrt(x))


def test_a_worse_beginning_is_seen():
    x = scattered(100_000)
    assert np.any(computed(x, (1.0 + 2.0**-6) / np.sqrt(x)) != np.sqrt(x))


@has_instruction
def test_the_instruction_begins_well_enough():
    x = np.concatenate([hard_operands() * 2.0**power for power in range(-898, 998, 2)][::13])
    np.testing.assert_array_equal(computed(x, None), np.sqrt(x))
    edges = np.array([SMALLEST, np.nextafter(SMALLEST, 1), LARGEST, np.nextafter(LARGEST, 1)])
    np.testing.assert_array_equal(computed(edges, None), np.sqrt(edges))


@has_instruction
def test_endless_numbers_have_their_roots():
    hard = [hard_operands() * 2.0**power for power in (-798, -40, 0, 200, 998, 1020)]
    edges = [SMALLEST_ENDLESS, 1e300, np.finfo(float).max, np.inf]
    x = np.concatenate([*hard, edges])
    np.testing.assert_array_equal(computed(x, None, endless_root), np.sqrt(x))
    assert np.isnan(computed(np.array([np.nan]), None, endless_root))


def differing(count, seed):
    text = VectorText(LANES)
    result = refined_root(text, "%given")
    text.declarations.add("declare <8 x double> @llvm.sqrt.v8f64(<8 x double>)")
    declared = "\n".join(sorted(text.declarations))
    code = COUNTING.format(
        declarations=declared, lines="\n".join(text.lines), result=result.strip()
    )
    signature = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)
    # Its code goes with it.
    function = CompiledFunction(Unprinted(code, lambda: code), "differing", signature)
    return function.call(count // LANES, seed)


@has_instruction
def test_a_million_of_the_instruction_have_their_roots():
    assert differing(1_000_000, 3) == 0


@has_instruction
@pytest.mark.thorough
def test_a_billion_of_the_instruction_have_their_roots():
    assert differing(1_000_000_000, 11) == 0
