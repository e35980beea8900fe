"""The error function as straight-line code over lanes."""

from __future__ import annotations

from clepsydra.engine.exponential import exponential
from clepsydra.engine.lane_function import LaneFunction

# Minimax solutions by Remez' exchange in 50 digits, then rounded.
#: erf(x) = x + x(c₀ + c₁z + …) with |x| ≤ 1/2, within 2⁻⁵⁶ of its value.
_NEAR = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.06eba8214db68p-3",
        "-0x1.812746b0379b3p-2",
        "0x1.ce2f21a03d654p-4",
        "-0x1.b82ce30f1d03dp-6",
        "0x1.565bcbf55e0bcp-8",
        "-0x1.c02d4e7c43b6dp-11",
        "0x1.f98d8f2c02feap-14",
        "-0x1.f222108200815p-17",
        "0x1.8b34a7e2bbdb2p-20",
    )
)
#: erf(x) = erf(a) + y(c₀ + c₁y + …) with y = x − a, a ≈ 3/4 and −1/4 ≤ y ≤ 3/8, within 2⁻⁵⁶.
_MIDDLE = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.492e42d78d27dp-1",
        "-0x1.edc5644353c16p-2",
        "0x1.b6e8591f67305p-6",
        "0x1.349b5eaa1365dp-3",
        "-0x1.b42a1890c5986p-5",
        "-0x1.b847796366966p-6",
        "0x1.2e0afb03624f1p-6",
        "0x1.2db32e00e6bdcp-9",
        "-0x1.04105576efc1bp-8",
        "0x1.862a68dd77277p-13",
        "0x1.471f447cf67afp-11",
        "-0x1.bdeb5b9afcbb8p-14",
        "-0x1.3b09d492b62f9p-14",
        "0x1.765dde57f9000p-16",
        "0x1.05f9bf567d385p-18",
    )
)
#: A number next to 3/4 whose error function is nearly a double: the rest of it is below 2⁻⁶⁴.
_CENTRE = float.fromhex("0x1.800000000004ap-1")
_AT_CENTRE = float.fromhex("0x1.6c1c9759d0e8fp-1")
#: exp(x²) erfc(x) = c₀ + c₁u + … with u = (x − 2)/(x + 2) for 9/8 ≤ x ≤ 6: erf x within 2⁻⁵⁶.
_FAR = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.058671b52c778p-2",
        "-0x1.b57034efd3dfdp-2",
        "0x1.eeea7dc8a8a46p-3",
        "-0x1.437f0b69534cfp-4",
        "0x1.e94714d20422bp-9",
        "0x1.ca95ef67cdc9cp-8",
        "-0x1.bc2470e172d49p-11",
        "-0x1.016a8d781598fp-10",
        "0x1.6b56bd70a2ef9p-15",
        "0x1.6bb0c3b349455p-13",
        "0x1.df8353a90e8c4p-16",
        "-0x1.1f2ef278d1d67p-16",
    )
)
#: Beyond it the error function is 1, rounded.
_STEADY = 6.0


def error_function(function: LaneFunction, x: str) -> str:
    """Append erf(x) and return its name.

    A polynomial up to |x| = 1/2 and another one up to 9/8; beyond, 1 − exp(−x²) times a third, of
    (x − 2)/(x + 2). Odd in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 3,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = error_function(function, "%x")
    >>> len(function.lines) < 140
    True
    """
    f = function
    one, two = f.literal(1.0), f.literal(2.0)
    size = f.limit(f.magnitude(x), 0.0, _STEADY)
    square = f.multiply(size, size)
    near = f.fused(size, f.polynomial(square, _NEAR, fused=False), size)

    y = f.subtract(size, f.literal(_CENTRE))
    start, slope = f.literal(_AT_CENTRE), f.literal(_MIDDLE[0])
    rise = f.multiply(y, slope)
    middle = f.add(start, rise)
    lost = f.add(f.sum_error(start, rise, middle), f.product_error(y, slope, rise))
    bend = f.multiply(f.multiply(y, y), f.polynomial(y, _MIDDLE[1:], fused=False))
    middle = f.add(middle, f.add(bend, lost))

    opposite = f.negative(square)
    lost = f.product_error(f.negative(size), size, opposite)
    ratio = f.divide(f.subtract(size, two), f.add(size, two))
    minus_factor = f.negative(f.polynomial(ratio, _FAR))
    far = f.fused(exponential(f, opposite, lost), minus_factor, one)

    value = f.choose(f.compare("olt", size, f.literal(1.125)), middle, far)
    value = f.choose(f.compare("olt", size, f.literal(0.5)), near, value)
    return f.with_sign_of(value, x)
