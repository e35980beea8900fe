"""What a controller moves: how far, how often it turns, and how long it stands at a limit.

Travel and reversals count what a real actuator would do. Moves below its resolution do not reach
the stem of a valve or the speed of a drive, so that rounding and small noise wear nothing; total
variation counts every move.

The functions take the start of each sample [s], the manipulated variable [n], held during each
sample, and its range [signal unit]. They are infinite where a value is not finite.
"""

from __future__ import annotations

import math

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.scores.sample import Expression, Fold, Sample, magnitude
from clepsydra.scores.score import Of, Ranks, Score
from clepsydra.scores.trajectory import FloatArray, finite_or_infinite, held_durations

#: Resolution of a good positioner, as a share of the range; EnTech, Control Valve Dynamic
#: Specification, version 3.0, 1998.
RESOLUTION = 1e-3
#: A value within this share of the range of a limit stands at the limit; covers rounding only.
AT_LIMIT = 1e-9
_HOUR = 3600.0


def noisy_moves(sample: Sample) -> tuple[Expression, ...]:
    """Return the square of a move that nothing but noise makes, and 1 to count it; else 0, 0."""
    return sample.of_noise * sample.move * sample.move, sample.of_noise * 1.0


def deviation_of_moves(squares: FloatArray, count: FloatArray) -> FloatArray:
    """Return how far measurement noise throws the manipulated variable about.

    The root mean square of its moves from sample to sample over √2: for a controller of gain K
    and white noise of standard deviation σ that is K σ, whatever drifts slowly below. Not a number
    without a stretch in which nothing happens but noise [signal unit].

    References
    ----------
    J. von Neumann, Distribution of the ratio of the mean square successive difference to the
    variance, Annals of Mathematical Statistics 12(4), 1941, 367-395,
    doi 10.1214/aoms/1177731677.

    Examples
    --------
    Moves of 2 and of −2:

    >>> deviation_of_moves(8.0, 2.0) == 2.0**0.5
    np.True_
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.sqrt(np.divide(squares, count) / 2.0)


@finite_or_infinite
def travel(time: FloatArray, signal: FloatArray, low: float, high: float) -> float:
    """Return the way of an actuator of finite resolution, in per cent of its range per hour.

    The actuator stays where it is until the signal is further away than 0.1 % of the range, and
    then goes to the signal.

    Examples
    --------
    Up by half the range, and back, in an hour; moves of 0.05 % do not count:

    >>> travel([0.0, 1200.0, 2400.0], [0.0, 5.0, 0.0], low=0.0, high=10.0)
    100.0
    >>> travel([0.0, 1200.0, 2400.0], [0.0, 0.005, 0.0], low=0.0, high=10.0)
    0.0
    """
    span = high - low
    position, way, least = float(signal[0]), 0.0, RESOLUTION * span
    for value in _moved(signal):
        step = abs(value - position)
        if step > least:
            way += step
            position = value
    return 100.0 * way / span / (float(np.sum(held_durations(time))) / _HOUR)


@finite_or_infinite
def reversals(time: FloatArray, signal: FloatArray, low: float, high: float) -> float:
    """Return how often the manipulated variable turns by more than 0.1 % of its range.

    A turn counts once the signal has come back from its last highest or lowest value by more
    than that dead band.

    Examples
    --------
    Down, up and down again by more than the dead band: two turns.

    >>> reversals(range(5), [5.0, 4.0, 4.001, 6.0, 5.5], low=0.0, high=10.0)
    2.0
    """
    return float(turns(signal, RESOLUTION * (high - low)))


def turns(signal: FloatArray, band: float) -> int:
    """Return how often a signal turns and comes back by more than a dead band [signal unit].

    Examples
    --------
    >>> turns(np.array([0.0, 4.0, 3.0, 5.0, 2.0]), 1.5)
    1
    """
    rises = np.sign(np.diff(signal))
    places = np.flatnonzero(rises)
    # Only where it turns, by however little, is it higher or lower than it was.
    turning = np.append(rises[places[1:]] != rises[places[:-1]], True)[: places.size]
    highest = lowest = float(signal[0])
    direction, count = 0, 0
    for value in signal[places[turning] + 1].tolist():
        highest, lowest = max(highest, value), min(lowest, value)
        if direction >= 0 and highest - value > band:
            count += direction > 0
            direction, lowest = -1, value
        elif direction <= 0 and value - lowest > band:
            count += direction < 0
            direction, highest = 1, value
    return count


@finite_or_infinite
def peak_move(time: FloatArray, signal: FloatArray) -> float:
    """Return how far the manipulated variable goes from where it began, max \\|u_k - u_0\\|.

    Examples
    --------
    >>> peak_move([0.0, 1.0, 2.0], [3.0, 5.0, -1.0])
    4.0
    """
    return float(np.max(np.abs(signal - signal[0])))


@finite_or_infinite
def time_in_saturation(time: FloatArray, signal: FloatArray, low: float, high: float) -> float:
    """Return how long the manipulated variable stood at one of its limits [s].

    The value of sample k holds from t_k to t_{k+1}; the last sample is as long as the one
    before it.

    Limits may be infinite, but must be in order.

    Examples
    --------
    >>> time_in_saturation([0.0, 1.0, 2.0, 3.0], [0.0, 4.0, 10.0, 10.0], low=0.0, high=10.0)
    3.0
    """
    if not low < high:
        raise InputError(
            "limits", f"{low} and {high}", "a low limit below the high limit", "swap or widen them"
        )
    return float(np.sum(held_durations(time)[at_limit(signal, low, high)]))


def at_limit(held: np.ndarray, low: float, high: float) -> np.ndarray:
    """Tell of each sample whether a manipulated variable [n] stands at one of its limits.

    Both are in the unit of the signal; a limit that there is not is infinite.
    """
    tolerance = AT_LIMIT * (high - low) if math.isfinite(high - low) else 0.0
    return np.asarray((held <= low + tolerance) | (held >= high - tolerance))


def _moved(held: FloatArray) -> list[float]:
    """Return the values at which the signal has moved: the others change nothing."""
    found: list[float] = held[np.diff(held, prepend=held[0]) != 0.0].tolist()
    return found


#: A total variation below this share of an input's range counts as this much: the input is idle,
#: and a multiple of next to nothing says nothing.
IDLE = 0.1
TOTAL_VARIATION = Score(
    "total_variation",
    "Total variation",
    "Sum of all moves of the manipulated variable: wear of the actuator.",
    Of.MANIPULATED,
    powers=(1, 0),
    ranks=Ranks.MOVEMENT,
    negligible=IDLE,
    integrand=lambda sample: magnitude(sample.move),
    fold=Fold.SUM,
).registered()
NOISE_MOVEMENT = Score(
    "noise_movement",
    "Noise movement",
    "Standard deviation with which measurement noise alone throws the manipulated variable "
    "about, from its moves from sample to sample.",
    Of.MANIPULATED,
    powers=(1, 0),
    wants="noise",
    integrand=noisy_moves,
    fold=Fold.SUM,
    finish=deviation_of_moves,
).registered()
Score(
    "travel",
    "Travel",
    "Way of an actuator that follows the manipulated variable only where it differs by more "
    "than 0.1 % of the range.",
    Of.MANIPULATED,
    unit="% of range per h",
    negligible=0.1,
    over=lambda run, name: run.of_range(travel, name),
).registered()
Score(
    "reversals",
    "Reversals",
    "How often the manipulated variable turns and comes back by more than 0.1 % of the range.",
    Of.MANIPULATED,
    unit="1",
    over=lambda run, name: run.of_range(reversals, name),
).registered()
Score(
    "peak_move",
    "Largest move",
    "Largest distance of the manipulated variable from where it began.",
    Of.MANIPULATED,
    powers=(1, 0),
    over=lambda run, name: peak_move(run.time, run.inputs[name]),
).registered()
Score(
    "time_in_saturation",
    "Time in saturation",
    "How long the manipulated variable stood at a limit, its own or a narrower one of the "
    "controller.",
    Of.MANIPULATED,
    powers=(0, 1),
    over=lambda run, name: time_in_saturation(run.time, run.inputs[name], *run.limits(name)),
).registered()
Score(
    "time_at_setpoint_limit",
    "Time at a setpoint limit",
    "How long the setpoint that a cascade gives to an inner loop stood at one of its limits, "
    "where the outer loop moves nothing.",
    Of.INNER_LOOP,
    powers=(0, 1),
    over=lambda run, name: time_in_saturation(run.time, *run.inner[name]),
).registered()
