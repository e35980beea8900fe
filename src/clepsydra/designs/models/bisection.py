"""The frequency, or the time, at which something ceases to hold."""

from __future__ import annotations

import math
from collections.abc import Callable

_STEPS = 100


def last_before(
    low: float, high: float, holds: Callable[[float], bool], accuracy: float = 0.0
) -> float:
    """Return the last number between two up to which something holds, by bisection of logarithms.

    Parameters
    ----------
    low, high : float
        Above zero; at `low` it is taken to hold, at `high` not to.
    accuracy : float
        A share; as near as numbers are where it is left out.

    Examples
    --------
    >>> round(last_before(1.0, 10.0, lambda x: x**2 < 2.0), 6)
    1.414214
    """
    for _ in range(_STEPS):
        if high <= low * (1.0 + accuracy):
            break
        middle = math.sqrt(low * high)
        if not low < middle < high:  # neighbouring numbers
            break
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
