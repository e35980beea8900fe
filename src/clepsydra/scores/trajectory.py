"""Trajectories as the scores read them: checked once, in one place."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError

FloatArray = NDArray[np.float64]


def read_trajectories(
    time: ArrayLike, *signals: ArrayLike
) -> tuple[FloatArray, tuple[FloatArray, ...], bool]:
    """Return time and signals as arrays, and whether every value of the signals is finite.

    A run that broke off leaves values that are not finite. Every score of such a run is
    infinite, so that it ranks last whatever it is compared by.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s], increasing, n ≥ 2.
    *signals : array_like [n]
        One value for each sample.

    Returns
    -------
    tuple
        Time [n], the signals [n] each, and True where all their values are finite.

    Raises
    ------
    InputError
        Time has fewer than two samples, does not increase or is not finite, or a signal
        has another length.

    Examples
    --------
    >>> read_trajectories([0, 1], [2, 3])[2], read_trajectories([0, 1], [2, float("nan")])[2]
    (True, False)
    """
    clock = np.asarray(time, dtype=np.float64)
    if clock.ndim != 1 or clock.size < 2:
        raise InputError(
            "time",
            f"an array of shape {clock.shape}",
            "one dimension with at least two samples",
            "score a run of two samples or more",
        )
    if not np.all(np.isfinite(clock)) or not np.all(np.diff(clock) > 0.0):
        raise InputError(
            "time",
            "a sequence that does not increase",
            "finite instants [s], each later than the one before",
            "sort the samples by time and drop those that stand twice",
        )
    values = tuple(np.asarray(signal, dtype=np.float64) for signal in signals)
    for signal in values:
        if signal.shape != clock.shape:
            raise InputError(
                "signal",
                f"an array of shape {signal.shape}",
                f"one value for each of the {clock.size} samples of time",
                "pass time and signals of the same run",
            )
    return clock, values, all(bool(np.all(np.isfinite(signal))) for signal in values)


def finite_or_infinite(function: Callable[..., float]) -> Callable[..., float]:
    """Let a function of time and signals take whatever is like an array, and be infinite else.

    Its arguments that are declared as `FloatArray` are read as `read_trajectories` does; where a
    value is not finite it is not asked, and the score is infinite.

    Examples
    --------
    >>> @finite_or_infinite
    ... def end(time: FloatArray, signal: FloatArray, scale: float = 1.0) -> float:
    ...     return float(scale * signal[-1])
    >>> end([0, 1], [2, 3], scale=2.0), end([0, 1], [float("nan"), 3])
    (6.0, inf)
    """
    signals = list(function.__annotations__.values()).count("FloatArray") - 1

    @wraps(function)
    def checked(time: ArrayLike, *given: Any, **named: Any) -> float:
        clock, arrays, complete = read_trajectories(time, *given[:signals])
        return function(clock, *arrays, *given[signals:], **named) if complete else math.inf

    return checked


def held_durations(time: FloatArray) -> FloatArray:
    """Return how long the value of each sample is held [s]; the last one as long as that before.

    Parameters
    ----------
    time : ndarray [n]

    Examples
    --------
    >>> held_durations(np.array([0.0, 1.0, 3.0])).tolist()
    [1.0, 2.0, 2.0]
    """
    return np.diff(time, append=2.0 * time[-1] - time[-2])


def first_crossing(elapsed: FloatArray, signal: FloatArray, threshold: float) -> float:
    """Return when a signal first reaches a threshold from below, between samples by a line.

    Parameters
    ----------
    elapsed : ndarray [n]
        [s]
    signal : ndarray [n]

    Returns
    -------
    float
        [s]; infinite where the threshold is never reached.

    Examples
    --------
    >>> first_crossing(np.array([0.0, 1.0]), np.array([0.0, 4.0]), 1.0)
    0.25
    """
    reached = np.flatnonzero(signal >= threshold)
    if reached.size == 0:
        return float("inf")
    k = int(reached[0])
    if k == 0:
        return float(elapsed[0])
    part = (threshold - signal[k - 1]) / (signal[k] - signal[k - 1])
    return float(elapsed[k - 1] + part * (elapsed[k] - elapsed[k - 1]))


def last_entry(elapsed: FloatArray, distance: FloatArray, band: float) -> float:
    """Return when a distance enters a band around zero for good, between samples by a line.

    Parameters
    ----------
    elapsed : ndarray [n]
        [s]
    distance : ndarray [n]
        Signed distance to the value that the band lies around.
    band : float
        Half the width of the band, in the unit of the distance; its edge belongs to it.

    Returns
    -------
    float
        [s]; 0 where the distance never leaves the band, infinite where it ends outside.

    Examples
    --------
    >>> last_entry(np.array([0.0, 1.0]), np.array([-4.0, 0.0]), 1.0)
    0.75
    """
    outside = np.flatnonzero(np.abs(distance) > band)
    if outside.size == 0:
        return 0.0
    k = int(outside[-1])
    if k == distance.size - 1:
        return float("inf")
    edge = band if distance[k] > 0.0 else -band
    part = (edge - distance[k]) / (distance[k + 1] - distance[k])
    return float(elapsed[k] + part * (elapsed[k + 1] - elapsed[k]))
