"""The remainder of a division, with the sign of the dividend, as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction

#: Beyond it a quotient is a whole number whatever its remainder; not-a-number there.
LARGEST_QUOTIENT = 2.0**53


def remainder(function: LaneFunction, x: str, y: str) -> str:
    """Append x − n·y with n = x/y towards 0, as C's fmod, and return its name.

    The quotient, rounded, is n or one more, and what is left over after one fused step is exact.
    Not-a-number where the quotient is beyond 2⁵³: a loop of as many steps as the two differ in
    binary digits would be needed.

    Source: Muller et al., Handbook of Floating-Point Arithmetic, 2nd edition (2018), chapter 5,
    doi:10.1007/978-3-319-76526-6.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = remainder(function, "%x", "%y")
    >>> len(function.lines) < 20
    True
    """
    f = function
    dividend, divisor = f.magnitude(x), f.magnitude(y)
    quotient = f.divide(dividend, divisor)
    whole = f.intrinsic("floor", [quotient])
    left = f.fused(f.negative(whole), divisor, dividend)
    left = f.choose(f.compare("olt", left, f.literal(0.0)), f.add(left, divisor), left)
    # Less than the divisor, an infinite one among them, a dividend is what is left of it.
    left = f.choose(f.compare("olt", dividend, divisor), dividend, left)
    within = f.compare("olt", quotient, f.literal(LARGEST_QUOTIENT))
    return f.with_sign_of(f.choose(within, left, f.literal(math.nan)), x)
