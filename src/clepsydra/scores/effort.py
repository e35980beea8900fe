"""Scores of what a controller moves: how far it moved, and how long it stood at a limit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import held_durations, read_trajectories

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


def noise_movement(time: ArrayLike, signal: ArrayLike) -> float:
    """Return how far measurement noise throws the manipulated variable about.

    The root mean square of its moves from sample to sample over √2: for a controller of gain K
    and white noise of standard deviation σ that is K σ, whatever drifts slowly below.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s], of a stretch in which nothing happens but noise.
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
    J. von Neumann, Distribution of the ratio of the mean square successive difference to the
    variance, Annals of Mathematical Statistics 12(4), 1941, 367-395,
    doi 10.1214/aoms/1177731677.

    Examples
    --------
    >>> noise_movement([0.0, 1.0, 2.0], [3.0, 5.0, 3.0]) == 2.0**0.5
    True
    """
    _, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    return float(np.sqrt(np.mean(np.diff(held) ** 2) / 2.0))


def peak_move(time: ArrayLike, signal: ArrayLike) -> float:
    """Return how far the manipulated variable goes from where it began, max |u_k - u_0|.

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

    Examples
    --------
    >>> peak_move([0.0, 1.0, 2.0], [3.0, 5.0, -1.0])
    4.0
    """
    _, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    return float(np.max(np.abs(held - held[0])))


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
    return float(np.sum(held_durations(clock)[at_limit(held, low, high)]))


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
