"""The fused multiply-add out of plain operations: against fractions, and against the machine."""

import ctypes
import math
from fractions import Fraction

import numpy as np
import pytest

from clepsydra.engine.compiler import CompiledFunction
from clepsydra.engine.fused_multiply_add import FUSED, fused_multiply_add
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.unprinted import Unprinted

COUNT = 100_000
LARGEST = 2.0**1023 * (2.0 - 2.0**-52)
SPECIAL = [
    0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, -5e-324, 1.0, -1.0, 0.5,
    2.0**-1022, 2.0**-1022 - 2.0**-1074, 1.0 + 2.0**-52, LARGEST, -LARGEST,
]  # fmt: skip
#: Applies a function to each row of three columns.
LOOP = """
declare double @llvm.fma.f64(double, double, double)
define void @{name}(ptr %a, ptr %b, ptr %c, ptr %result, i64 %count) #0 {{
entry:
  br label %head
head:
  %i = phi i64 [ 0, %entry ], [ %next, %body ]
  %more = icmp slt i64 %i, %count
  br i1 %more, label %body, label %done
body:
  %pa = getelementptr double, ptr %a, i64 %i
  %pb = getelementptr double, ptr %b, i64 %i
  %pc = getelementptr double, ptr %c, i64 %i
  %pr = getelementptr double, ptr %result, i64 %i
  %x = load double, ptr %pa
  %y = load double, ptr %pb
  %z = load double, ptr %pc
  %value = call double {function}(double %x, double %y, double %z)
  store double %value, ptr %pr
  %next = add i64 %i, 1
  br label %head
done:
  ret void
}}
attributes #0 = {{ nounwind }}
"""


def compiled(name, function, definition=""):
    """Return a function of three arrays."""
    signature = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4, ctypes.c_int64)
    code = f"{definition}\n{LOOP.format(name=name, function=function)}"
    native = CompiledFunction(Unprinted(code, lambda: code), name, signature, ObjectCache(None))

    def apply(*columns):
        given = [np.ascontiguousarray(column) for column in columns]
        result = np.empty(len(given[0]))
        addresses = [each.ctypes.data for each in (*given, result)]
        native.call(*addresses, len(result))
        return result

    return apply


@pytest.fixture(scope="module")
def ours():
    return compiled("ours", FUSED, fused_multiply_add())


def bits(random, low=0, high=2048):
    """Return doubles of any sign and fraction, whose biased exponents lie in a range."""
    exponent, fraction = random.integers(low, high, COUNT), random.integers(0, 2**52, COUNT)
    sign = random.integers(0, 2, COUNT)
    return ((sign << 63) | (exponent << 52) | fraction).view(float)


def sparse(random, numbers):
    """Return numbers whose last bits are zero, from some bit on: they meet ties."""
    kept = np.int64(-1) << random.integers(0, 53, COUNT)
    return (numbers.view(np.int64) & kept).view(float)


def any_bits(random):
    return bits(random), bits(random), bits(random)


def near_cancellation(random):
    a, b = bits(random, 900, 1140), bits(random, 900, 1140)
    return a, b, -(a * b) * (1.0 + random.integers(-3, 4, COUNT) * 2.0**-52)


def whole_cancellation(random):
    a, b = (sparse(random, bits(random, 600, 1300)) for _ in "ab")
    return a, b, -(a * b)


def of_one_size(random):
    return bits(random, 1000, 1046), bits(random, 1000, 1046), bits(random, 950, 1100)


def ties(random):
    numbers = bits(random, 1000, 1046), bits(random, 1000, 1046), bits(random, 900, 1140)
    return tuple(sparse(random, each) for each in numbers)


def near_ties(random):
    """A product next to half of the last place of c: what decides is below 2⁻⁵⁰ of it."""
    a = bits(random, 1023, 1024)
    half = 2.0 ** random.integers(-3, 4, COUNT)
    return a, half / a, 2.0**53 * half * bits(random, 1023, 1024)


def factors_of_unlike_size(random):
    """One whose halves overflow or which is below the normal range, and a product of any size."""
    return bits(random, 1990, 2047), bits(random, 0, 60), bits(random, 900, 1200)


def products_at_the_ends(random):
    """Where a product begins to lose digits of its error, and just below the largest number."""
    small, large = random.random(COUNT) < 0.5, bits(random, 1510, 1536)
    a = np.where(small, bits(random, 500, 586), large)
    other = LARGEST / large * (1.0 - random.random(COUNT) * 2.0**-26)
    b = np.where(small, bits(random, 500, 586), other)
    return a, b, np.where(random.random(COUNT) < 0.5, -(a * b), bits(random, 0, 2047))


def results_below_the_normal_range(random):
    return bits(random, 0, 600), bits(random, 300, 800), bits(random, 0, 80)


def arguments_below_the_normal_range(random):
    return bits(random, 0, 30), bits(random, 990, 1060), bits(random, 0, 30)


def ties_below_the_normal_range(random):
    numbers = bits(random, 0, 1100), bits(random, 0, 1100), bits(random, 0, 300)
    return tuple(sparse(random, each) for each in numbers)


def results_beyond_the_range(random):
    return bits(random, 1500, 2047), bits(random, 1400, 1800), bits(random, 1900, 2047)


def special_numbers(random):
    return tuple(random.choice(SPECIAL, COUNT) for _ in "abc")


def one_special_factor(random):
    return random.choice(SPECIAL, COUNT), bits(random), bits(random)


def a_special_addend(random):
    return bits(random), bits(random), random.choice(SPECIAL, COUNT)


CLASSES = [
    any_bits, near_cancellation, whole_cancellation, of_one_size, ties, near_ties,
    factors_of_unlike_size, products_at_the_ends,
    results_below_the_normal_range, arguments_below_the_normal_range, ties_below_the_normal_range,
    results_beyond_the_range, special_numbers, one_special_factor, a_special_addend,
]  # fmt: skip
by_class = pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)


def as_bits(numbers):
    """Return the bits; what is not a number is one, whatever its bits."""
    return np.where(np.isnan(numbers), -1, numbers.view(np.int64))


def differing(found, expected):
    return np.flatnonzero(as_bits(found) != as_bits(expected))


def exact(a, b, c):
    """Return a·b + c rounded once, by fractions; of finite numbers."""
    value = Fraction(a) * Fraction(b) + Fraction(c)
    if value == 0:
        # A product of the sign of c, or c alone where there is no product.
        return a * b + c if c == 0.0 or 0.0 in (a, b) else 0.0
    sign = 1.0 if value > 0 else -1.0
    try:
        return sign * float(abs(value))
    except OverflowError:
        return sign * math.inf


@by_class
def test_it_is_the_fraction_rounded_once(ours, kind):
    columns = [column[:2000] for column in kind(np.random.default_rng(1))]
    rows = [row for row in zip(*columns, strict=True) if all(map(math.isfinite, row))]
    if rows:
        expected = np.array([exact(*map(float, row)) for row in rows])
        assert differing(ours(*np.transpose(rows)), expected).size == 0


@by_class
@pytest.mark.parametrize("seed", range(3))
def test_it_is_that_of_the_machine(ours, kind, seed):
    columns = kind(np.random.default_rng([7, seed]))
    machine = compiled("machine", "@llvm.fma.f64")
    assert differing(ours(*columns), machine(*columns)).size == 0


def test_two_roundings_would_be_seen(ours):
    """The classes tell the fused operation from a product and a sum."""
    a, b, c = of_one_size(np.random.default_rng(1))
    assert differing(ours(a, b, c), a * b + c).size > COUNT / 100
