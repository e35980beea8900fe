"""The inverse hyperbolic functions as straight-line code over lanes."""

from __future__ import annotations

import math

from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.logarithm import logarithm_of_double, logarithm_of_one_plus

#: Beyond it √(x² ± 1) is |x|, rounded, and its square stays a double below.
_LARGE = 2.0**60
#: arsinh x and artanh x are x below, rounded.
_TINY = 2.0**-28


def inverse_hyperbolic_sine(function: LaneFunction, x: str) -> str:
    """Append arsinh(x) and return its name.

    ln(1 + w) with w = |x| + (√(1 + x²) − 1), which is summed in two doubles. Odd in every bit.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = inverse_hyperbolic_sine(function, "%x")
    >>> len(function.lines) < 150
    True
    """
    f = function
    one = f.literal(1.0)
    size = f.magnitude(x)
    limited = f.limit(size, 0.0, _LARGE)
    square = f.multiply(limited, limited)
    whole, lost = f.exact_sum(one, square)
    lost = f.add(lost, f.product_error(limited, limited, square))
    root, root_rest = f.root_of_sum(whole, lost)
    beyond = f.subtract(root, one)
    total, rest = f.exact_sum(limited, beyond)
    near = logarithm_of_one_plus(f, total, f.add(rest, root_rest))
    value = f.choose(f.compare("olt", size, f.literal(_LARGE)), near, logarithm_of_double(f, size))
    value = f.choose(f.compare("olt", size, f.literal(_TINY)), x, value)
    return f.with_sign_of(value, x)


def inverse_hyperbolic_cosine(function: LaneFunction, x: str) -> str:
    """Append arcosh(x) and return its name.

    ln(1 + w) with w = t + √(t(t + 2)), t = x − 1, in two doubles each. Not-a-number below 1.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = inverse_hyperbolic_cosine(function, "%x")
    >>> len(function.lines) < 160
    True
    """
    f = function
    limited = f.limit(x, -1.0, _LARGE)
    t, t_rest = f.exact_sum(limited, f.literal(-1.0))
    # t(t + 2) = t² + 2t; its two terms are summed in two doubles.
    square, twice = f.multiply(t, t), f.add(t, t)
    whole, lost = f.exact_sum(square, twice)
    lost = f.add(lost, f.product_error(t, t, square))
    slope = f.multiply(f.add(twice, f.literal(2.0)), t_rest)
    root, root_rest = f.root_of_sum(whole, f.add(lost, slope))
    total, rest = f.exact_sum(t, root)
    rest = f.add(rest, f.add(root_rest, t_rest))
    near = logarithm_of_one_plus(f, total, rest)
    value = f.choose(f.compare("olt", x, f.literal(_LARGE)), near, logarithm_of_double(f, x))
    return f.choose(f.compare("oge", x, f.literal(1.0)), value, f.literal(math.nan))


def inverse_hyperbolic_tangent(function: LaneFunction, x: str) -> str:
    """Append artanh(x) and return its name.

    ln(1 + w)/2 with w = 2|x|/(1 − |x|) in two doubles. Odd in every bit; infinite at ±1, and
    not-a-number beyond.

    Source: Muller, Elementary Functions, 3rd edition (2016), chapter 11,
    doi:10.1007/978-1-4899-7983-4.

    Examples
    --------
    >>> function = LaneFunction(8)
    >>> result = inverse_hyperbolic_tangent(function, "%x")
    >>> len(function.lines) < 90
    True
    """
    f = function
    one = f.literal(1.0)
    size = f.magnitude(x)
    below = f.subtract(one, size)
    below_rest = f.sum_error(one, f.negative(size), below)
    above = f.add(size, size)
    ratio = f.divide(above, below)
    missing = f.fused(f.negative(ratio), below, above)
    missing = f.subtract(missing, f.multiply(ratio, below_rest))
    double = logarithm_of_one_plus(f, ratio, f.divide(missing, below))
    value = f.multiply(f.literal(0.5), double)
    value = f.choose(f.compare("olt", size, f.literal(_TINY)), x, value)
    value = f.choose(f.compare("oeq", size, one), f.literal(math.inf), value)
    value = f.choose(f.compare("ogt", size, one), f.literal(math.nan), value)
    return f.with_sign_of(value, x)
