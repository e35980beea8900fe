"""The length √(x² + y²) as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction


def hypotenuse(function: LaneFunction, x: str, y: str) -> str:
    """Append √(x² + y²) and return its name.

    The sum of squares stands in two doubles, and the root is corrected by what it lacks; large
    and small arguments are scaled by a power of two. Infinite where one of the two is, even if
    the other is not a number, as C99, annex F.9.4.3, has it.

    Source: Borges, "An improved algorithm for hypot(a,b)", arXiv:1904.09481 (2019), section 4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = hypotenuse(function, "%x", "%y")
    >>> len(function.lines) < 40
    True
    """
    f = function
    one, infinity = f.literal(1.0), f.literal(math.inf)
    width, height = f.magnitude(x), f.magnitude(y)
    swapped = f.compare("ogt", height, width)
    larger, smaller = f.choose(swapped, height, width), f.choose(swapped, width, height)
    huge = f.compare("ogt", larger, f.literal(2.0**500))
    tiny = f.compare("olt", larger, f.literal(2.0**-400))
    up, down = f.literal(2.0**600), f.literal(2.0**-600)
    scale, scale_back = f.choose(tiny, up, one), f.choose(tiny, down, one)
    scale, scale_back = f.choose(huge, down, scale), f.choose(huge, up, scale_back)
    larger, smaller = f.multiply(larger, scale), f.multiply(smaller, scale)
    long, short = f.multiply(larger, larger), f.multiply(smaller, smaller)
    total = f.add(long, short)
    rest = f.add(f.product_error(larger, larger, long), f.product_error(smaller, smaller, short))
    rest = f.add(f.sum_error(long, short, total), rest)
    value = f.multiply(f.add(*f.root_of_sum(total, rest)), scale_back)
    infinite = f.either(f.compare("oeq", width, infinity), f.compare("oeq", height, infinity))
    return f.choose(infinite, infinity, value)
