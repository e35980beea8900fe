"""The inverse tangent, of one number and of two, as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction

#: arctan(t) = t + t·z(c₀ + c₁z + …) with |t| ≤ tan(π/8), within 2⁻⁵⁸ of its value: c₀
#: is fixed and the others are the minimax solution by Remez' exchange in 50 digits, then rounded.
_ARC_TANGENT = tuple(
    float.fromhex(digits)
    for digits in (
        "-0x1.5555555555555p-2",
        "0x1.9999999998267p-3",
        "-0x1.2492492388008p-3",
        "0x1.c71c712f7c9a5p-4",
        "-0x1.745d0022a9900p-4",
        "0x1.3b118d4fecc53p-4",
        "-0x1.10f06a8571f00p-4",
        "0x1.df4e26b8d8b08p-5",
        "-0x1.9dd96a214aeaep-5",
        "0x1.3a44d71643303p-5",
        "-0x1.2a6c2e5903c7fp-6",
    )
)
#: π/4, whose double happens to end in three zeros, so that multiples up to 8 are exact; its rest.
_EIGHTH_TURN = float.fromhex("0x1.921fb54442d18p-1")
_EIGHTH_TURN_REST = float.fromhex("0x1.1a62633145c07p-55")
#: tan(π/8): a larger ratio is turned by π/4, which makes it smaller.
_STEEP = 0.41421356
#: Beyond it every arctangent is π/2, rounded.
_LARGEST = 2.0**1000


def arc_tangent(function: LaneFunction, x: str) -> str:
    """Append arctan(x) and return its name.

    The ratio of the smaller to the larger of |x| and 1 is turned by π/4 where it is beyond
    tan(π/8); the quotient and the multiple of π/4 stand in two doubles each. Odd in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = arc_tangent(function, "%x")
    >>> len(function.lines) < 80
    True
    """
    f = function
    one = f.literal(1.0)
    size = f.limit(f.magnitude(x), 0.0, _LARGEST)
    swapped = f.compare("ogt", size, one)
    smaller, larger = f.choose(swapped, one, size), f.choose(swapped, size, one)
    direction = f.choose(swapped, f.literal(-1.0), one)
    start = f.choose(swapped, f.literal(2.0), f.literal(0.0))
    return f.with_sign_of(_angle(f, smaller, larger, start, direction), x)


def arc_tangent_of_two(function: LaneFunction, y: str, x: str) -> str:
    """Append the angle of the point (x, y), in (−π, π], and return its name.

    As the arctangent of the smaller to the larger of |x| and |y|, from the axis that is next to
    the point; zeros and infinities follow C99, annex F.9.1.4. Odd in y in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = arc_tangent_of_two(function, "%y", "%x")
    >>> len(function.lines) < 90
    True
    """
    f = function
    zero, one, minus_one = f.literal(0.0), f.literal(1.0), f.literal(-1.0)
    height, width = f.magnitude(y), f.magnitude(x)
    swapped = f.compare("ogt", height, width)
    smaller, larger = f.choose(swapped, width, height), f.choose(swapped, height, width)
    # Neither the sum of both nor what the quotient leaves over may leave the range of a double.
    huge = f.compare("ogt", larger, f.literal(2.0**1000))
    tiny = f.compare("olt", larger, f.literal(2.0**-900))
    scale = f.choose(huge, f.literal(0.25), f.choose(tiny, f.literal(2.0**110), one))
    smaller, larger = f.multiply(smaller, scale), f.multiply(larger, scale)
    infinity = f.literal(math.inf)
    infinite = f.compare("oeq", larger, infinity)
    # Beside an infinite one a finite number counts as 0, and not-a-number stays what it is.
    limited = f.choose(f.compare("oeq", smaller, infinity), one, f.multiply(smaller, zero))
    smaller = f.choose(infinite, limited, smaller)
    single = f.either(infinite, f.compare("oeq", larger, zero))
    larger = f.choose(single, one, larger)
    backward = f.compare("olt", f.with_sign_of(one, x), zero)
    turn = f.choose(swapped, minus_one, one)
    direction = f.choose(backward, f.negative(turn), turn)
    start = f.choose(backward, f.literal(4.0), zero)
    start = f.choose(swapped, f.literal(2.0), start)
    return f.with_sign_of(_angle(f, smaller, larger, start, direction), y)


def _angle(f: LaneFunction, smaller: str, larger: str, start: str, direction: str) -> str:
    """Append start·π/4 + direction·arctan(smaller/larger), for a direction of 1 or −1.

    Both are positive or 0, and the larger one is not 0.
    """
    zero = f.literal(0.0)
    steep = f.compare("ogt", smaller, f.multiply(f.literal(_STEEP), larger))
    opposite = f.negative(larger)
    gap, total = f.add(opposite, smaller), f.add(larger, smaller)
    gap_rest = f.sum_error(opposite, smaller, gap)
    total_rest = f.sum_error(larger, smaller, total)
    above, below = f.choose(steep, gap, smaller), f.choose(steep, total, larger)
    t = f.divide(above, below)
    lost = f.choose(steep, f.subtract(gap_rest, f.multiply(t, total_rest)), zero)
    missing = f.add(f.fused(f.negative(t), below, above), lost)
    z = f.multiply(t, t)
    bend = f.multiply(f.multiply(t, z), f.polynomial(z, _ARC_TANGENT, fused=False))
    # What the quotient lacks turns the angle by 1/(1 + t²) of it.
    tail = f.add(bend, f.divide(missing, f.add(below, f.multiply(below, z))))

    eighths = f.add(start, f.choose(steep, direction, zero))
    base = f.multiply(eighths, f.literal(_EIGHTH_TURN))
    turned = f.multiply(direction, t)
    angle = f.add(base, turned)
    rest = f.add(f.multiply(direction, tail), f.multiply(eighths, f.literal(_EIGHTH_TURN_REST)))
    return f.add(angle, f.add(f.sum_error(base, turned, angle), rest))
