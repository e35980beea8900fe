"""The natural logarithm as straight-line code over lanes, in one double and in two."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction

# Coefficients are minimax solutions by Remez' exchange in 50 digits on 0 ≤ z ≤ (3 − √8)², rounded.
#: 2 artanh(s) = 2s + s·z(c₀ + c₁z + …) with z = s², within 2⁻⁵⁸ of its value.
_ONE_PART = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.5555555555592p-1",
        "0x1.999999997fdb8p-2",
        "0x1.24924941f123ep-2",
        "0x1.c71c52095d03bp-3",
        "0x1.74663ee8a4203p-3",
        "0x1.39a1baad58920p-3",
        "0x1.2f0564119d885p-3",
    )
)
#: 2 artanh(s) = 2s + s·z(2/3 + z(2/5 + z(c₀ + c₁z + …))), within 2⁻⁷² of its value.
_TWO_PARTS = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.24924924927ccp-2",
        "0x1.c71c71c65a458p-3",
        "0x1.745d17d73f027p-3",
        "0x1.3b13783f6f90fp-3",
        "0x1.111dcc86c9bb8p-3",
        "0x1.de9ed81e9df2bp-4",
        "0x1.e7dcf21335fe9p-4",
    )
)
_TWO_THIRDS = (float.fromhex("0x1.5555555555555p-1"), float.fromhex("0x1.5555555555555p-55"))
_TWO_FIFTHS = (float.fromhex("0x1.999999999999ap-2"), float.fromhex("-0x1.999999999999ap-56"))
#: ln 2 with eleven zeros at its end, so that a whole exponent times it is exact.
LN2 = float.fromhex("0x1.62e42fefa3800p-1")
LN2_REST = float.fromhex("0x1.ef35793c76730p-45")
_ROOT_HALF_BITS = 0x3FE6A09E667F3BCD
_MANTISSA = 0x000FFFFFFFFFFFFF
_BIAS = 1024
#: Bits of 2^52: a whole number below 2^52 put into their end is added to it.
_WHOLE_BITS = 0x4330000000000000


def logarithm(function: LaneFunction, x: str) -> str:
    """Append ln(x) and return its name.

    x = 2ᵏ(1 + f) with 1 + f in [√½, √2), and ln(1 + f) = f − f²/2 + s(f²/2 + z R(z)) with
    s = f/(2 + f), z = s²; what is lost by rounding f − f²/2 and k ln 2 is added at the end.
    Within 0.7 units in the last place. ln 0 = −∞, and not-a-number below 0.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = logarithm(function, "%x")
    >>> len(function.lines) < 60
    True
    """
    f = function
    k, mantissa = _parts(f, x)
    part = f.subtract(mantissa, f.literal(1.0))
    return _defined(f, x, _summed(f, k, part))


def logarithm_of_one_plus(function: LaneFunction, x: str, rest: str | None = None) -> str:
    """Append ln(1 + x + rest) and return its name.

    The logarithm of 1 + x, rounded, and what rounding leaves over, divided by it; near 0, x is
    itself what the mantissa has beyond 1. Within 0.7 units in the last place for rest = 0.
    ln(1 − 1) = −∞, and not-a-number for x below −1.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Parameters
    ----------
    function : LaneFunction
    x : str
    rest : str, optional
        A number small enough that x + rest rounds to x; 0 if omitted.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = logarithm_of_one_plus(function, "%x")
    >>> len(function.lines) < 70
    True
    """
    f = function
    zero, one = f.literal(0.0), f.literal(1.0)
    whole, lost = f.exact_sum(one, x)
    k, mantissa = _parts(f, whole)
    near = f.compare("oeq", k, zero)
    part = f.choose(near, x, f.subtract(mantissa, one))
    left = f.choose(near, zero, lost)
    left = left if rest is None else f.add(left, rest)
    value = _defined(f, whole, _summed(f, k, part, f.divide(left, whole)))
    tiny = f.compare("olt", f.magnitude(x), f.literal(2.0**-54))
    return f.choose(tiny, x, value)


def logarithm_of_double(function: LaneFunction, x: str) -> str:
    """Append ln(2x), of numbers too whose double is beyond the largest one, and return its name.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = logarithm_of_double(function, "%x")
    >>> len(function.lines) < 60
    True
    """
    f = function
    k, mantissa = _parts(f, x)
    part = f.subtract(mantissa, f.literal(1.0))
    return _defined(f, x, _summed(f, f.add(k, f.literal(1.0)), part))


def _summed(f: LaneFunction, k: str, part: str, left: str | None = None) -> str:
    """Append k ln 2 + ln(1 + part) + left, where what is left is small beside the others."""
    s = f.divide(part, f.add(f.literal(2.0), part))
    z = f.multiply(s, s)
    half = f.multiply(f.literal(0.5), part)
    square = f.multiply(half, part)
    curved = f.subtract(part, square)
    rest = f.subtract(f.subtract(part, curved), square)
    rest = f.subtract(rest, f.product_error(half, part, square))
    whole = f.multiply(k, f.literal(LN2))
    total = f.add(whole, curved)
    rest = f.add(rest, f.sum_error(whole, curved, total))
    rest = rest if left is None else f.add(rest, left)
    rest = f.fused(k, f.literal(LN2_REST), rest)
    rest = f.fused(s, f.fused(z, f.polynomial(z, _ONE_PART), square), rest)
    return f.add(total, rest)


def logarithm_in_two_parts(function: LaneFunction, x: str) -> tuple[str, str]:
    """Append ln(x) for x ≥ 0 and return the names of its value and of what rounding left over.

    The sum of both is within 2⁻⁶⁸ of the logarithm: 2 artanh(s) with s, z = s² and the leading
    terms in two doubles each. At 0 and ∞ the leftover means nothing.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 2 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> value, rest = logarithm_in_two_parts(function, "%x")
    >>> len(function.lines) < 80
    True
    """
    f = function
    one = f.literal(1.0)
    k, mantissa = _parts(f, x)
    part = f.subtract(mantissa, one)
    below = f.add(mantissa, one)
    below_rest = f.subtract(mantissa, f.subtract(below, one))
    reciprocal = f.divide(one, below)
    s = f.multiply(part, reciprocal)
    minus_s = f.negative(s)
    missing = f.fused(minus_s, below_rest, f.fused(minus_s, below, part))
    s_rest = f.multiply(missing, reciprocal)
    z = _product(f, (s, s_rest), (s, s_rest))
    higher = f.multiply(z[0], f.polynomial(z[0], _TWO_PARTS))
    inner = f.add(f.literal(_TWO_FIFTHS[0]), higher)
    inner_rest = f.sum_error(f.literal(_TWO_FIFTHS[0]), higher, inner)
    steeper = _product(f, z, (inner, f.add(inner_rest, f.literal(_TWO_FIFTHS[1]))))
    slope = f.add(f.literal(_TWO_THIRDS[0]), steeper[0])
    slope_rest = f.sum_error(f.literal(_TWO_THIRDS[0]), steeper[0], slope)
    slope_rest = f.add(f.add(slope_rest, f.literal(_TWO_THIRDS[1])), steeper[1])
    bend = _product(f, (s, s_rest), _product(f, z, (slope, slope_rest)))
    twice = f.add(s, s)
    near = f.add(twice, bend[0])
    rest = f.add(f.sum_error(twice, bend[0], near), f.fused(f.literal(2.0), s_rest, bend[1]))
    whole = f.multiply(k, f.literal(LN2))
    total = f.add(whole, near)
    rest = f.add(rest, f.sum_error(whole, near, total))
    rest = f.fused(k, f.literal(LN2_REST), rest)
    return _at_the_ends(f, x, total), rest


def _parts(f: LaneFunction, x: str) -> tuple[str, str]:
    """Append k and m in [√½, √2) with x = 2ᵏ m, for positive finite x."""
    subnormal = f.compare("olt", x, f.literal(2.0**-1022))
    scaled = f.choose(subnormal, f.multiply(x, f.literal(2.0**54)), x)
    bias = 2.0**52 + _BIAS
    shift = f.choose(subnormal, f.literal(bias + 54.0), f.literal(bias))
    above = f.on_bits("sub", f.bits_of(scaled), _ROOT_HALF_BITS - (_BIAS << 52))
    exponent = f.on_bits("or", f.on_bits("lshr", above, 52), _WHOLE_BITS)
    k = f.subtract(f.real_of(exponent), shift)
    fraction = f.on_bits("add", f.on_bits("and", above, _MANTISSA), _ROOT_HALF_BITS)
    return k, f.real_of(fraction)


def _defined(f: LaneFunction, x: str, value: str) -> str:
    """Append the value, but not-a-number below 0, and what the logarithm is at 0 and ∞."""
    value = _at_the_ends(f, x, value)
    return f.choose(f.compare("olt", x, f.literal(0.0)), f.literal(math.nan), value)


def _at_the_ends(f: LaneFunction, x: str, value: str) -> str:
    """Append the value, but −∞ at 0, and ∞ and not-a-number where x is."""
    infinity = f.literal(math.inf)
    value = f.choose(f.compare("olt", x, infinity), value, x)
    return f.choose(f.compare("oeq", x, f.literal(0.0)), f.literal(-math.inf), value)


def _product(f: LaneFunction, a: tuple[str, str], b: tuple[str, str]) -> tuple[str, str]:
    """Append the product of two numbers in two doubles each."""
    value = f.multiply(a[0], b[0])
    rest = f.fused(a[0], b[1], f.product_error(a[0], b[0], value))
    return value, f.fused(a[1], b[0], rest)
