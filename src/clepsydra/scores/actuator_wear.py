"""Wear of an actuator: how far it travels, and how often it turns.

Both count what a real actuator would do. Moves below its resolution do not reach the stem of a
valve or the speed of a drive, so that rounding and small noise wear nothing; total variation, in
`clepsydra.scores.effort`, counts every move of the signal.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import FloatArray, held_durations, read_trajectories

#: Resolution of a good positioner, as a share of the range.
RESOLUTION = 1e-3
_HOUR = 3600.0


def travel(time: ArrayLike, signal: ArrayLike, low: float, high: float) -> float:
    """Return the way of an actuator of finite resolution, in per cent of its range per hour.

    The actuator stays where it is until the signal is further away than 0.1 % of the range, and
    then goes to the signal.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    signal : array_like [n]
        Manipulated variable, held during each sample.
    low, high : float
        Its range [signal unit].

    Returns
    -------
    float
        [% of the range per hour]; infinite where a value is not finite.

    Raises
    ------
    InputError
        The range is not finite or the wrong way round, time does not increase, or lengths differ.

    References
    ----------
    The definition is ours; resolution as in EnTech, Control Valve Dynamic Specification,
    version 3.0, 1998.

    Examples
    --------
    Up by half the range, and back, in an hour; moves of 0.05 % do not count:

    >>> travel([0.0, 1200.0, 2400.0], [0.0, 5.0, 0.0], low=0.0, high=10.0)
    100.0
    >>> travel([0.0, 1200.0, 2400.0], [0.0, 0.005, 0.0], low=0.0, high=10.0)
    0.0
    """
    span = _span(low, high)
    clock, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    position = first = float(held[0])
    way = 0.0
    smallest = RESOLUTION * span
    for value in _moves(held, first):
        if abs(value - position) > smallest:
            way += abs(value - position)
            position = value
    hours = float(np.sum(held_durations(clock))) / _HOUR
    return 100.0 * way / span / hours


def reversals(time: ArrayLike, signal: ArrayLike, low: float, high: float) -> float:
    """Return how often the manipulated variable turns by more than 0.1 % of its range.

    A turn counts once the signal has come back from its last highest or lowest value by more
    than that dead band.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    signal : array_like [n]
        Manipulated variable, held during each sample.
    low, high : float
        Its range [signal unit].

    Returns
    -------
    float
        A whole number; infinite where a value is not finite.

    Raises
    ------
    InputError
        The range is not finite or the wrong way round, time does not increase, or lengths differ.

    Examples
    --------
    Down, up and down again by more than the dead band: two turns.

    >>> reversals(range(5), [5.0, 4.0, 4.001, 6.0, 5.5], low=0.0, high=10.0)
    2.0
    """
    span = _span(low, high)
    _, (held,), complete = read_trajectories(time, signal)
    if not complete:
        return float("inf")
    band = RESOLUTION * span
    highest = lowest = float(held[0])
    direction, turns = 0, 0
    for value in _moves(held, highest):
        if value > highest:
            highest = value
        if value < lowest:
            lowest = value
        if direction >= 0 and highest - value > band:
            turns += direction > 0
            direction, lowest = -1, value
        elif direction <= 0 and value - lowest > band:
            turns += direction < 0
            direction, highest = 1, value
    return float(turns)


def _moves(held: FloatArray, first: float) -> list[float]:
    """Return the values at which the signal has moved: the others change nothing."""
    moved = np.diff(held, prepend=first) != 0.0
    found: list[float] = held[moved].tolist()
    return found


def _span(low: float, high: float) -> float:
    span = high - low
    if not (math.isfinite(span) and span > 0.0):
        raise InputError(
            "limits",
            f"{low} and {high}",
            "a finite low limit below a finite high limit",
            "give the range of the actuator",
        )
    return span
