"""Switches inside an integration step: found, carried out, and the step finished after them."""

from __future__ import annotations

from functools import reduce
from itertools import accumulate

import casadi as ca

from clepsydra.loop.motion_step import MotionStep
from clepsydra.program.counted_loop import counted_loop

#: Halvings of the bracket around an event, in turn with secant steps: 2⁻¹⁰ of a step at worst.
_HALVINGS = 10
#: Events that one step can hold; what comes later switches at the end of the step.
_MOST_EVENTS = 4


def located_step(step: MotionStep, check: ca.Function | None = None) -> ca.Function:
    """Return a whole integration step in which events are located.

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

    Returns
    -------
    casadi.Function
        (h, clock, integral, ring, count [e], time [e], m, u, d, p) →
        (integral, count, time, m): how often each event has happened and when it did last [s];
        then, if it was asked, whether the check holds of any part.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> step = MotionStep(load_process("quadruple-tank").motion)
    >>> located_step(step).n_out()
    4
    """
    events = len(step.motion.events)
    h, clock = ca.SX.sym("h"), ca.SX.sym("clock")
    count, time = ca.SX.sym("count", events), ca.SX.sym("time", events)
    m, *outside = step.held
    fraction = ca.SX.sym("fraction")
    found = ca.SX.sym("found", 0 if check is None else 1)
    carried = ca.vertcat(fraction, step.integral, count, time, m, found)
    invariants = ca.vertcat(h, clock, step.ring, *outside)

    def checked(s0: ca.SX, s1: ca.SX | int, before: ca.SX, after: ca.SX, *held: ca.SX) -> ca.SX:
        return check(h, s0, s1, before, after, step.ring, *held) if check else ca.SX(0, 1)

    now = _largest(step.guards(fraction, step.integral, step.ring, *step.held))
    end = step.advance(h, fraction, 1, step.integral, step.ring, *step.held)
    at_end = _largest(step.guards(1, end, step.ring, *step.held))
    happens = ca.logic_or(now >= 0, at_end >= 0)
    first = _bracketed(step, h, fraction, now, at_end)
    stop = ca.if_else(happens, ca.if_else(now >= 0, fraction, first), 1)
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
    start = ca.vertcat(0, step.integral, count, time, m, ca.SX.zeros(found.numel()))
    result = counted_loop("events", _MOST_EVENTS, turn, carried=start, invariants=invariants)
    ends = [*accumulate((1, *step.located, found.numel()), initial=0)]
    stop, reached, count_after, time_after, m_after, found_before = ca.vertsplit(result, ends)
    held = [m_after, *outside]
    finished = step.advance(h, stop, 1, reached, step.ring, *held)
    found_after = ca.fmax(found_before, checked(stop, 1, reached, finished, *held))
    return ca.Function(
        "located_step",
        [h, clock, step.integral, step.ring, count, time, *step.held],
        [finished, count_after, time_after, m_after, *([found_after] if check else [])],
    )


def _bracketed(step: MotionStep, h: ca.SX, start: ca.SX, now: ca.SX, at_end: ca.SX) -> ca.SX:
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
        carried=ca.vertcat(start, now, 1, at_end),
        tables=[[0.0, 1.0] * _HALVINGS],
        invariants=invariants,
    )
    return result[2]


def _largest(values: ca.SX) -> ca.SX:
    return reduce(ca.fmax, ca.vertsplit(values), ca.SX(-1))
