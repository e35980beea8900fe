"""A sample of a running loop as an integrand sees it, and how its values make a score.

A sample lasts from one instant at which a controller acts to the next. The setpoint is held
during it, r(t) = r_k on [t_k, t_{k+1}), and the output moves on a straight line from y_k to
y_{k+1}: the error runs from a = r_k - y_k to b = r_k - y_{k+1}. Integrals that are exact for such
errors cost no half sample at a step of the setpoint, unlike the trapezoidal rule over e_k.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.scores.trajectory import FloatArray

#: An expression of CasADi while a program is written, an array along a stored trajectory: what is
#: written with operators, `magnitude`, `where` and `larger` is the same for both.
Expression = Any
#: Beyond every value, so that the first one is the largest and the smallest so far.
BEYOND = 1e300


@dataclass(frozen=True)
class Held:
    """What keeps its value during each sample, a flow say.

    Parameters
    ----------
    before, now : Expression
        In the sample that ends, and in that which begins.
    base : Expression
        Just before the load that acts now; of no meaning where none does.
    """

    before: Expression = 0.0
    now: Expression = 0.0
    base: Expression = 0.0


@dataclass(frozen=True)
class Sample:
    """The sample that ends now, of one signal.

    The first instant of a run ends none: there length and moves are zero.

    Parameters
    ----------
    period : Expression
        From instant to instant [s], above zero.
    length : Expression
        Of the sample [s]: its period, 0 at the first instant.
    held : Expression
        How long the sample that begins now will last [s].
    elapsed : Expression
        From the start of its segment, or of the run, to that of the sample [s].
    of_setpoint, of_load, of_step : Expression
        1 within the segments of setpoint steps, of load steps, and of both; else 0. Where nothing
        steps, all samples are of a step.
    of_noise : Expression
        1 within the segments of noise, from the first move in one on; else 0.
    begins : Expression
        1 in the first sample of a step's segment, else 0.
    load : Expression
        1 where a load acts in the sample that begins now, else 0.
    before, now : Expression
        The signal at its start and its end [signal unit], without measurement noise.
    setpoint, next_setpoint : Expression
        Of a controlled measurement: held during the sample, and from now on [signal unit].
    per_step : Expression
        1 over the size of the signal's own setpoint step, 0 where none is judged [1/signal unit].
    band : tuple of float
        Of an averaging measurement with a band: its lower and upper end [signal unit].
    inflow, outflow : Held
        Of the tank of an averaging measurement [m³/s].
    running : Held
        Of a pump: 1 where it runs, else 0.
    lift : Expression
        Of a pump whose head is known: what it gives to the liquid [J/kg].
    """

    period: Expression = 1.0
    length: Expression = 1.0
    held: Expression = 1.0
    elapsed: Expression = 0.0
    of_setpoint: Expression = 1.0
    of_load: Expression = 1.0
    of_step: Expression = 1.0
    of_noise: Expression = 1.0
    begins: Expression = 0.0
    load: Expression = 0.0
    before: Expression = 0.0
    now: Expression = 0.0
    setpoint: Expression = 0.0
    next_setpoint: Expression = 0.0
    per_step: Expression = 0.0
    band: tuple[float, float] = (-BEYOND, BEYOND)
    inflow: Held = Held()
    outflow: Held = Held()
    running: Held = Held()
    lift: Expression = 0.0

    @property
    def first(self) -> Expression:
        """The error at its start, a."""
        return self.setpoint - self.before

    @property
    def last(self) -> Expression:
        """The error at its end, b, still to the setpoint of the sample."""
        return self.setpoint - self.now

    @property
    def error(self) -> Expression:
        """The error now, after the setpoint stepped."""
        return self.next_setpoint - self.now

    @property
    def move(self) -> Expression:
        """From its start to its end."""
        return self.now - self.before


class Fold(Enum):
    """How the values of the samples make a score.

    Examples
    --------
    >>> [fold.over(np.array([1.0, -3.0]), Sample()) for fold in (Fold.SUM, Fold.LARGEST)]
    [-2.0, 1.0]
    """

    INTEGRAL = "each value over the length of its sample, added up"
    SEGMENTS = "as the integral, of each step's segment; their magnitudes added up"
    SUM = "added up"
    LARGEST = "the largest"
    SMALLEST = "the smallest"

    @property
    def start(self) -> tuple[float, ...]:
        """Its states before the first sample; the first of them is the score so far."""
        extreme = {Fold.LARGEST: (-BEYOND,), Fold.SMALLEST: (BEYOND,), Fold.SEGMENTS: (0.0, 0.0)}
        return extreme.get(self, (0.0,))

    def following(
        self, state: tuple[Expression, ...], value: Expression, sample: Sample
    ) -> tuple[Expression, ...]:
        """Return the states after a sample with this value."""
        if self is Fold.LARGEST:
            return (ca.fmax(state[0], value),)
        if self is Fold.SMALLEST:
            return (ca.fmin(state[0], value),)
        if self is Fold.SUM:
            return (state[0] + value,)
        share = sample.length * value
        if self is Fold.INTEGRAL:
            return (state[0] + share,)
        # What was before the segment is done with; the magnitude of what is within may shrink.
        total, within = state
        now = ca.if_else(sample.begins, 0, within) + share
        done = total - ca.if_else(sample.begins, 0, magnitude(within))
        return done + magnitude(now), now

    def joined(self, parts: FloatArray) -> FloatArray:
        """Return what several parts of a run came to together [parts, …].

        Examples
        --------
        >>> Fold.LARGEST.joined(np.array([2.0, 5.0, 3.0])).item()
        5.0
        """
        if self in (Fold.LARGEST, Fold.SMALLEST):
            return np.asarray((np.max if self is Fold.LARGEST else np.min)(parts, axis=0))
        total = parts[0]
        for part in parts[1:]:  # one after the other, for whatever number of runs
            total = total + part
        return total

    def over(self, values: FloatArray, sample: Sample) -> float:
        """Return the score of the values of all samples of a run."""
        if self in (Fold.LARGEST, Fold.SMALLEST):
            return float(np.max(values) if self is Fold.LARGEST else np.min(values))
        if self is not Fold.SUM:
            values = values * sample.length
        if self is not Fold.SEGMENTS:
            # The zero of an instant that ends no sample would only change how a sum is rounded.
            return float(np.sum(values[int(values[0] == 0.0) :]))
        starts = np.union1d([0], np.flatnonzero(sample.begins))
        return float(np.sum(np.abs(np.add.reduceat(values, starts))))


def where(condition: Expression, value: Expression, other: Expression) -> Expression:
    """Return a value where a condition holds, and the other elsewhere."""
    choose = ca.if_else if isinstance(condition, ca.SX) else np.where
    return choose(condition, value, other)


def magnitude(value: Expression) -> Expression:
    """Return |value|; not every CasADi has it as Python's `abs`."""
    return value.fabs() if isinstance(value, ca.SX) else abs(value)


def larger(one: Expression, other: Expression) -> Expression:
    """Return the larger of two values."""
    return where(one > other, one, other)
