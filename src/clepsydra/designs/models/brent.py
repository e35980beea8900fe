"""Brent's two searches along one number, for a root and for the lowest place, without slopes."""

from __future__ import annotations

import math
from collections.abc import Callable

_ITERATIONS = 500
_GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))
#: Nearer to a lowest place, as a share of it, no function shows a difference.
_ROUNDING = math.sqrt(2.2e-16)
#: Of a root: its place is as near as this share of it, and this beside it, unless said otherwise.
_RELATIVE = 4.0 * 2.0**-52
_ABSOLUTE = 2e-12


def root_between(
    function: Callable[[float], float],
    low: float,
    high: float,
    *,
    absolute: float = _ABSOLUTE,
    relative: float = _RELATIVE,
) -> float:
    """Return where a function is zero between two places at which it has different signs.

    Steps along a chord, or along a parabola of the inverse function, and halves where these
    gain too little. The steps are those of `scipy.optimize.brentq`, whose import takes longer than
    the designs that need a root.

    Parameters
    ----------
    absolute, relative : float
        The accuracy of the root, and as a share of it.

    Raises
    ------
    ValueError
        The signs at the ends are the same.

    References
    ----------
    R. P. Brent, Algorithms for Minimization Without Derivatives, Prentice-Hall 1973, chapter 4.

    Examples
    --------
    >>> round(root_between(lambda x: x**2 - 2.0, 1.0, 2.0), 12)
    1.414213562373
    """
    before, place, other = float(low), float(high), 0.0
    before_height, height, other_height = function(before), function(place), 0.0
    if before_height == 0.0:
        return before
    if height == 0.0:
        return place
    if (before_height > 0.0) == (height > 0.0):
        raise ValueError(f"no change of sign between {low:g} and {high:g}")
    last = step = 0.0
    for _ in range(_ITERATIONS):
        if height != 0.0 and before_height != 0.0 and (before_height > 0.0) != (height > 0.0):
            other, other_height = before, before_height
            last = step = place - before
        if abs(other_height) < abs(height):
            before, place, other = place, other, place
            before_height, height, other_height = height, other_height, height
        near, half = (absolute + relative * abs(place)) / 2.0, (other - place) / 2.0
        if height == 0.0 or abs(half) < near:
            break
        tried = None
        if abs(last) > near and abs(height) < abs(before_height):
            if before == other:
                tried = -height * (place - before) / (height - before_height)
            else:
                slope = (before_height - height) / (before - place)
                further = (other_height - height) / (other - place)
                rise = other_height * further - before_height * slope
                tried = -height * rise / (further * slope * (other_height - before_height))
        if tried is not None and 2.0 * abs(tried) < min(abs(last), 3.0 * abs(half) - near):
            last, step = step, tried
        else:
            last = step = half
        before, before_height = place, height
        place += step if abs(step) > near else math.copysign(near, half)
        height = function(place)
    return place


def lowest_between(
    function: Callable[[float], float], low: float, high: float, accuracy: float
) -> float:
    """Return where a function is lowest between two places, off which the search stays.

    Steps to the bottom of a parabola through the three lowest places, or by golden section where
    that gains too little: those of SciPy's bounded `minimize_scalar`.

    Parameters
    ----------
    accuracy : float
        Of the place.

    References
    ----------
    R. P. Brent, Algorithms for Minimization Without Derivatives, Prentice-Hall 1973, chapter 5.

    Examples
    --------
    >>> round(lowest_between(lambda x: (x - 1.0) ** 2, 0.0, 3.0, 1e-6), 6)
    1.0
    """
    place = second = third = low + _GOLDEN * (high - low)
    height = second_height = third_height = function(place)
    last = step = 0.0
    for _ in range(_ITERATIONS):
        middle, near = 0.5 * (low + high), _ROUNDING * abs(place) + accuracy / 3.0
        if abs(place - middle) <= 2.0 * near - 0.5 * (high - low):
            break
        golden = True
        if abs(last) > near:
            r = (place - second) * (height - third_height)
            q = (place - third) * (height - second_height)
            p = (place - third) * q - (place - second) * r
            q = 2.0 * (q - r)
            p, q = (-p if q > 0.0 else p), abs(q)
            limit, last = last, step
            if abs(p) < abs(0.5 * q * limit) and q * (low - place) < p < q * (high - place):
                golden, step = False, p / q
                if min(place + step - low, high - (place + step)) < 2.0 * near:
                    step = math.copysign(near, middle - place)
        if golden:
            last = (low if place >= middle else high) - place
            step = _GOLDEN * last
        size = max(abs(step), near)
        tried = place + (size if step >= 0.0 else -size)
        found = function(tried)
        if found <= height:
            low, high = (place, high) if tried >= place else (low, place)
            third, third_height = second, second_height
            second, second_height = place, height
            place, height = tried, found
        else:
            low, high = (tried, high) if tried < place else (low, tried)
            if found <= second_height or second == place:
                third, third_height = second, second_height
                second, second_height = tried, found
            elif found <= third_height or third in (place, second):
                third, third_height = tried, found
    return place
