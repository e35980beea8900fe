"""Limits of a manipulated variable."""

from __future__ import annotations

import casadi as ca


def limit(value: ca.SX, low: ca.SX, high: ca.SX) -> ca.SX:
    """Return a value held between two limits: min(high, max(low, value)).

    The limit stands first in both comparisons, so that a limit which is not a number is
    passed over (``low > value ? low : value`` is the value); `value` must be a number.

    Parameters
    ----------
    value, low, high : casadi.SX
        Scalars of one unit.

    Examples
    --------
    >>> [float(limit(ca.DM(value), ca.DM(0), ca.DM(10))) for value in (-1, 4, 11)]
    [0.0, 4.0, 10.0]
    """
    return ca.fmin(high, ca.fmax(low, value))
