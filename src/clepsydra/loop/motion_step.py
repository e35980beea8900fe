"""One integration step of a process, with what comes out of its delays."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import accumulate

import casadi as ca

from clepsydra.process.motion import Motion
from clepsydra.program.counted_loop import counted_loop

#: Halvings of the bracket around an event, in turn with secant steps: 2⁻¹⁰ of a step at worst.
_HALVINGS = 10
#: Events that one step can hold; what comes later switches at the end of the step.
_MOST_EVENTS = 4


class MotionStep:
    """The functions of one integration step of length h, over fractions of it.

    The integral is the vector of contents, some totals, and the sums of what entered the delays
    during the step. It is carried from a fraction s₀ to s₁ by the classical Runge-Kutta method.
    During a step a delayed quantity is the parabola through its values at start and end with
    its mean, and the mean of a flow is its own integral over the step at which it entered: so a
    delay loses no liquid, and what comes out is right to h⁴, which keeps the method's order.

    Parameters
    ----------
    motion : Motion
    totals : sequence of str
        Those totals that are integrated.
    """

    def __init__(self, motion: Motion, totals: Sequence[str] = ()) -> None:
        self.motion = motion
        self.contents = len(motion.contents)
        self.totals = [i for i, s in enumerate(motion.totals) if s.name in totals]
        self.size = self.contents + len(self.totals) + len(motion.delays)
        self.held = [
            ca.SX.sym(name, motion.rates.numel_in(index)) for index, name in enumerate("mudp", 2)
        ]
        events = len(motion.events)
        #: Sizes of what an event changes: integral, counts, dates, memories.
        self.located = self.size, events, events, self.held[0].numel()
        self.ring = ca.SX.sym("ring", 3 * len(motion.delays))
        self.integral = ca.SX.sym("integral", self.size)
        self.advance = self._advance()
        self.guards = self._at_fraction("guards", self.motion.guards)
        self.sent = self._at_fraction("sent", self.motion.rates, result=1)
        self.updates = self._at_fraction("updates", self.motion.updates)

    def delayed(self, ring: ca.SX, fraction: ca.SX | float) -> ca.SX:
        """Return what comes out of the delays at a fraction of the step [delays].

        Parameters
        ----------
        ring : casadi.SX [3 delays]
            Start, mean and end of each delayed quantity during the step.
        fraction : casadi.SX or float
        """
        parts = []
        for index in range(len(self.motion.delays)):
            start, mean, end = ring[3 * index], ring[3 * index + 1], ring[3 * index + 2]
            # Simpson's rule is exact: mean = (start + 4 middle + end) / 6.
            middle = (6 * mean - start - end) * 0.25
            rest = 1 - fraction
            parts.append(
                start * (rest * (1 - 2 * fraction))
                + middle * (4 * fraction * rest)
                + end * (fraction * (2 * fraction - 1))
            )
        return ca.vertcat(*parts) if parts else ca.SX(0, 1)

    def stages(self, length: ca.SX, first: ca.SX, last: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """Return the stages k₁ to k₄ of a part of a step [integral per second].

        Parameters
        ----------
        length : casadi.SX
            Of the part [s].
        first, last : casadi.SX
            Fractions of the step between which it lies.
        """
        start, half, between = self.integral, length / 2, (first + last) / 2
        k1 = self._rates(start, first)
        k2 = self._rates(start + half * k1, between)
        k3 = self._rates(start + half * k2, between)
        return k1, k2, k3, self._rates(start + length * k3, last)

    def _rates(self, integral: ca.SX, fraction: ca.SX) -> ca.SX:
        z = self.delayed(self.ring, fraction)
        contents, entering, totals = self.motion.rates(integral[: self.contents], z, *self.held)
        chosen = [totals[index] for index in self.totals]
        return ca.densify(ca.vertcat(contents, *chosen, entering))

    def _advance(self) -> ca.Function:
        """(h, s₀, s₁, integral, ring, m, u, d, p) → integral after (s₁ - s₀) h."""
        h, first, last = ca.SX.sym("h"), ca.SX.sym("first"), ca.SX.sym("last")
        start, length = self.integral, (last - first) * h
        k1, k2, k3, k4 = self.stages(length, first, last)
        after = start + length / 6 * (k1 + 2 * (k2 + k3) + k4)
        return ca.Function("advance", [h, first, last, start, self.ring, *self.held], [after])

    def _at_fraction(self, name: str, function: ca.Function, result: int = 0) -> ca.Function:
        """(s, integral, ring, m, u, d, p) → a function of the motion at a fraction of the step."""
        fraction = ca.SX.sym("fraction")
        contents = self.integral[: self.contents]
        values = function(contents, self.delayed(self.ring, fraction), *self.held)
        value = values[result] if isinstance(values, tuple) else values
        arguments = [fraction, self.integral, self.ring, *self.held]
        return ca.Function(name, arguments, [ca.densify(value)])


def located_step(
    step: MotionStep, check: ca.Function | None = None, *, cut: bool = False
) -> ca.Function:
    """Return an integration step, or a part of one, in which events are located.

    From the start of the step, or from the last event, the step is tried to its end. Where a
    guard has become zero or positive the first moment at which one is so is bracketed by halving
    and secants in turn, on the Runge-Kutta step itself; there the events that fired reset the
    memories, and the rest of the step is tried again.

    Parameters
    ----------
    step : MotionStep
    check : casadi.Function, optional
        What is asked of every part of the step between two events, as
        `clepsydra.loop.lane_status.step_check`.
    cut : bool
        Whether the fractions of the step between which it runs are told, rather than 0 and 1.

    Returns
    -------
    casadi.Function
        (h, clock, integral, ring, count [e], time [e], m, u, d, p) →
        (integral, count, time, m): how often each event has happened and when it did last [s];
        then, if it was asked, whether the check holds of any part. With `cut`, the two fractions
        are the last arguments.
    """
    events = len(step.motion.events)
    h, clock = ca.SX.sym("h"), ca.SX.sym("clock")
    count, time = ca.SX.sym("count", events), ca.SX.sym("time", events)
    m, *outside = step.held
    fraction = ca.SX.sym("fraction")
    found = ca.SX.sym("found", 0 if check is None else 1)
    begin, last = (ca.SX.sym("begin"), ca.SX.sym("last")) if cut else (0, 1)
    told = [begin, last] if cut else []
    carried = ca.vertcat(fraction, step.integral, count, time, m, found)
    invariants = ca.vertcat(h, clock, step.ring, *outside, *told[1:])

    def checked(s0: ca.SX, s1: ca.SX | int, before: ca.SX, after: ca.SX, *held: ca.SX) -> ca.SX:
        return check(h, s0, s1, before, after, step.ring, *held) if check else ca.SX(0, 1)

    now = _largest(step.guards(fraction, step.integral, step.ring, *step.held))
    end = step.advance(h, fraction, last, step.integral, step.ring, *step.held)
    at_end = _largest(step.guards(last, end, step.ring, *step.held))
    happens = ca.logic_or(now >= 0, at_end >= 0)
    first = _bracketed(step, h, fraction, last, now, at_end)
    stop = ca.if_else(happens, ca.if_else(now >= 0, fraction, first), last)
    reached = step.advance(h, fraction, stop, step.integral, step.ring, *step.held)
    fired = step.guards(stop, reached, step.ring, *step.held) >= 0
    z = step.delayed(step.ring, stop)
    after = step.motion.resets(fired, reached[: step.contents], z, *step.held)
    moment = clock + stop * h
    turn = ca.Function(
        "event",
        [ca.SX.sym("row", 0), carried, invariants],
        [
            ca.vertcat(
                stop,
                reached,
                count + fired,
                *(ca.if_else(fired[i], moment, time[i]) for i in range(events)),
                after,
                ca.fmax(found, checked(fraction, stop, step.integral, reached, *step.held)),
            )
        ],
    )
    start = ca.vertcat(begin, step.integral, count, time, m, ca.SX.zeros(found.numel()))
    result = counted_loop("events", _MOST_EVENTS, turn, carried=start, invariants=invariants)
    ends = [*accumulate((1, *step.located, found.numel()), initial=0)]
    stop, reached, count_after, time_after, m_after, found_before = ca.vertsplit(result, ends)
    held = [m_after, *outside]
    finished = step.advance(h, stop, last, reached, step.ring, *held)
    found_after = ca.fmax(found_before, checked(stop, last, reached, finished, *held))
    return ca.Function(
        "located_step",
        [h, clock, step.integral, step.ring, count, time, *step.held, *told],
        [finished, count_after, time_after, m_after, *([found_after] if check else [])],
    )


def _bracketed(
    step: MotionStep, h: ca.SX, start: ca.SX, end: ca.SX | int, now: ca.SX, at_end: ca.SX
) -> ca.SX:
    """Return the fraction, just past the first moment at which a guard is zero."""
    low, at_low = ca.SX.sym("low"), ca.SX.sym("at_low")
    high, at_high = ca.SX.sym("high"), ca.SX.sym("at_high")
    halve = ca.SX.sym("halve")
    carried = ca.vertcat(low, at_low, high, at_high)
    invariants = ca.vertcat(h, start, step.integral, step.ring, *step.held)
    secant = low - at_low * ((high - low) / ca.fmax(at_high - at_low, 1e-300))
    trial = ca.if_else(halve, (low + high) / 2, ca.fmin(ca.fmax(secant, low), high))
    there = step.advance(h, start, trial, step.integral, step.ring, *step.held)
    guard = _largest(step.guards(trial, there, step.ring, *step.held))
    past = guard >= 0
    turn = ca.Function(
        "bracket",
        [halve, carried, invariants],
        [
            ca.vertcat(
                ca.if_else(past, low, trial),
                ca.if_else(past, at_low, guard),
                ca.if_else(past, trial, high),
                ca.if_else(past, guard, at_high),
            )
        ],
    )
    result = counted_loop(
        "brackets",
        2 * _HALVINGS,
        turn,
        carried=ca.vertcat(start, now, end, at_end),
        tables=[[0.0, 1.0] * _HALVINGS],
        invariants=invariants,
    )
    return result[2]


def _largest(values: ca.SX) -> ca.SX:
    return reduce(ca.fmax, ca.vertsplit(values), ca.SX(-1))
