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


def each_finite_or_infinite(function: Callable[..., FloatArray]) -> Callable[..., FloatArray]:
    """Let a function of time [n] and of several outputs side by side [outputs, n] do the same.

    It returns a score for each output, which is infinite where a value of that is not finite.

    Examples
    --------
    >>> @each_finite_or_infinite
    ... def ends(time: FloatArray, outputs: FloatArray) -> FloatArray:
    ...     return outputs[:, -1]
    >>> ends([0, 1], [[2, 3], [float("nan"), 3]])
    array([ 3., inf])
    """

    @wraps(function)
    def checked(time: ArrayLike, outputs: ArrayLike, *given: Any, **named: Any) -> FloatArray:
        clock, (rows,), complete = read_trajectories(time, outputs)
        if complete:
            return function(clock, rows, *given, **named)
        whole = np.isfinite(rows).all(axis=-1)
        found = np.full(len(rows), np.inf)
        found[whole] = function(clock, rows[whole], *given, **named)
        return found

    return checked


def held_durations(time: FloatArray) -> FloatArray:
    """Return how long the value of each sample is held [s]; the last one as long as that before."""
    return np.diff(time, append=2.0 * time[-1] - time[-2])


def first_crossings(elapsed: FloatArray, signals: FloatArray, threshold: float) -> FloatArray:
    """Return when each of several signals [signals, n] first reaches a threshold from below [s].

    Instants between samples are read from a straight line; infinite where it is never reached.

    Examples
    --------
    >>> first_crossings(np.array([0.0, 1.0]), np.array([[0.0, 4.0], [2.0, 2.0], [0.0, 0.5]]), 1.0)
    array([0.25, 0.  ,  inf])
    """
    reached = signals >= threshold
    first = reached.argmax(axis=-1)
    found = np.where(reached[:, 0], elapsed[0], np.inf)
    within = np.flatnonzero(first)
    k = first[within]
    low, high = signals[within, k - 1], signals[within, k]
    part = (threshold - low) / (high - low)
    found[within] = elapsed[k - 1] + part * (elapsed[k] - elapsed[k - 1])
    return found


def last_entries(elapsed: FloatArray, distances: FloatArray, band: float) -> FloatArray:
    """Return when each of several distances [distances, n] enters a band around zero for good [s].

    Instants between samples are read from a straight line, and the edge belongs to the band. 0
    where a distance never leaves it, infinite where it ends outside.

    Examples
    --------
    >>> last_entries(np.array([0.0, 1.0]), np.array([[-4.0, 0.0], [0.5, 0.0], [0.0, 2.0]]), 1.0)
    array([0.75, 0.  ,  inf])
    """
    outside = np.abs(distances) > band
    last = distances.shape[-1] - 1
    k = last - outside[:, ::-1].argmax(axis=-1)
    found = np.where(outside[:, last], np.inf, 0.0)
    # Where nothing lies outside, that is the last sample too.
    within = np.flatnonzero(k < last)
    k = k[within]
    far, near = distances[within, k], distances[within, k + 1]
    part = (np.where(far > 0.0, band, -band) - far) / (near - far)
    found[within] = elapsed[k] + part * (elapsed[k + 1] - elapsed[k])
    return found
