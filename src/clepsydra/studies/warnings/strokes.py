"""Manipulated variables that a step sends from end to end of their range, which wears them out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.scores.effort import at_limit

#: Strokes after one step that bring a plant to rest: what reaches a setpoint soonest goes to one
#: end and to the other, and one more stroke brings it where it stays.
STROKES = 3


class Strokes(NamedTuple):
    """How often a manipulated variable goes from one limit to the other after a step.

    Parameters
    ----------
    input : str
    segment : Segment
        Of the step.
    times : int
    """

    input: str
    segment: Segment
    times: int


def driven_to_and_fro(run: Run) -> list[Strokes]:
    """Return which inputs a controller sends from end to end again and again after a step.

    Of each input the first such step. What switches pumps on and off is meant to, and what noise
    does is no answer to a step.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("wet-well")
    >>> run = cl.simulate(plant, cl.design.feedback_linearisation(plant))
    >>> [(each.input, each.segment.kind, each.times > STROKES) for each in driven_to_and_fro(run)]
    [('duty', 'setpoint', True)]
    """
    if not run.controller.setpoints:
        return []
    found = []
    period = run.scenario.sampling_period
    moved = [u.name for u in run.process.inputs if u.name in run.controller.manipulated]
    for name in moved:
        low, high = run.limits(name)
        for segment in run.scenario.segments:
            samples = slice(round(segment.start / period), round(segment.stop / period))
            count = strokes(run.values[name][samples], low, high)
            if segment.kind != "noise" and count > STROKES:
                found.append(Strokes(name, segment, count))
                break
    return found


def strokes(values: np.ndarray, low: float, high: float) -> int:
    """Return how often a signal goes from one limit to the other [signal unit].

    Parameters
    ----------
    values : ndarray [n]

    Examples
    --------
    Up to 10, down to 0, and half the way up:

    >>> strokes(np.array([2.0, 10.0, 5.0, 0.0, 5.0]), 0.0, 10.0)
    1
    """
    ends = at_limit(values, -np.inf, high).astype(int) - at_limit(values, low, np.inf)
    return int(np.count_nonzero(np.diff(ends[ends != 0])))
