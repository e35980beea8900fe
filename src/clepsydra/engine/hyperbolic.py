"""The hyperbolic functions and exp(x) − 1 as straight-line code over lanes."""

from __future__ import annotations

from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.logarithm import LN2, LN2_REST

# Minimax solutions by Remez' exchange in 50 digits on |r| ≤ ln(2)/2, z = r², then rounded: what
# even and odd terms of exp r have beyond 1 + z/2 and r, within 2⁻⁶⁰ of their whole.
#: cosh r = 1 + z/2 + z²(c₀ + c₁z + …).
_EVEN = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.5555555555558p-5",
        "0x1.6c16c16c1504bp-10",
        "0x1.a01a01ad63d7ap-16",
        "0x1.27e4cc4e24bc3p-22",
        "0x1.1f8b7b54ff1fep-29",
    )
)
#: sinh r = r + r·z(c₀ + c₁z + …).
_ODD = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.5555555555559p-3",
        "0x1.111111110f6aep-7",
        "0x1.a01a01afe568ap-13",
        "0x1.71ddf852f9ed9p-19",
        "0x1.af5ec0235d818p-26",
    )
)
_PER_LN2 = float.fromhex("0x1.71547652b82fep+0")
#: Added to a small number, it leaves the nearest whole number in the last bits.
_ROUNDER = 1.5 * 2.0**52
#: sinh and cosh are infinite beyond, and exp(x) − 1 beyond the second; it is −1 below the first.
_LARGEST = 710.7
_RANGE = (-42.0, 710.0)
#: tanh is 1 beyond, rounded.
_STEADY = 20.0
#: sinh x and tanh x are x below, rounded.
_TINY = 2.0**-28


def exponential_minus_one(function: LaneFunction, x: str) -> str:
    """Append exp(x) − 1 and return its name.

    x = k ln 2 + r with a whole k, and 2ᵏ(1 + r + …) − 1 is summed from 2ᵏ − 1 on, with what
    rounding leaves over.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = exponential_minus_one(function, "%x")
    >>> len(function.lines) < 80
    True
    """
    f = function
    k, growth, growth_rest = _grown(f, f.limit(x, *_RANGE))
    half_power = _power_of_two(f, k, -1)
    base, base_rest = f.exact_sum(half_power, f.literal(-0.5))
    slope = f.multiply(half_power, growth)
    total = f.add(base, slope)
    rest = f.add(f.sum_error(base, slope, total), base_rest)
    half = f.add(total, f.add(f.multiply(half_power, growth_rest), rest))
    tiny = f.compare("olt", f.magnitude(x), f.literal(2.0**-54))
    return f.choose(tiny, x, f.add(half, half))


def hyperbolic_sine(function: LaneFunction, x: str) -> str:
    """Append sinh(x) and return its name.

    |x| = k ln 2 + r with a whole k; sinh|x| is (2ᵏ − 2⁻ᵏ)/2 of cosh r and (2ᵏ + 2⁻ᵏ)/2 of
    sinh r, and both are polynomials. Odd in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = hyperbolic_sine(function, "%x")
    >>> len(function.lines) < 90
    True
    """
    f = function
    size = f.magnitude(x)
    growing, fading, r, even, odd = _halves(f, size)
    value = _mixed(f, growing, f.negative(fading), r, even, odd)
    value = f.choose(f.compare("olt", size, f.literal(_TINY)), x, value)
    return f.with_sign_of(value, x)


def hyperbolic_cosine(function: LaneFunction, x: str) -> str:
    """Append cosh(x) and return its name.

    As the hyperbolic sine: (2ᵏ + 2⁻ᵏ)/2 of cosh r and (2ᵏ − 2⁻ᵏ)/2 of sinh r. Even in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = hyperbolic_cosine(function, "%x")
    >>> len(function.lines) < 90
    True
    """
    growing, fading, r, even, odd = _halves(function, function.magnitude(x))
    return _mixed(function, growing, fading, r, even, odd)


