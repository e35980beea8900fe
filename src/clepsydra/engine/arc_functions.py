"""The inverse sine and cosine as straight-line code over lanes."""

from __future__ import annotations

from clepsydra.engine.lane_function import LaneFunction

#: arcsin(s) = s + s·z(c₀ + c₁z + …) with z = s² ≤ 1/4, within 2⁻⁵⁹ of its value: the minimax
#: solution by Remez' exchange in 50 digits, then rounded.
_ARC_SINE = tuple(
    float.fromhex(digits)
    for digits in (
        "0x1.5555555555577p-3",
        "0x1.333333332e102p-4",
        "0x1.6db6db72142a7p-5",
        "0x1.f1c71a946525bp-6",
        "0x1.6e8bdeedbf15ep-6",
        "0x1.1c49ef86b1803p-6",
        "0x1.ca1f9f7275393p-7",
        "0x1.7585039ecd22cp-7",
        "0x1.613f3f3fd4248p-7",
        "0x1.e5cfb34766eaap-9",
        "0x1.63a734c754ef8p-6",
        "-0x1.580bd279b198ep-6",
        "0x1.0b4afc9ad1bf7p-5",
    )
)
_QUARTER_TURN = (float.fromhex("0x1.921fb54442d18p+0"), float.fromhex("0x1.1a62633145c07p-54"))


def arc_sine(function: LaneFunction, x: str) -> str:
    """Append arcsin(x) and return its name.

    Up to |x| = 1/2 a polynomial; beyond, π/2 − 2 arcsin √((1 − |x|)/2), where π/2 and the root
    stand in two doubles each. Odd in every bit; not-a-number beyond ±1.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = arc_sine(function, "%x")
    >>> len(function.lines) < 80
    True
    """
    f = function
    zero = f.literal(0.0)
    near, head, rest, tail = _arc(f, x)
    base = f.choose(near, zero, f.literal(0.5 * _QUARTER_TURN[0]))
    base_rest = f.choose(near, zero, f.literal(0.5 * _QUARTER_TURN[1]))
    half = _remainder(f, (base, base_rest), head, f.add(rest, tail))
    return f.with_sign_of(f.choose(near, half, f.add(half, half)), x)


def arc_cosine(function: LaneFunction, x: str) -> str:
    """Append arccos(x) and return its name.

    Up to |x| = 1/2 it is π/2 − arcsin x; beyond, 2 arcsin √((1 − x)/2) for positive x, and π less
    that of −x for negative x. Not-a-number beyond ±1.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = arc_cosine(function, "%x")
    >>> len(function.lines) < 80
    True
    """
    f = function
    zero = f.literal(0.0)
    near, head, rest, tail = _arc(f, x)
    # Signs that take sizes to what is taken from the base: that of x, or the opposite.
    sign = f.choose(near, x, f.negative(x))
    head, rest, tail = (f.with_sign_of(head, sign), _turned(f, rest, sign), _turned(f, tail, sign))
    right = f.compare("ogt", x, f.literal(0.5))
    base = f.choose(right, zero, f.literal(_QUARTER_TURN[0]))
    base_rest = f.choose(right, zero, f.literal(_QUARTER_TURN[1]))
    value = _remainder(f, (base, base_rest), head, f.add(rest, tail))
    return f.choose(near, value, f.add(value, value))


def _arc(f: LaneFunction, x: str) -> tuple[str, str, str, str]:
    """Append arcsin|x| for |x| ≤ 1/2, which is told first, or arcsin √((1 − |x|)/2), in parts.

    The parts are the argument's leading digits, its rest, and what the arc is longer.
    """
    half = f.literal(0.5)
    size = f.magnitude(x)
    near = f.compare("ole", size, half)
    far = f.subtract(half, f.multiply(half, size))
    z = f.choose(near, f.multiply(size, size), far)
    head, rest = f.root_in_two_parts(far)
    head = f.choose(near, size, head)
    rest = f.choose(near, f.literal(0.0), rest)
    bend = f.multiply(z, f.polynomial(z, _ARC_SINE, fused=False))
    return near, head, rest, f.multiply(f.add(head, rest), bend)


def _remainder(f: LaneFunction, base: tuple[str, str], head: str, rest: str) -> str:
    """Append base − (head + rest), where the base is 0 or larger than the head."""
    left = f.subtract(base[0], head)
    lost = f.subtract(f.subtract(base[0], left), head)
    return f.add(left, f.add(lost, f.subtract(base[1], rest)))


def _turned(f: LaneFunction, x: str, sign: str) -> str:
    """Append x, with the other sign where the second value is negative."""
    return f.multiply(x, f.with_sign_of(f.literal(1.0), sign))
