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
#: RK4 grows without bound where |λ| h is above 2.79; this much is refused.
_LONGEST_STEP = 2.0
_LARGEST_NUMBER = 1e300


class LaneStatus(IntFlag):
    """What happened at any time in a scenario; 0 where all went well.

    Examples
    --------
    >>> LaneStatus(3) == LaneStatus.EMPTIED | LaneStatus.SPILLING
    True
    """

    EMPTIED = 1
    SPILLING = 2
    NOT_A_NUMBER = 4
    STEP_TOO_LONG = 8


#: One state for each, in the order of the flags.
STATUS_SIGNALS = tuple(
    Signal(f"status.{flag.name.lower()}", kind="boolean", low=0.0, high=1.0)
    for flag in LaneStatus
    if flag.name
)


def status_checks(process: Process, step: MotionStep, step_length: float) -> ca.Function:
    """Return what is checked once an integration step.

    A step is too long where the stages of the Runge-Kutta method say so: for a linear system
    k₃ - k₂ = λ h/2 (k₂ - k₁) along each eigenvector, so the ratio of these differences shows
    |λ| h, which the method bears up to 2.79 (Hairer & Wanner, Solving Ordinary Differential
    Equations II, section IV.2).

    Parameters
    ----------
    process : Process
    step : MotionStep
        Of its motion.
    step_length : float
        [s]

    Returns
    -------
    casadi.Function
        (integral at the start, integral at the end, ring, m, u, d, p) → four truths.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> status_checks(process, MotionStep(process.motion), 1.0).size_out(0)
    (4, 1)
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
    arguments = [step.integral, after, step.ring, *step.held]
    checks = ca.vertcat(emptied, spilling, broken, _too_long(process, step, step_length))
    return ca.Function("status", arguments, [ca.densify(checks)])


def _too_long(process: Process, step: MotionStep, step_length: float) -> ca.SX:
    first, second, third = step.stages(step_length)
    too_long = ca.SX(0)
    for place, signal in enumerate(process.motion.contents):
        later = ca.fabs(third[place] - second[place])
        earlier = ca.fabs(second[place] - first[place])
        # Differences that move the content by less than rounding mean nothing.
        noise = 1e-12 / step_length * (signal.span if np.isfinite(signal.span) else 1.0)
        too_long = ca.logic_or(too_long, later > _LONGEST_STEP / 2 * earlier + noise)
    return too_long


def append_status(
    builder: BlockBuilder,
    process: Process,
    step: MotionStep,
    step_length: float,
    status: Sequence[int],
    integrals: Sequence[int],
) -> list[int]:
    """Append the checks of a step and return the values of the next status.

    Parameters
    ----------
    builder : BlockBuilder
    process : Process
    step : MotionStep
    step_length : float
        [s]
    status : sequence of int
        Values of the status before.
    integrals : sequence of int
        Values of all arguments of `status_checks`.
    """
    found = inline(builder, status_checks(process, step, step_length), list(integrals), fused=True)
    return [
        builder.operation("maximum", before, builder.operation("number", now))
        for before, now in zip(status, found, strict=True)
    ]


def lane_status(result: Trajectories) -> np.ndarray:
    """Return the status of every scenario of a batch that was computed with statuses [scenarios].

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.engine.kernel import Kernel
    >>> from clepsydra.loop.closed_loop import closed_loop
    >>> analysis = cl.analyse(cl.load_process("quadruple-tank"))
    >>> controller = cl.design_simc(analysis.model, analysis.pairing)
    >>> loop = cl.Loop(controller, analysis.model)
    >>> program = closed_loop(loop.process, controller, substeps=1, statuses=True)
    >>> start = loop.initial_state() | {"tank_1.level": np.array([0.12, 0.25])}
    >>> inputs = loop.at_rest()
    >>> [LaneStatus(int(s)).name for s in lane_status(Kernel(program).run(5, inputs=inputs,
    ...     state=start, parameters=loop.law_parameters()))]
    [None, 'SPILLING']
    """
    flags = [flag.value for flag in LaneStatus]
    columns = [result.state(signal.name) for signal in STATUS_SIGNALS]
    return np.sum([f * c for f, c in zip(flags, columns, strict=True)], axis=0).astype(int)
