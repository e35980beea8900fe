"""Scores of the response to one load step, and what is left of the error at the end of any.

K. J. Åström and T. Hägglund, Advanced PID Control, ISA, 2006, chapter 4.

The functions take the start of each sample from the step on [s], and setpoint and output without
measurement noise [signal unit], [n] each. They are infinite where a value is not finite.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.scores.iae import SIGNED_ERROR
from clepsydra.scores.sample import Fold, larger, magnitude
from clepsydra.scores.score import Score
from clepsydra.scores.step_response import BAND
from clepsydra.scores.trajectory import (
    FloatArray,
    each_finite_or_infinite,
    finite_or_infinite,
    last_entries,
)

#: Share of a response, at its end, over which its offset is averaged.
LAST_SHARE = 0.1


PEAK_DEVIATION = Score(
    "peak_deviation",
    "Peak deviation",
    "Largest distance to the setpoint after a load step, in the worst load step.",
    powers=(1, 0),
    wants="load",
    integrand=lambda sample: (
        sample.of_load * larger(magnitude(sample.first), magnitude(sample.last))
    ),
    fold=Fold.LARGEST,
).registered()


def return_time(time: ArrayLike, output: ArrayLike, setpoint: float, band: float) -> float:
    """Return the time from a load step until \\|r - y\\| ≤ band for the rest of the record.

    The band is given in the unit of the signal, not as a share of the peak: a controller is
    not judged by a narrower band because it let the output move less.

    In s; 0 where the output never leaves the band, infinite where the record ends outside it.

    Examples
    --------
    >>> return_time([0.0, 10.0, 20.0], [5.0, 4.0, 5.0], setpoint=5.0, band=0.25)
    17.5
    """
    return float(return_times(time, [output], setpoint, band)[0])


@each_finite_or_infinite
def return_times(time: FloatArray, outputs: FloatArray, setpoint: float, band: float) -> FloatArray:
    """Return the return time of each of several outputs side by side [outputs, n] [s].

    Examples
    --------
    >>> return_times([0.0, 10.0], [[4.0, 5.0], [4.9, 5.0]], setpoint=5.0, band=0.25).tolist()
    [7.5, 0.0]
    """
    return last_entries(time - time[0], outputs - setpoint, band)


@finite_or_infinite
def offset(time: FloatArray, setpoint: FloatArray, output: FloatArray) -> float:
    """Return the mean error over the last tenth of a response, with its sign.

    Examples
    --------
    A proportional controller leaves a tenth of the step:

    >>> time = [0.0, 9.0, 10.0]
    >>> round(offset(time, [1.0, 1.0, 1.0], [0.0, 0.9, 0.9]), 6)
    0.1
    """
    begin = time[-1] - LAST_SHARE * (time[-1] - time[0])
    # At least one sample; an instant that is a sample but for rounding counts as that sample.
    tolerance = 1e-6 * float(np.min(np.diff(time)))
    first = min(int(np.searchsorted(time, begin - tolerance)), time.size - 2)
    last = slice(first, None)
    total = SIGNED_ERROR.along(time[last], setpoint[last], output[last])
    return total / float(time[-1] - time[first])


def _return(time: FloatArray, output: FloatArray, setpoint: float, band: float) -> float:
    """Return the return time within a band [signal unit], or within 5 % of the peak if it is 0."""
    peak = float(np.max(np.abs(setpoint - output)))
    if peak == 0.0 or not math.isfinite(peak):
        return peak if peak == 0.0 else math.inf
    return return_time(time, output, setpoint, band or BAND * peak)


Score(
    "return_time",
    "Return time",
    "From a load step until the output stays near its setpoint, in the slowest case; near is "
    "5 % of the setpoint step, or of the peak deviation where there is none.",
    powers=(0, 1),
    over=lambda run, name: run.worst(
        _return, run.load_responses(name), BAND * run.largest_step(name)
    ),
).registered()
Score(
    "offset",
    "Offset",
    "Mean error over the last tenth of a step's segment, without its sign, in the worst one.",
    powers=(1, 0),
    over=lambda run, name: run.worst(lambda *response: abs(offset(*response)), run.responses(name)),
).registered()
