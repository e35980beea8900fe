"""Scores of the response to one setpoint step.

They look at the relative response z = (y - start) / (target - start), so that a
step down is judged exactly like a step up. Instants between samples are read from a straight line.

S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd edition, Wiley, 2005,
chapter 2; rise time as in K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

The functions take the start of each sample from the step on [s], the output without measurement
noise [n], and the setpoint before and after the step [signal unit]. They are infinite where a value
is not finite, and raise an `InputError` where the step has no size.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.scores.sample import Expression, Fold, Sample, larger
from clepsydra.scores.score import Score
from clepsydra.scores.trajectory import (
    FloatArray,
    each_finite_or_infinite,
    finite_or_infinite,
    first_crossings,
    last_entries,
)

#: Half the width of the band of settling and return, as a share of the setpoint step.
BAND = 0.05
#: The narrower band of the settling time.
NARROW_BAND = 0.02
#: Half the width of the band, in standard deviations of the noise, where the noise decides.
DEVIATIONS = 3.0
#: So many samples in a row on one side of the band are no noise: of white normal noise in a band
#: of three standard deviations, one in 4·10⁸.
IN_A_ROW = 3


def passed(sample: Sample) -> Expression:
    """Return how far the output stands beyond a setpoint that stepped [% of the step]."""
    return 100 * larger(0, larger(-sample.first * sample.per_step, -sample.last * sample.per_step))


def fallen_behind(sample: Sample) -> Expression:
    """Return how far the output stands before where a setpoint step began [% of the step].

    Examples
    --------
    A step from 4 to 5, at whose end the output stands at 3.8:

    >>> round(fallen_behind(Sample(setpoint=5.0, before=4.0, now=3.8, per_step=1.0)).item(), 9)
    20.0
    """
    # That is −z, and 1 − z the error in steps; of a signal without a step it is 0.
    return 100 * larger(
        0, larger(sample.first * sample.per_step, sample.last * sample.per_step) - 1
    )


OVERSHOOT = Score(
    "overshoot",
    "Overshoot",
    "How far the output passes its setpoint after a step of it, in the worst step; – where the "
    "controller follows no setpoint.",
    unit="% of the step",
    negligible=0.1,
    wants="own step",
    integrand=passed,
    fold=Fold.LARGEST,
).registered()
UNDERSHOOT = Score(
    "undershoot",
    "Undershoot",
    "How far the output first goes the wrong way after a step of its setpoint, as behind a zero in "
    "the right half-plane, in the worst step; – where the controller follows no setpoint.",
    unit="% of the step",
    negligible=0.1,
    wants="own step",
    integrand=fallen_behind,
    fold=Fold.LARGEST,
).registered()


def overshoot(time: ArrayLike, output: ArrayLike, start: float, target: float) -> float:
    """Return how far the output passes its target, 100 max(0, max z - 1).

    In % of the step; 0 where the output stays short of its target.

    Examples
    --------
    >>> overshoot([0.0, 1.0, 2.0], [4.0, 1.5, 2.0], start=4.0, target=2.0)
    25.0
    """
    return float(overshoots(time, [output], start, target)[0])


@each_finite_or_infinite
def overshoots(time: FloatArray, outputs: FloatArray, start: float, target: float) -> FloatArray:
    """Return the overshoot of each of several outputs side by side [outputs, n] [%].

    Examples
    --------
    >>> overshoots([0.0, 1.0], [[4.0, 1.5], [4.0, 3.0]], start=4.0, target=2.0).tolist()
    [25.0, 0.0]
    """
    if outputs.shape[-1] != time.size:
        raise InputError(
            "overshoot",
            f"{time.size} times and {outputs.shape[-1]} values",
            "a value at each time",
            "give outputs as long as the time",
        )
    inverse = 1.0 / _step_size(start, target)
    # How far an output has passed its target only grows with it.
    farthest = outputs.max(axis=-1) if inverse > 0.0 else outputs.min(axis=-1)
    there = Sample(before=farthest, now=farthest, setpoint=target, per_step=inverse)
    with np.errstate(over="ignore"):
        return np.asarray(passed(there))


def rise_time(time: ArrayLike, output: ArrayLike, start: float, target: float) -> float:
    """Return the time from the first z = 0.1 to the first z = 0.9.

    In s; infinite where 90 % of the step is never reached.

    Examples
    --------
    >>> rise_time([0.0, 1.0, 2.0], [0.0, 10.0, 10.0], start=0.0, target=10.0)
    0.8
    """
    return float(rise_times(time, [output], start, target)[0])


@each_finite_or_infinite
def rise_times(time: FloatArray, outputs: FloatArray, start: float, target: float) -> FloatArray:
    """Return the rise time of each of several outputs side by side [outputs, n] [s].

    Examples
    --------
    >>> rise_times([0.0, 1.0], [[0.0, 10.0], [0.0, 8.0]], start=0.0, target=10.0).tolist()
    [0.8, inf]
    """
    relative = (outputs - start) / _step_size(start, target)
    found = first_crossings(time, relative, 0.9)
    reached = np.isfinite(found)
    found[reached] -= first_crossings(time, relative[reached], 0.1)
    return found


def settling_time(
    time: ArrayLike, output: ArrayLike, start: float, target: float, band: float = BAND
) -> float:
    """Return the time from the step until \\|z - 1\\| ≤ band for the rest of the record.

    In s; infinite where the record ends outside the band, a fraction of the step.

    Examples
    --------
    >>> settling_time([0.0, 10.0, 20.0], [0.0, 1.0, 1.0], start=0.0, target=1.0)
    9.5
    """
    return float(settling_times(time, [output], start, target, band)[0])


@each_finite_or_infinite
def settling_times(
    time: FloatArray, outputs: FloatArray, start: float, target: float, band: float = BAND
) -> FloatArray:
    """Return the settling time of each of several outputs side by side [outputs, n] [s].

    Examples
    --------
    >>> settling_times([0.0, 10.0], [[0.0, 1.0], [0.0, 0.9]], start=0.0, target=1.0).tolist()
    [9.5, inf]
    """
    relative = (outputs - start) / _step_size(start, target)
    return last_entries(time - time[0], relative - 1.0, band)


@finite_or_infinite
def settling_time_under_noise(
    time: FloatArray,
    measurement: FloatArray,
    start: float,
    target: float,
    deviation: float,
    band: float = BAND,
) -> float:
    """Return when a noisy measurement has settled, as far as its noise lets one say so.

    The band around the target is the larger of `band` times the step and three standard
    deviations of the noise. A measurement has settled at the first sample after which it never
    again lies outside the band, on the same side, for three samples in a row. Single samples
    outside are noise.

    Without noise that is the settling time, up to the next sample, for every response that stays
    outside for three samples before it enters.

    In s; infinite where the last three samples lie outside on one side. The deviation of the noise
    is from 0 [signal unit]. The definition is ours; the band of three deviations and the run on one
    side are those of W. A. Shewhart's control charts (Western Electric, Statistical Quality Control
    Handbook, 1956).

    Examples
    --------
    One sample outside at 4 s does not count, since the next is inside again:

    >>> seen = [0.0, 0.3, 0.6, 0.99, 1.08, 1.0, 1.02]
    >>> settling_time_under_noise(range(7), seen, start=0.0, target=1.0, deviation=0.01)
    3.0
    """
    size = _step_size(start, target)
    half_width = max(band * abs(size), DEVIATIONS * deviation)
    away = measurement - target
    side = np.where(away > half_width, 1, np.where(away < -half_width, -1, 0))
    if side.size < IN_A_ROW:
        return math.inf if side[-1] else 0.0
    windows = np.lib.stride_tricks.sliding_window_view(side, IN_A_ROW)
    runs = np.flatnonzero(np.abs(windows.sum(axis=1)) == IN_A_ROW)
    if runs.size == 0:
        return 0.0
    after = int(runs[-1]) + IN_A_ROW
    return float(time[after] - time[0]) if after < time.size else math.inf


def _step_size(start: float, target: float) -> float:
    size = target - start
    if not math.isfinite(size) or size == 0.0:
        raise InputError(
            "setpoint step",
            f"from {start} to {target}",
            "a step from one finite value to another",
            "score only samples at which the setpoint changes",
        )
    return size


Score(
    "rise_time",
    "Rise time",
    "From 10 % to 90 % of a setpoint step, in the slowest step.",
    powers=(0, 1),
    wants="own step",
    over=lambda run, name: run.worst(rise_time, run.steps(name)),
).registered()
SETTLING_TIME = Score(
    "settling_time",
    "Settling time",
    "From a setpoint step until the output stays within 5 % of it, in the slowest step.",
    powers=(0, 1),
    wants="own step",
    over=lambda run, name: run.worst(settling_time, run.steps(name)),
).registered()
Score(
    "settling_time_2",
    "Settling time, 2 %",
    "From a setpoint step until the output stays within 2 % of it, in the slowest step.",
    powers=(0, 1),
    wants="own step",
    over=lambda run, name: run.worst(settling_time, run.steps(name), NARROW_BAND),
).registered()
Score(
    "settling_time_noisy",
    "Settling time, measured",
    "From a setpoint step until the measurement never again lies outside a band for three "
    "samples in a row on one side; the band is 5 % of the step, or three standard deviations "
    "of the noise if that is more.",
    powers=(0, 1),
    wants="own step",
    over=lambda run, name: run.worst(
        settling_time_under_noise, run.steps(name, measured=True), run.noise_deviation(name)
    ),
).registered()
