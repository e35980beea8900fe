"""Settling of a response that is only known with noise."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.trajectory import from_sample

#: Half the width of the band, in standard deviations of the noise, where the noise decides.
DEVIATIONS = 3.0
#: So many samples in a row on one side of the band are no noise: of white normal noise in a band
#: of three standard deviations, one in 4·10⁸.
IN_A_ROW = 3


def settling_time_under_noise(
    time: ArrayLike,
    measurement: ArrayLike,
    start: float,
    target: float,
    deviation: float,
    index: int = 0,
    band: float = 0.05,
) -> float:
    """Return when a noisy measurement has settled, as far as its noise lets one say so.

    The band around the target is the larger of `band` times the step and three standard
    deviations of the noise. A measurement has settled at the first sample after which it never
    again lies outside the band, on the same side, for three samples in a row. Single samples
    outside are noise.

    Without noise that is the settling time of `clepsydra.scores.step_response`, up to the next
    sample, for every response that stays outside for three samples before it enters.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    measurement : array_like [n]
        With its noise, in the signal's unit.
    start, target : float
        Setpoint before and after the step [signal unit].
    deviation : float
        Standard deviation of the noise [signal unit].
    index : int
        The sample at which the setpoint steps.
    band : float
        As a fraction of the step.

    Returns
    -------
    float
        [s]; infinite where the last three samples lie outside on one side, or a value is not
        finite.

    Raises
    ------
    InputError
        The step has no size, the band or the deviation is no number that fits, the index has no
        sample after it, or lengths differ.

    References
    ----------
    The definition is ours; the band of three deviations and the run on one side are those of
    W. A. Shewhart's control charts (Western Electric, Statistical Quality Control Handbook,
    1956).

    Examples
    --------
    One sample outside at 4 s does not count, since the next is inside again:

    >>> seen = [0.0, 0.3, 0.6, 0.99, 1.08, 1.0, 1.02]
    >>> settling_time_under_noise(range(7), seen, start=0.0, target=1.0, deviation=0.01)
    3.0
    """
    size = target - start
    if not (math.isfinite(size) and size != 0.0):
        raise InputError(
            "setpoint step", f"from {start} to {target}", "a step from one finite value to another",
            "score only samples at which the setpoint changes",
        )  # fmt: skip
    if not 0.0 < band < 1.0:
        raise InputError(
            "band", band, "a fraction of the step between 0 and 1", "use 0.05 for 5 % or 0.02"
        )
    if not (math.isfinite(deviation) and deviation >= 0.0):
        raise InputError(
            "deviation", deviation, "a standard deviation from 0", "use 0 for no noise"
        )
    elapsed, signal, complete = from_sample(time, measurement, index)
    if not complete:
        return float("inf")
    half_width = max(band * abs(size), DEVIATIONS * deviation)
    away = signal - target
    side = np.where(away > half_width, 1, np.where(away < -half_width, -1, 0))
    if side.size < IN_A_ROW:
        return float("inf") if side[-1] else 0.0
    windows = np.lib.stride_tricks.sliding_window_view(side, IN_A_ROW)
    runs = np.flatnonzero(np.abs(windows.sum(axis=1)) == IN_A_ROW)
    if runs.size == 0:
        return 0.0
    after = int(runs[-1]) + IN_A_ROW
    return float(elapsed[after]) if after < elapsed.size else float("inf")
