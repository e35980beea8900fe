"""Scores of the response to one setpoint step.

All of them look at the relative response z = (y - start) / (target - start), so a step down
is judged exactly like a step up, and read the instants between samples from a straight line.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import FloatArray, first_crossing, from_sample, last_entry


def overshoot(
    time: ArrayLike, output: ArrayLike, start: float, target: float, index: int = 0
) -> float:
    """Return how far the output passes its target, 100 max(0, max z - 1).

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    output : array_like [n]
        In the signal's unit, without measurement noise.
    start, target : float
        Setpoint before and after the step [signal unit].
    index : int
        The sample at which the setpoint steps.

    Returns
    -------
    float
        [% of the step]; 0 where the output stays short of its target, infinite where a
        value is not finite.

    Raises
    ------
    InputError
        The step has no size, the index no sample after it, or lengths differ.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd edition, Wiley,
    2005, chapter 2.

    Examples
    --------
    >>> overshoot([0.0, 1.0, 2.0], [4.0, 1.5, 2.0], start=4.0, target=2.0)
    25.0
    """
    _, response, complete = _relative_response(time, output, start, target, index)
    if not complete:
        return float("inf")
    return 100.0 * max(0.0, float(np.max(response)) - 1.0)


def rise_time(
    time: ArrayLike, output: ArrayLike, start: float, target: float, index: int = 0
) -> float:
    """Return the time from the first z = 0.1 to the first z = 0.9.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    output : array_like [n]
        In the signal's unit, without measurement noise.
    start, target : float
        Setpoint before and after the step [signal unit].
    index : int
        The sample at which the setpoint steps.

    Returns
    -------
    float
        [s]; infinite where 90 % of the step is never reached or a value is not finite.

    Raises
    ------
    InputError
        The step has no size, the index no sample after it, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> rise_time([0.0, 1.0, 2.0], [0.0, 10.0, 10.0], start=0.0, target=10.0)
    0.8
    """
    elapsed, response, complete = _relative_response(time, output, start, target, index)
    if not complete:
        return float("inf")
    upper = first_crossing(elapsed, response, 0.9)
    if math.isinf(upper):
        return upper
    return upper - first_crossing(elapsed, response, 0.1)


def settling_time(
    time: ArrayLike,
    output: ArrayLike,
    start: float,
    target: float,
    index: int = 0,
    band: float = 0.05,
) -> float:
    """Return the time from the step until |z - 1| ≤ band for the rest of the record.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    output : array_like [n]
        In the signal's unit, without measurement noise.
    start, target : float
        Setpoint before and after the step [signal unit].
    index : int
        The sample at which the setpoint steps.
    band : float
        As a fraction of the step; 0.05 for 5 %, 0.02 for 2 %.

    Returns
    -------
    float
        [s]; infinite where the record ends outside the band or a value is not finite.

    Raises
    ------
    InputError
        The step has no size, the band is not positive, the index no sample after it, or
        lengths differ.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd edition, Wiley,
    2005, chapter 2.

    Examples
    --------
    >>> settling_time([0.0, 10.0, 20.0], [0.0, 1.0, 1.0], start=0.0, target=1.0)
    9.5
    """
    if not 0.0 < band < 1.0:
        raise InputError(
            "band", band, "a fraction of the step between 0 and 1", "use 0.05 for 5 % or 0.02"
        )
    elapsed, response, complete = _relative_response(time, output, start, target, index)
    if not complete:
        return float("inf")
    return last_entry(elapsed, response - 1.0, band)


def _relative_response(
    time: ArrayLike, output: ArrayLike, start: float, target: float, index: int
) -> tuple[FloatArray, FloatArray, bool]:
    """Return time since the step [s], z from the step on, and whether every z is finite."""
    size = target - start
    if not math.isfinite(size) or size == 0.0:
        raise InputError(
            "setpoint step",
            f"from {start} to {target}",
            "a step from one finite value to another",
            "score only samples at which the setpoint changes",
        )
    elapsed, signal, complete = from_sample(time, output, index)
    return elapsed, (signal - start) / size, complete
