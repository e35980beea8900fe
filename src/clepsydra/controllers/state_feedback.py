"""State feedback with a precompensator, from measurements or from an observer."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.final_element import output_stage
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.validity import time_step_of
from clepsydra.controllers.observers.linear_state import LinearState, ObserverStructure
from clepsydra.program.step_law import StepLaw

FAMILY = "state feedback"


def state_feedback_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    controlled: Sequence[str],
    *,
    observer: ObserverStructure | None = None,
) -> StepLaw:
    """Write the step law of state feedback with a precompensator.

    In automatic, with the state's deviation x (the measurements' y − y°, or an observer's
    estimate), the setpoints r and the output u° (the bias) at the operating point::

        u = min(high limit, max(low limit, u° − F x + N (r − r°) + b))

    where r° is the controlled measurement at the operating point. There is no integral action:
    a load leaves an offset, unless the observer estimates it and F takes it away.

    b takes the place of the integral in the output stage and makes changes of mode bumpless:
    when automatic takes over, it is what the operator's output was above the law's. Kept for
    ever it would be an offset that a change of mode leaves behind, so it fades,
    b⁺ = b − min(Δt/Tf, 1) b, but not further into saturation.

    A fault of any sensor holds all outputs that are in automatic, since each needs the whole
    state; an observer goes on with the inputs that are held.

    `measured`, `manipulated`: the process signals: they lend their names, units and ranges;
    `controlled`: the measurements that have setpoints; `observer`: without it the measurements are
    the state.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.

    Examples
    --------
    One sample with F = 2, N = 3, u° = 3, y° = 4 at a measurement of 4.5 and setpoint of 5:

    >>> law = state_feedback_law(["level"], ["pump"], ["level"])
    >>> given = dict(sp=5, pv=4.5, good=1, mode=1, time_step=1)
    >>> values = {"level.reference": 4, "pump.feedback.level": 2, "pump.bias": 3,
    ...           "pump.precompensator.level": 3, "pump.fading_time": 10, "pump.low_limit": 0,
    ...           "pump.high_limit": 10}
    >>> state, outputs, _ = law.function(
    ...     [0, 0],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0])
    5.0
    """
    state = LinearState(measured, manipulated, controlled, observer)
    words = "gain from the setpoint of {by} to {to}"
    ahead = Matrix("precompensator", state.manipulated, state.controlled, words)

    def applied(sample: Sample, reading: Reading, known: Sequence[ca.SX]) -> list[ca.SX]:
        wishes = {
            path(y, "wish"): setpoint - sample[path(y, "reference")]
            for y, setpoint in reading.setpoints.items()
        }
        sample.named |= wishes
        sample.parameters(*state.feedback.signals(), *ahead.signals())
        fed_back = state.feedback.times(sample.symbols, state.deviations(sample, known))
        fed_forward = ahead.times(sample.symbols, list(wishes.values()))
        at_rest = sample.parameters(*(signals.at_rest(u, "bias") for u in state.manipulated))
        return [
            fading_output(sample, u, reading, bias - back + forward)
            for u, bias, back, forward in zip(
                state.manipulated, at_rest, fed_back, fed_forward, strict=True
            )
        ]

    return state.law("state_feedback", applied)


def fading_output(sample: Sample, u: Signal, reading: Reading, asked: ca.SX) -> ca.SX:
    """Return what stands at an output whose integral b only makes a start bumpless.

    b⁺ = b − min(Δt/Tf, 1) b, unless that pushes further into saturation.

    `asked`: what the law asks for, with the bias.
    """
    time_step, _ = time_step_of(sample.symbols)
    (integral,) = sample.memory(signals.INTEGRAL.of(u, output=u))
    (time,) = sample.parameters(signals.FADING_TIME.of(u, output=u))
    return output_stage(
        sample,
        u,
        reading,
        proportional=asked,
        increment=-tracking_share(time_step, time) * integral,
        anti_windup="conditional_integration",
    )
