"""Integrals of the control error: what a run cost, whenever the error was.

The setpoint is held during a sample, r(t) = r_k on [t_k, t_{k+1}), and the output moves on a
straight line from y_k to y_{k+1}. The error of a sample thus runs from a = r_k - y_k to
b = r_k - y_{k+1}, and the integrals below are exact for such trajectories: a step of the
setpoint costs no half sample, unlike in the trapezoidal rule over e_k.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.scores.trajectory import read_trajectories, sample_errors


def integral_error(time: ArrayLike, setpoint: ArrayLike, output: ArrayLike) -> float:
    """Return the integral of the error with its sign, IE = ∫ (r - y) dt.

    Errors of both signs cancel, so that IE says little of a response that oscillates. Under a
    PI controller that ends at rest it is T_i/K times the change of the manipulated variable.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.

    Returns
    -------
    float
        [signal unit × s]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> integral_error([0.0, 2.0, 6.0], [1.0, 1.0, 1.0], [0.0, 2.0, 2.0])
    -4.0
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    if not complete:
        return float("inf")
    period, first, last = sample_errors(clock, reference, actual)
    return float(np.sum(period * (first + last) / 2.0))


def integral_absolute_error(time: ArrayLike, setpoint: ArrayLike, output: ArrayLike) -> float:
    """Return the integral of the absolute error, IAE = ∫ |r - y| dt.

    Over one sample of length Δ the integral is Δ (|a| + |b|)/2 where the error keeps its
    sign, and Δ (a² + b²) / (2 (|a| + |b|)) where it changes it.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.

    Returns
    -------
    float
        [signal unit × s]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> integral_absolute_error([0.0, 2.0, 4.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0])
    1.0
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    if not complete:
        return float("inf")
    period, first, last = sample_errors(clock, reference, actual)
    span = np.abs(first) + np.abs(last)
    crossing = np.sign(first) * np.sign(last) < 0.0
    mean = span / 2.0
    # (a² + b²)/(2 span) = span/2 - |a| |b|/span, which neither overflows nor underflows.
    mean[crossing] -= np.abs(first[crossing]) * (np.abs(last[crossing]) / span[crossing])
    return float(np.sum(period * mean))


def integral_squared_error(time: ArrayLike, setpoint: ArrayLike, output: ArrayLike) -> float:
    """Return the integral of the squared error, ISE = ∫ (r - y)² dt.

    Over one sample of length Δ the integral is Δ (a² + a b + b²)/3.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.

    Returns
    -------
    float
        [signal unit² × s]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> integral_squared_error([0.0, 3.0, 6.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0])
    1.0
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    if not complete:
        return float("inf")
    period, first, last = sample_errors(clock, reference, actual)
    with np.errstate(over="ignore"):  # a square beyond the largest number is rightly infinite
        return float(np.sum(period * (first**2 + first * last + last**2) / 3.0))
