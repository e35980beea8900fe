"""Slope and delay of an integrating element from a recorded step or pulse of its input."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.designs.models.first_order_delay import FirstOrderDelay
from clepsydra.designs.models.step_record import checked_record

PLACE = "integrating plus delay"
_GRID = 400
_SECTIONS = 80
#: What the model must explain of the output's motion.
_EXPLAINED = 0.9


def integrating_delay(
    time: ArrayLike, manipulated: ArrayLike, measured: ArrayLike
) -> FirstOrderDelay:
    """Return k'/s e^(−θs) from the record of a level that integrates what the input does.

    With the input's deviation from its value before the first change, Δu, held between samples,
    the output is y(t) = y0 + r t + k' ∫ Δu(s − θ) ds. For each delay the level y0, a drift r
    and the slope k' are the least squares of the whole record; the delay with the smallest
    residual is found on a grid and refined by golden section. It serves a step as well as a
    pulse, or several; the drift, of an inflow that did not quite balance, shows in what the
    output does before the first change.

    Parameters
    ----------
    time : array_like [n]
        Rising [s].
    manipulated, measured : array_like [n]
        The input, held from each sample to the next, and the output.

    Returns
    -------
    FirstOrderDelay
        With an infinite time constant.

    Raises
    ------
    InputError
        The arrays cannot be used, the input does not move, there are fewer than three samples
        before its first change, or less than 90 % of the output's motion is explained.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 2, for the model.

    Examples
    --------
    A pulse of 2 V for 20 s lifts a level by 0.4: k' = 0.01, after a delay of 5 s.

    >>> time = np.arange(0.0, 100.0)
    >>> pulse = 2.0 * ((time >= 10.0) & (time < 30.0))
    >>> level = 1.0 + 0.02 * np.clip(time - 15.0, 0.0, 20.0)
    >>> found = integrating_delay(time, pulse, level)
    >>> round(found.slope, 6), round(found.delay, 4)
    (0.01, 5.0)
    """
    time, manipulated, measured = checked_record(time, manipulated, measured, PLACE)
    changes = np.flatnonzero(np.diff(manipulated) != 0.0)
    if not len(changes):
        raise InputError(
            f"{PLACE}, manipulated", "no change", "a step or a pulse", "move the input"
        )
    if changes[0] < 2:
        raise InputError(
            f"{PLACE}, manipulated",
            f"{changes[0] + 1} samples before its first change",
            "at least three, which show where the level stood and drifted",
            "begin the record earlier",
        )
    deviation = manipulated - manipulated[0]
    # The integral of the deviation is linear between samples, so interpolation is exact.
    volume = np.concatenate([[0.0], np.cumsum(deviation[:-1] * np.diff(time))])

    def fitted(delay: float) -> tuple[float, np.ndarray]:
        """Return the sum of squares left, and y0, r and k'."""
        moved = np.interp(time - delay, time, volume, left=0.0)
        columns = np.column_stack([np.ones_like(time), time - time[0], moved])
        scale = np.max(np.abs(columns), axis=0)
        scale[scale == 0.0] = 1.0
        found = np.linalg.lstsq(columns / scale, measured, rcond=None)[0] / scale
        return float(np.sum((measured - columns @ found) ** 2)), found

    # A delay that leaves less than a tenth of the record after the first change shows nothing.
    longest = 0.9 * (time[-1] - time[changes[0] + 1])
    grid = np.linspace(0.0, longest, _GRID)
    best = int(np.argmin([fitted(delay)[0] for delay in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, _GRID - 1)]
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(_SECTIONS):
        left, right = high - share * (high - low), low + share * (high - low)
        if fitted(left)[0] <= fitted(right)[0]:
            high = right
        else:
            low = left
    delay = float(low) if low == 0.0 and fitted(0.0)[0] <= fitted(high)[0] else float(high)
    rest, (_, _, slope) = fitted(delay)
    motion = float(np.sum((measured - np.mean(measured)) ** 2))
    if slope == 0.0 or rest > (1.0 - _EXPLAINED) * motion:
        share_left = rest / motion if motion else 1.0
        raise InputError(
            f"{PLACE}, measured",
            f"{share_left:.0%} of its motion unexplained",
            f"a level that integrates the input, with at most {1.0 - _EXPLAINED:.0%} left",
            "make a larger pulse while the inflow is steady, or take the two-point method",
        )
    return FirstOrderDelay(float(slope), math.inf, delay)
