"""The generalised integral of the squared error, which also weighs how fast the error changes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.integral_errors import integral_squared_error
from clepsydra.scores.trajectory import read_trajectories

#: The weight a in the document that names the index [s²].
WEIGHT = 0.5


def generalised_squared_error(
    time: ArrayLike, setpoint: ArrayLike, output: ArrayLike, weight: float = WEIGHT
) -> float:
    """Return ISEG = ∫ (e² + a (de/dt)²) dt, with e = r - y and the derivative between samples.

    The first part is ISE. The second is a Σ (e_{k+1} - e_k)² / Δt_k, with the error at the
    samples, steps of the setpoint included. Such a step therefore costs a step²/Δt whatever the
    controller does, and ever more the shorter the samples are: compare the index only between
    runs of the same samples and steps.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.
    weight : float
        a [s²], not negative.

    Returns
    -------
    float
        [signal unit² × s]; infinite where a value is not finite.

    Raises
    ------
    InputError
        The weight is negative or no number, time does not increase, or lengths differ.

    References
    ----------
    M. Kolankowski and R. Piotrowski, Design of Three Control Algorithms for an Averaging Tank
    with Variable Filling, 2022, equation (79e), with a = 0.5.

    Examples
    --------
    An error that falls from 1 to 0 in 2 s: 2/3 and half of 1/2.

    >>> round(generalised_squared_error([0.0, 2.0], [1.0, 1.0], [0.0, 1.0]), 6)
    0.916667
    """
    if not (math.isfinite(weight) and weight >= 0.0):
        raise InputError("weight", weight, "a number [s²] from 0", "use 0.5, as the document does")
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    if not complete:
        return float("inf")
    with np.errstate(over="ignore"):  # a square beyond the largest number is rightly infinite
        changes = float(np.sum(np.diff(reference - actual) ** 2 / np.diff(clock)))
    return integral_squared_error(clock, reference, actual) + weight * changes
