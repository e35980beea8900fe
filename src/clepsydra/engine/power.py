"""The power function as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.exponential import exponential
from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.logarithm import logarithm_in_two_parts

_SIGN = 0x8000000000000000
#: Beyond it every power but that of 1 is 0 or infinite.
_LARGEST_EXPONENT = 2.0**100
#: Beyond it exp is 0 or infinite, and the leftover of its argument may be not-a-number.
_LARGEST_ARGUMENT = 800.0


def power(function: LaneFunction, x: str, y: str) -> str:
    """Append x to the power of y and return its name.

    |x|^y = exp(y ln|x|), with logarithm and product in two doubles; the sign and the ends follow
    C99, annex F.9.4.4: x⁰ = 1 and 1^y = 1 for any argument, a negative base has whole exponents
    only. Within 0.7 units in the last place (1 where the result is below 2⁻¹⁰²²); a result that
    a double holds exactly, as x¹ or 10², is returned exactly.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = power(function, "%x", "%y")
    >>> len(function.lines) < 180
    True
    """
    f = function
    zero, one = f.literal(0.0), f.literal(1.0)
    size = f.intrinsic("fabs", [x])
    value, rest = logarithm_in_two_parts(f, size)
    exponent = f.limit(y, -_LARGEST_EXPONENT, _LARGEST_EXPONENT)
    argument = f.multiply(exponent, value)
    left = f.fused(exponent, rest, f.product_error(exponent, value, argument))
    large = f.compare("ogt", f.intrinsic("fabs", [argument]), f.literal(_LARGEST_ARGUMENT))
    left = f.choose(large, zero, left)
    result = exponential(f, argument, left)

    floor = f.intrinsic("floor", [y])
    whole = f.compare("oeq", floor, y)
    half = f.multiply(f.literal(0.5), y)
    odd = f.both(whole, f.compare("une", f.intrinsic("floor", [half]), half))
    signed = f.on_bits("or", f.bits_of(result), f.on_bits("and", f.bits_of(x), _SIGN))
    result = f.choose(odd, f.real_of(signed), result)
    negative = f.both(f.compare("olt", x, zero), f.compare("ogt", x, f.literal(-math.inf)))
    broken = f.both(negative, f.compare("une", floor, y))
    result = f.choose(broken, f.literal(math.nan), result)
    always_one = f.either(f.compare("oeq", y, zero), f.compare("oeq", x, one))
    return f.choose(always_one, one, result)