def hyperbolic_tangent(function: LaneFunction, x: str) -> str:
    """Append tanh(x) and return its name.

    (E − 1)/(E + 1) with E = exp(2|x|) = 2ᵏ(1 + r + …); numerator, denominator and quotient stand
    in two doubles each. Odd in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapters 5 and 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = hyperbolic_tangent(function, "%x")
    >>> len(function.lines) < 100
    True
    """
    f = function
    size = f.magnitude(x)
    limited = f.limit(size, 0.0, _STEADY)
    k, growth, growth_rest = _grown(f, f.add(limited, limited))
    power = _power_of_two(f, k, 0)
    slope, slope_rest = f.multiply(power, growth), f.multiply(power, growth_rest)

    def beside(one: float) -> tuple[str, str]:
        base = f.add(power, f.literal(one))
        total = f.add(base, slope)
        lost = f.sum_error(power, f.literal(one), base)
        return total, f.add(f.add(lost, f.sum_error(base, slope, total)), slope_rest)

    value = f.quotient(beside(-1.0), beside(1.0))
    value = f.choose(f.compare("olt", size, f.literal(_TINY)), x, value)
    return f.with_sign_of(value, x)


def _reduced(f: LaneFunction, x: str) -> tuple[str, str, str]:
    """Append the bits that end in k, and r in two doubles, with x = k ln 2 + r."""
    turned = f.add(f.multiply(x, f.literal(_PER_LN2)), f.literal(_ROUNDER))
    k = f.subtract(turned, f.literal(_ROUNDER))
    high = f.subtract(x, f.multiply(k, f.literal(LN2)))
    low = f.multiply(k, f.literal(-LN2_REST))
    r = f.add(high, low)
    return f.bits_of(turned), r, f.sum_error(high, low, r)


def _power_of_two(f: LaneFunction, k: str, shift: int) -> str:
    """Append 2 to the power k + shift, where that is no subnormal number."""
    return f.real_of(f.on_bits("shl", f.on_bits("add", k, 1023 + shift), 52))


def _higher(f: LaneFunction, r: str) -> tuple[str, str]:
    """Append cosh(r) − 1 − r²/2 and sinh(r) − r."""
    z = f.multiply(r, r)
    even = f.multiply(f.multiply(z, z), f.polynomial(z, _EVEN, fused=False))
    return even, f.multiply(f.multiply(r, z), f.polynomial(z, _ODD, fused=False))


def _grown(f: LaneFunction, x: str) -> tuple[str, str, str]:
    """Append the bits that end in k, and exp(r) − 1 in two doubles, with x = k ln 2 + r."""
    k, r, r_rest = _reduced(f, x)
    square, square_rest = f.square_in_two_parts(r)
    half, half_rest = (f.multiply(f.literal(0.5), part) for part in (square, square_rest))
    value = f.add(r, half)
    even, odd = _higher(f, r)
    rest = f.add(f.add(even, odd), f.add(half_rest, f.sum_error(r, half, value)))
    return k, value, f.add(rest, f.add(r_rest, f.multiply(r, r_rest)))


def _halves(f: LaneFunction, size: str) -> tuple[str, str, str, str, str]:
    """Append 2ᵏ/4, 2⁻ᵏ/4, r, cosh(r) − 1 and sinh(r) − r for a positive x = k ln 2 + r."""
    k, r, r_rest = _reduced(f, f.limit(size, 0.0, _LARGEST))
    growing = _power_of_two(f, k, -2)
    # The biased exponents of both, k + 1021 and 1021 − k, add up to 2042.
    turned = f.on_bits("sub", f.whole_literal(2042 << 52), f.bits_of(growing))
    large = f.compare("ogt", size, f.literal(40.0))
    fading = f.choose(large, f.literal(0.0), f.real_of(turned))
    higher, odd = _higher(f, r)
    bend = f.add(f.multiply(f.literal(0.5), f.multiply(r, r)), f.multiply(r, r_rest))
    return growing, fading, r, f.add(bend, higher), f.add(odd, r_rest)


def _mixed(f: LaneFunction, growing: str, fading: str, r: str, even: str, odd: str) -> str:
    """Append 2(growing + fading)(1 + even) + 2(growing − fading)(r + odd)."""
    base, factor = f.add(growing, fading), f.subtract(growing, fading)
    slope = f.multiply(factor, r)
    total = f.add(base, slope)
    rest = f.add(f.sum_error(growing, fading, base), f.sum_error(base, slope, total))
    rest = f.add(rest, f.product_error(factor, r, slope))
    half = f.add(total, f.add(rest, f.add(f.multiply(base, even), f.multiply(factor, odd))))
    return f.add(half, half)
