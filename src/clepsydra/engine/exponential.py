"""The exponential function as straight-line code over lanes."""

from __future__ import annotations

from clepsydra.engine.lane_function import LaneFunction

#: exp(r) = 1 + r + r²(c₀ + c₁r + …) on |r| ≤ ln(2)/2 within 2⁻⁶⁰ of its value: c₀ is fixed and
#: the others are the minimax solution by Remez' exchange in 50 digits, then rounded.
_EXPONENTIAL = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.0p-1",
        "0x1.555555555555dp-3",
        "0x1.555555555556fp-5",
        "0x1.111111110e33fp-7",
        "0x1.6c16c16c07eefp-10",
        "0x1.a01a01b6f130fp-13",
        "0x1.a01a01fc71684p-16",
        "0x1.71dde7ba41b09p-19",
        "0x1.27e40c0e16f2fp-22",
        "0x1.af7a28f8e62bbp-26",
        "0x1.20d1480d8fa40p-29",
    )
)
_PER_LN2 = float.fromhex("0x1.71547652b82fep+0")
_LN2 = float.fromhex("0x1.62e42fefa39efp-1")
_LN2_REST = float.fromhex("0x1.abc9e3b39803fp-56")
#: Added to a small number, it leaves the nearest whole number in the last bits.
_ROUNDER = 1.5 * 2.0**52
_ROUNDER_BITS = 0x4338000000000000
#: exp is infinite above the second and zero below the first; nothing beyond need be told apart.
_RANGE = (-746.0, 710.0)


def exponential(function: LaneFunction, x: str, rest: str | None = None) -> str:
    """Append exp(x + rest) and return its name.

    x = k ln 2 + r with a whole k; exp r is a polynomial, and 2ᵏ is put into the exponent bits in
    two factors, so that results below 2⁻¹⁰²² are rounded once. The reduction is Cody and Waite's,
    exact in its first step because it is fused; its rounding error is kept and used. Within
    0.7 units in the last place for rest = 0 (1 where the result is below 2⁻¹⁰²²).

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
    >>> result = exponential(function, "%x")
    >>> len(function.lines) < 50
    True
    """
    f = function
    x = f.limit(x, *_RANGE)
    turned = f.fused(x, f.literal(_PER_LN2), f.literal(_ROUNDER))
    minus_k = f.subtract(f.literal(_ROUNDER), turned)
    high = f.fused(minus_k, f.literal(_LN2), x)
    low_step = f.literal(_LN2_REST)
    low = f.multiply(minus_k, low_step) if rest is None else f.fused(minus_k, low_step, rest)
    r = f.add(high, low)
    r_rest = f.sum_error(high, low, r)
    leading = f.add(f.literal(1.0), r)
    leading_rest = f.sum_error(f.literal(1.0), r, leading)
    tail = f.fused(r_rest, leading, leading_rest)
    tail = f.fused(f.multiply(r, r), f.polynomial(r, _EXPONENTIAL), tail)
    value = f.add(leading, tail)
    # The exponents of the two factors of 2^k, biased by 1023, add up to k + 2046.
    together = f.on_bits("sub", f.bits_of(turned), _ROUNDER_BITS - 2046)
    first = f.on_bits("lshr", together, 1)
    second = f.on_bits("sub", together, first)
    for exponent in (first, second):
        value = f.multiply(value, f.real_of(f.on_bits("shl", exponent, 52)))
    return value
