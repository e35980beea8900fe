"""Scores of the manipulated variable: how much it moved, and how long it stood at a limit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import read_trajectories

#: A value within this share of the range of a limit stands at the limit; covers rounding only.
AT_LIMIT = 1e-9


def total_variation(time: ArrayLike, signal: ArrayLike) -> float:
    """Return the sum of all moves, TV = Σ |u_{k+1} - u_k|.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    signal : array_like [n]
        Manipulated variable, held during each sample.

    Returns
    -------
    float
        [signal unit]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    S. Skogestad, Journal of Process Control 13, 2003, doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> total_variation([0.0, 1.0, 2.0], [3.0, 5.0, 4.0])
    3.0
    """
    _, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    return float(np.sum(np.abs(np.diff(held))))


def time_in_saturation(time: ArrayLike, signal: ArrayLike, low: float, high: float) -> float:
    """Return how long the manipulated variable stood at one of its limits.

    The value of sample k holds from t_k to t_{k+1}; the last sample is as long as the one
    before it.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    signal : array_like [n]
        Manipulated variable, held during each sample.
    low, high : float
        Its limits [signal unit]; infinite where there is none.

    Returns
    -------
    float
        [s]; infinite where a value is not finite.

    Raises
    ------
    InputError
        The limits are not in order, time does not increase, or lengths differ.

    Examples
    --------
    >>> time_in_saturation([0.0, 1.0, 2.0, 3.0], [0.0, 4.0, 10.0, 10.0], low=0.0, high=10.0)
    3.0
    """
    if not low < high:
        raise InputError(
            "limits", f"{low} and {high}", "a low limit below the high limit", "swap or widen them"
        )
    clock, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    duration = np.diff(clock, append=2.0 * clock[-1] - clock[-2])
    return float(np.sum(duration[at_limit(held, low, high)]))


def at_limit(held: np.ndarray, low: float, high: float) -> np.ndarray:
    """Tell of each sample whether the manipulated variable stands at one of its limits.

    Parameters
    ----------
    held : ndarray [n]
        Manipulated variable [signal unit].
    low, high : float
        Its limits [signal unit]; infinite where there is none.

    Returns
    -------
    ndarray [n], bool

    Examples
    --------
    >>> at_limit(np.array([0.0, 4.0, 10.0]), low=0.0, high=10.0).tolist()
    [True, False, True]
    """
    tolerance = AT_LIMIT * (high - low) if math.isfinite(high - low) else 0.0
    return np.asarray((held <= low + tolerance) | (held >= high - tolerance))
