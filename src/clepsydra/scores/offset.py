"""What is left of the error at the end of a response."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.scores.integral_errors import integral_error
from clepsydra.scores.trajectory import read_trajectories

#: Share of the response, at its end, over which the error is averaged.
LAST_SHARE = 0.1


def offset(time: ArrayLike, setpoint: ArrayLike, output: ArrayLike) -> float:
    """Return the mean error over the last tenth of a response, with its sign.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample, from the step to the end of its response [s].
    setpoint, output : array_like [n]
        In the signal's unit; the output without measurement noise.

    Returns
    -------
    float
        r - y [signal unit]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    Examples
    --------
    A proportional controller leaves a tenth of the step:

    >>> time = [0.0, 9.0, 10.0]
    >>> round(offset(time, [1.0, 1.0, 1.0], [0.0, 0.9, 0.9]), 6)
    0.1
    """
    clock, (reference, actual), complete = read_trajectories(time, setpoint, output)
    if not complete:
        return float("inf")
    begin = clock[-1] - LAST_SHARE * (clock[-1] - clock[0])
    # At least one sample; an instant that is a sample but for rounding counts as that sample.
    tolerance = 1e-6 * float(np.min(np.diff(clock)))
    first = min(int(np.searchsorted(clock, begin - tolerance)), clock.size - 2)
    last = slice(first, None)
    return integral_error(clock[last], reference[last], actual[last]) / float(
        clock[-1] - clock[first]
    )
