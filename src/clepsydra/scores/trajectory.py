"""Trajectories as the scores read them, and when they cross a value."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def read_trajectories(
    time: ArrayLike, *signals: ArrayLike
) -> tuple[FloatArray, tuple[FloatArray, ...], bool]:
    """Return time [s] and signals as arrays [n], and whether every value of the signals is finite.

    A run that broke off leaves values that are not finite. Every score of such a run is
    infinite, so that it ranks last whatever it is compared by.
    """
    clock = np.asarray(time, dtype=np.float64)
    values = tuple(np.asarray(signal, dtype=np.float64) for signal in signals)
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
    """Return how long the value of each sample is held [s]; the last one as long as that before."""
    return np.diff(time, append=2.0 * time[-1] - time[-2])


def first_crossing(elapsed: FloatArray, signal: FloatArray, threshold: float) -> float:
    """Return when a signal first reaches a threshold from below [s], between samples by a line.

    Infinite where it is never reached.

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
    """Return when a distance enters a band around zero for good [s], between samples by a line.

    The edge belongs to the band. 0 where the distance never leaves it, infinite where it ends
    outside.

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
