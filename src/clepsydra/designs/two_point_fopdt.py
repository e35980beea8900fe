"""A first-order model with delay from two points of a recorded step response."""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.designs.models.first_order_delay import FirstOrderDelay
from clepsydra.designs.models.step_record import StepRecord, step_record

PLACE = "two-point method"
Points = Literal["smith", "sundaresan_krishnaswamy"]
#: Shares of the whole change at which the two times are read.
SHARES: dict[Points, tuple[float, float]] = {
    # One third of a time constant, and one, after the delay.
    "smith": (1.0 - math.exp(-1.0 / 3.0), 1.0 - math.exp(-1.0)),
    "sundaresan_krishnaswamy": (0.353, 0.853),
}


def two_point_fopdt(
    time: ArrayLike, manipulated: ArrayLike, measured: ArrayLike, *, points: Points = "smith"
) -> FirstOrderDelay:
    """Return k e^(−θs)/(τs + 1) from the times at which a step response passes two shares.

    A first-order response with delay passes the share p at θ − τ ln(1 − p). From the times of
    two shares::

        τ = (t2 − t1)/(ln(1 − p1) − ln(1 − p2)),   θ = t2 + τ ln(1 − p2)

    Smith's shares are 28.3 % and 63.2 %: τ = 1.5 (t2 − t1), θ = t2 − τ. Those of Sundaresan and
    Krishnaswamy, 35.3 % and 85.3 %, suit responses of higher order: τ = 0.675 (t2 − t1),
    θ = 1.294 t1 − 0.294 t2.

    Parameters
    ----------
    time : array_like [n]
        Rising [s].
    manipulated, measured : array_like [n]
        Input, with one step in it, and output, which comes to rest before and after it. The
        delay is counted from the first sample with the new input.
    points : {"smith", "sundaresan_krishnaswamy"}

    Raises
    ------
    InputError
        The arrays cannot be used, there is no single step, the output does not come to rest, or
        it crosses no such points.

    References
    ----------
    C. L. Smith, Digital Computer Process Control, Intext, 1972; K. R. Sundaresan and P. R.
    Krishnaswamy, Estimation of time delay, time constant parameters in time, frequency, and
    Laplace domains, Canadian Journal of Chemical Engineering 56(2), 1978, 257-262,
    doi 10.1002/cjce.5450560215.

    Examples
    --------
    >>> time = np.arange(0.0, 200.0, 0.5)
    >>> after = np.maximum(time - 10.0 - 4.0, 0.0)
    >>> found = two_point_fopdt(time, 1.0 * (time >= 10.0), 2.0 * (1.0 - np.exp(-after / 8.0)))
    >>> round(found.gain, 6), round(found.time_constant, 2), round(found.delay, 2)
    (2.0, 8.0, 4.0)
    """
    check_choice(f"{PLACE}, points", points, get_args(Points))
    record = step_record(time, manipulated, measured, PLACE)
    gain = _gain(record)
    first, second = SHARES[points]
    start, end = _passes(record, first, gain), _passes(record, second, gain)
    span = math.log1p(-first) - math.log1p(-second)
    time_constant = (end - start) / span
    if not time_constant > 0.0:
        raise InputError(
            f"{PLACE}, measured",
            f"{first:.1%} and {second:.1%} at one time",
            "a response that takes more than a sample between the two",
            "record it faster",
        )
    delay = end + time_constant * math.log1p(-second)
    if delay < -0.5 * time_constant:
        raise InputError(
            f"{PLACE}, measured",
            f"a delay of {delay:.3g} s",
            "a response that begins after the step",
            "check that the record is of an undisturbed step",
        )
    return FirstOrderDelay(gain / time_constant, time_constant, max(delay, 0.0))


def _gain(record: StepRecord) -> float:
    """Return the static gain, of a response that has come to rest."""
    change = record.settled() - record.output_before
    noise = record.noise()
    if abs(change) <= 5.0 * noise or change == 0.0:
        raise InputError(
            f"{PLACE}, measured",
            f"a change of {change:.3g} in noise of {noise:.3g}",
            "a change above five times the noise",
            "make a larger step",
        )
    return change / record.step


def _passes(record: StepRecord, share: float, gain: float) -> float:
    """Return when the output first passes a share of its change, from the step on [s].

    Between two samples the response is taken as an exponential toward its end, so that the
    time is exact for a first-order response.
    """
    left = 1.0 - (record.output - record.output_before) / (gain * record.step)
    beyond = np.flatnonzero(left <= 1.0 - share)
    if not len(beyond) or beyond[0] == 0:
        raise InputError(
            f"{PLACE}, measured",
            f"{share:.1%} of the change at the first sample",
            "a response recorded from the step on",
            "begin the record before the step",
        )
    after = int(beyond[0])
    low, high = float(left[after - 1]), float(left[after])
    start, end = float(record.since[after - 1]), float(record.since[after])
    aim = 1.0 - share
    if 0.0 < high < low < 1.0:
        return start + (end - start) * math.log(low / aim) / math.log(low / high)
    return start + (end - start) * (low - aim) / (low - high)
