"""Sine, cosine and tangent as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction

# Minimax solutions by Remez' exchange in 50 digits on |r| ≤ π/4 + 2⁻¹⁰, z = r², then rounded;
# of the sine c₀ is fixed.
#: sin r = r + r·z(c₀ + c₁z + …), within 2⁻⁵⁷ of its value.
_SINE = tuple(
    float.fromhex(digits)
    for digits in (
        "-0x1.5555555555549p-3",
        "0x1.111111110f88dp-7",
        "-0x1.a01a019c1110cp-13",
        "0x1.71de35759c7d2p-19",
        "-0x1.ae5e63a3abb53p-26",
        "0x1.5d9209ebda396p-33",
    )
)
#: cos r = 1 − z/2 + z²(c₀ + c₁z + …), within 2⁻⁶⁰.
_COSINE = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.555555555554cp-5",
        "-0x1.6c16c16c15130p-10",
        "0x1.a01a019ca9c9cp-16",
        "-0x1.27e4f803f1adap-22",
        "0x1.1ee9e7ad09a30p-29",
        "-0x1.8fac573796cc0p-37",
    )
)
_PER_QUARTER_TURN = float.fromhex("0x1.45f306dc9c883p-1")
#: π/2 in three doubles; the first happens to end in three zeros.
_QUARTER_TURN = (
    float.fromhex("0x1.921fb54442d18p+0"),
    float.fromhex("0x1.1a62633145c07p-54"),
    float.fromhex("-0x1.f1976b7ed8fbcp-110"),
)
#: Added to a small number, it leaves the nearest whole number in the last bits.
_ROUNDER = 1.5 * 2.0**52
#: Beyond it neighbouring doubles lie so far apart that an angle says little; not-a-number there.
LARGEST_ANGLE = 2.0**40
#: sin x and tan x are x below, rounded.
_TINY = 2.0**-28


def sine(function: LaneFunction, x: str) -> str:
    """Append sin(x) and return its name.

    x = n π/2 + r with a whole n; sine or cosine of r, with the sign of its quadrant. π/2 has 160
    bits, and r two doubles, so that multiples of π lose nothing. Odd in every bit. Not-a-number
    beyond 2⁴⁰.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = sine(function, "%x")
    >>> len(function.lines) < 100
    True
    """
    f = function
    quadrant, r, r_rest = _reduced(f, x)
    value = _in_quadrant(f, quadrant, _sine(f, r, r_rest), _cosine(f, r, r_rest))
    return _near_zero(f, x, value)


def cosine(function: LaneFunction, x: str) -> str:
    """Append cos(x) and return its name.

    As the sine of an angle that is one quadrant further. Even in every bit. Not-a-number
    beyond 2⁴⁰.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = cosine(function, "%x")
    >>> len(function.lines) < 100
    True
    """
    f = function
    quadrant, r, r_rest = _reduced(f, f.magnitude(x))
    further = f.on_bits("add", quadrant, 1)
    return _in_quadrant(f, further, _sine(f, r, r_rest), _cosine(f, r, r_rest))


def tangent(function: LaneFunction, x: str) -> str:
    """Append tan(x) and return its name.

    sin r / cos r, or −cos r / sin r in every second quadrant; both and the quotient stand in two
    doubles. Odd in every bit. Not-a-number beyond 2⁴⁰.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = tangent(function, "%x")
    >>> len(function.lines) < 110
    True
    """
    f = function
    quadrant, r, r_rest = _reduced(f, x)
    high, wide = _sine(f, r, r_rest), _cosine(f, r, r_rest)
    second = f.any_bit(f.on_bits("and", quadrant, 1))
    above, above_rest = (f.choose(second, b, a) for a, b in zip(high, wide, strict=True))
    below, below_rest = (
        f.choose(second, f.negative(a), b) for a, b in zip(high, wide, strict=True)
    )
    quotient = f.quotient((above, above_rest), (below, below_rest))
    return _near_zero(f, x, quotient)


def _reduced(f: LaneFunction, x: str) -> tuple[str, str, str]:
    """Append the bits that end in n, and r in two doubles, with x = n π/2 + r."""
    turned = f.add(f.multiply(x, f.literal(_PER_QUARTER_TURN)), f.literal(_ROUNDER))
    minus_n = f.subtract(f.literal(_ROUNDER), turned)
    first, second, third = (f.literal(part) for part in _QUARTER_TURN)
    high = f.fused(minus_n, first, x)
    low = f.multiply(minus_n, second)
    low_rest = f.product_error(minus_n, second, low)
    total, lost = f.exact_sum(high, low)
    rest = f.add(lost, f.add(low_rest, f.multiply(minus_n, third)))
    r = f.add(total, rest)
    within = f.compare("ole", f.magnitude(x), f.literal(LARGEST_ANGLE))
    rest = f.sum_error(total, rest, r)
    return f.bits_of(turned), f.choose(within, r, f.literal(math.nan)), rest


def _sine(f: LaneFunction, r: str, r_rest: str) -> tuple[str, str]:
    """Append sin(r + r_rest) as r and what it has beyond."""
    z = f.multiply(r, r)
    factor = f.multiply(r, f.polynomial(z, _SINE, fused=False))
    square, square_rest = f.square_in_two_parts(r)
    slope = f.subtract(f.literal(1.0), f.multiply(f.literal(0.5), z))
    rest = f.add(f.multiply(factor, square_rest), f.multiply(r_rest, slope))
    return r, f.fused(factor, square, rest)


def _cosine(f: LaneFunction, r: str, r_rest: str) -> tuple[str, str]:
    """Append cos(r + r_rest) as 1 − r²/2, rounded, and what it has beyond."""
    one = f.literal(1.0)
    z = f.multiply(r, r)
    square, square_rest = f.square_in_two_parts(r)
    half = f.multiply(f.literal(0.5), square)
    half_rest = f.multiply(f.literal(0.5), square_rest)
    leading = f.subtract(one, half)
    rest = f.subtract(f.subtract(one, leading), half)
    higher = f.multiply(f.multiply(z, z), f.polynomial(z, _COSINE, fused=False))
    higher = f.subtract(higher, f.add(half_rest, f.multiply(r, r_rest)))
    return leading, f.add(rest, higher)


def _in_quadrant(
    f: LaneFunction, quadrant: str, high: tuple[str, str], wide: tuple[str, str]
) -> str:
    """Append the sine of an angle from sine and cosine of its rest beyond the quadrants."""
    second = f.any_bit(f.on_bits("and", quadrant, 1))
    value = f.choose(second, f.add(*wide), f.add(*high))
    sign = f.on_bits("shl", f.on_bits("lshr", quadrant, 1), 63)
    return f.real_of(f.on_bits("xor", f.bits_of(value), sign))


def _near_zero(f: LaneFunction, x: str, value: str) -> str:
    """Append the value, but x where the two are equal in every bit, the sign of 0 among them."""
    return f.choose(f.compare("olt", f.magnitude(x), f.literal(_TINY)), x, value)
