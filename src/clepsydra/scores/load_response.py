"""Scores of the response to one load step: how far the output is driven off, and for how long."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import from_sample, last_entry


def peak_deviation(time: ArrayLike, output: ArrayLike, setpoint: float, index: int = 0) -> float:
    """Return the largest distance to the setpoint after a load step, max |r - y|.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    output : array_like [n]
        In the signal's unit, without measurement noise.
    setpoint : float
        Constant during the record [signal unit].
    index : int
        The sample at which the load steps.

    Returns
    -------
    float
        [signal unit]; infinite where a value is not finite.

    Raises
    ------
    InputError
        The index has no sample after it, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> peak_deviation([0.0, 1.0, 2.0], [5.0, 4.5, 5.25], setpoint=5.0)
    0.5
    """
    _, signal, complete = from_sample(time, output, index)
    if not complete:
        return float("inf")
    return float(np.max(np.abs(setpoint - signal)))


def return_time(
    time: ArrayLike, output: ArrayLike, setpoint: float, band: float, index: int = 0
) -> float:
    """Return the time from a load step until |r - y| ≤ band for the rest of the record.

    The band is given in the unit of the signal, not as a share of the peak: a controller is
    not judged by a narrower band because it let the output move less.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    output : array_like [n]
        In the signal's unit, without measurement noise.
    setpoint : float
        Constant during the record [signal unit].
    band : float
        [signal unit], above zero.
    index : int
        The sample at which the load steps.

    Returns
    -------
    float
        [s]; 0 where the output never leaves the band, infinite where the record ends outside
        it or a value is not finite.

    Raises
    ------
    InputError
        The band is not positive, the index has no sample after it, or lengths differ.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

    Examples
    --------
    >>> return_time([0.0, 10.0, 20.0], [5.0, 4.0, 5.0], setpoint=5.0, band=0.25)
    17.5
    """
    if not (math.isfinite(band) and band > 0.0):
        raise InputError(
            "band", band, "a width above zero in the signal's unit", "use 5 % of a setpoint step"
        )
    elapsed, signal, complete = from_sample(time, output, index)
    if not complete:
        return float("inf")
    return last_entry(elapsed, signal - setpoint, band)
