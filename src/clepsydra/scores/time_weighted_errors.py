"""Integrals of the control error weighted by time: an error that stays costs more and more.

Time counts from the last step, not from the start of the run: in a run of several steps every
step is judged alike. Between samples the error runs on a straight line, as in
`clepsydra.scores.integral_errors`, and both integrals are exact for such errors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import FloatArray, read_trajectories, sample_errors


def integral_time_absolute_error(
    time: ArrayLike, setpoint: ArrayLike, output: ArrayLike, steps: ArrayLike = ()
) -> float:
    """Return ITAE = ∫ (t - t_step) |r - y| dt, with t_step the last step before t.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.
    steps : array_like
        When setpoints or loads step [s]; before the first of them, time counts from the start.

    Returns
    -------
    float
        [signal unit × s²]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, lengths differ, or a step is no finite time.

    References
    ----------
    D. Graham and R. C. Lathrop, The synthesis of optimum transient response: criteria and
    standard forms, Transactions of the AIEE, part II, 72(5), 1953, pages 273–288.

    Examples
    --------
    A constant error of 1 costs 2² / 2 in two seconds, and as much again after a step:

    >>> ones, zeros = [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]
    >>> integral_time_absolute_error([0.0, 2.0, 4.0], ones, zeros, steps=[2.0])
    4.0
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    elapsed = _since_last_step(clock, steps)
    if not complete:
        return float("inf")
    period, a, b = sample_errors(clock, reference, actual)
    first, last = np.abs(a), np.abs(b)
    crossing = np.sign(a) * np.sign(b) < 0.0
    span = np.where(crossing, first + last, 1.0)
    # Where the sign changes after a time c, the error makes two triangles; else c = 0, and the
    # second triangle with the first error as an edge more is the whole trapezium.
    until = np.where(crossing, period * (first / span), 0.0)
    rest, edge = period - until, np.where(crossing, 0.0, first)
    before = elapsed * until * first / 2.0 + until**2 * first / 6.0
    after = (elapsed + until) * rest * (edge + last) / 2.0 + rest**2 * (edge + 2.0 * last) / 6.0
    return float(np.sum(before + after))


def integral_time_squared_error(
    time: ArrayLike, setpoint: ArrayLike, output: ArrayLike, steps: ArrayLike = ()
) -> float:
    """Return ITSE = ∫ (t - t_step) (r - y)² dt, with t_step the last step before t.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.
    steps : array_like
        When setpoints or loads step [s]; before the first of them, time counts from the start.

    Returns
    -------
    float
        [signal unit² × s²]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, lengths differ, or a step is no finite time.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> integral_time_squared_error([0.0, 2.0], [3.0, 3.0], [0.0, 0.0])
    18.0
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    elapsed = _since_last_step(clock, steps)
    if not complete:
        return float("inf")
    period, a, b = sample_errors(clock, reference, actual)
    with np.errstate(over="ignore"):  # a square beyond the largest number is rightly infinite
        constant = elapsed * period * (a**2 + a * b + b**2) / 3.0
        rising = period**2 * (a**2 + 2.0 * a * b + 3.0 * b**2) / 12.0
        return float(np.sum(constant + rising))


def _since_last_step(time: FloatArray, steps: ArrayLike) -> FloatArray:
    """Return the time since the last step at the start of each sample but the last [n - 1]."""
    instants = np.sort(np.asarray(steps, dtype=np.float64).ravel())
    if not np.all(np.isfinite(instants)):
        raise InputError("steps", list(instants), "finite times [s]", "correct the steps")
    # The step of a sample may have been rounded to just after its start.
    tolerance = 1e-6 * float(np.min(np.diff(time)))
    begins = np.concatenate([[time[0]], instants[instants > time[0]]])
    last = np.searchsorted(begins, time[:-1] + tolerance, side="right") - 1
    return np.maximum(time[:-1] - begins[last], 0.0)
