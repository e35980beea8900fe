"""What became of each scenario of a batch: a status instead of an exception."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntFlag

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.engine.trajectories import Trajectories
from clepsydra.loop.motion_step import MotionStep
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline

#: A tank below this share of its height counts as emptied.
EMPTY_SHARE = 1e-3
#: A step is too long where a state may be wrong by this share of its range; see decision 18.
STEP_BOUND = 1e-3
_LARGEST_NUMBER = 1e300


class LaneStatus(IntFlag):
    """What happened at any time in a scenario; 0 where all went well."""

    EMPTIED = 1
    SPILLING = 2
    NOT_A_NUMBER = 4
    STEP_TOO_LONG = 8
    #: An event that harms the plant, see `clepsydra.process.hybrid.Event.harm`.
    HARMED = 16


#: The flags that are checked once an integration step; a harm is counted as an event anyway.
_CHECKED = tuple(flag for flag in LaneStatus if flag is not LaneStatus.HARMED)
#: One state for each of these.
STATUS_SIGNALS = tuple(
    Signal(f"status.{flag.name.lower()}", kind="boolean", low=0.0, high=1.0)
    for flag in _CHECKED
    if flag.name
)


def step_check(process: Process, step: MotionStep) -> ca.Function:
    """Return the check whether a part of an integration step is too long.

    A part of length h is too long where its stages differ from a straight line so much that a
    state x may be wrong by a thousandth of its range:

        |x(c ± e) - x(c)| > `STEP_BOUND` × range of x, with e = h/12 (k₁ - 2 k₃ + k₄).

    That is |∂x/∂c e| where the state x follows the content c on a straight line, and right as
    well at the tip of a cone, where the slope of the level on the volume has no bound above the
    floor and is small below it.

    For the way r to rest in dr/dt = λ r, and z = λ h, the left side is z⁴/48 |r|: what a step of
    the method does wrong, z⁵/120 |r| (Hairer & Wanner, Solving Ordinary Differential Equations
    II, section IV.2), added up over the time 1/|λ| in which it is forgotten, 2.5 times.
    Beyond |z| = 2.79, where the method grows without bound, it is more than the motion itself.
    Where a rate jumps by Δ inside the step it is h/12 Δ, and the error at most four times that.
    The stages are those of the step, so that the check costs a few additions and moves nothing.

    Returns
    -------
    casadi.Function
        (h, s₀, s₁, integral at s₀, integral at s₁, ring, m, u, d, p) → a truth; h [s] is the
        whole step, the part is from its fraction s₀ to s₁.
    """
    h, first, last = ca.SX.sym("h"), ca.SX.sym("first"), ca.SX.sym("last")
    after = ca.SX.sym("after", step.size)
    length = (last - first) * h
    k1, _, k3, k4 = step.stages(length, first, last)
    contents, bent = after[: step.contents], (k1 - 2 * k3 + k4)[: step.contents]
    moved = length / 12 * bent
    below, state, above = (
        step.motion.to_state(contents + part, step.held[-1]) for part in (-moved, 0, moved)
    )
    error = ca.fmax(ca.fabs(above - state), ca.fabs(state - below))
    too_long = ca.SX(0)
    for place, signal in enumerate(process.state):
        if np.isfinite(signal.span):
            sound = error[place] <= STEP_BOUND * signal.span
            too_long = ca.logic_or(too_long, ca.logic_not(sound))
    arguments = [h, first, last, step.integral, after, step.ring, *step.held]
    return ca.Function("step_check", arguments, [too_long])


def status_checks(process: Process, step: MotionStep) -> ca.Function:
    """Return what else is checked once an integration step.

    Returns
    -------
    casadi.Function
        (integral at its end, p) → three truths: emptied, spilling, not a number.
    """
    after = ca.SX.sym("after", step.size)
    parameters = step.held[-1]
    states = step.motion.to_state(after[: step.contents], parameters)
    emptied, spilling = ca.SX(0), ca.SX(0)
    for place, signal in enumerate(process.state):
        if signal.name in process.levels:
            emptied = ca.logic_or(emptied, states[place] <= EMPTY_SHARE * signal.high)
            spilling = ca.logic_or(spilling, states[place] > signal.high)
    broken = ca.SX(0)
    for place in range(step.contents):
        sound = ca.fabs(after[place]) <= _LARGEST_NUMBER
        broken = ca.logic_or(broken, ca.logic_not(sound))
    checks = ca.densify(ca.vertcat(emptied, spilling, broken))
    return ca.Function("status", [after, parameters], [checks])


def append_status(
    builder: BlockBuilder,
    process: Process,
    step: MotionStep,
    status: Sequence[int],
    arguments: Sequence[int],
    too_long: int,
) -> list[int]:
    """Append the checks of a step and return the values of the next status.

    Parameters
    ----------
    builder : BlockBuilder
    process : Process
    step : MotionStep
    status : sequence of int
        Values of the status before.
    arguments : sequence of int
        Values of all arguments of `status_checks`.
    too_long : int
        Value of `step_check`.
    """
    found = inline(builder, status_checks(process, step), list(arguments), fused=True)
    return [
        builder.operation("maximum", before, builder.operation("number", now))
        for before, now in zip(status, [*found, too_long], strict=True)
    ]


def lane_status(result: Trajectories, process: Process) -> np.ndarray:
    """Return the status of every scenario of a batch that was computed with statuses [scenarios].

    Parameters
    ----------
    result : Trajectories
    process : Process
        The one that was simulated.
    """
    columns: list[tuple[LaneStatus, np.ndarray]] = [
        (flag, result.state(signal.name))
        for flag, signal in zip(_CHECKED, STATUS_SIGNALS, strict=True)
    ]
    columns += [
        (LaneStatus.HARMED, result.state(event.counted) > 0.0)
        for event in process.motion.events
        if event.harm
    ]
    return np.bitwise_or.reduce([flag.value * column.astype(int) for flag, column in columns])
