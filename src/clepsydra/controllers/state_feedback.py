"""State feedback with a precompensator, from measurements or from an observer."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.output_stage import output_stage
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.controllers.state_reading import StateSignals, weighted_sum
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "state feedback"


def state_feedback_law(
    measurements: int,
    outputs: int,
    controlled: Sequence[int],
    *,
    observer: ObserverStructure | None = None,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
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

    Parameters
    ----------
    measurements, outputs : int
        Numbers of measurements and of manipulated variables.
    controlled : sequence of int
        For setpoint_1, setpoint_2, … the number (from 1) of its measurement.
    observer : ObserverStructure, optional
        Without it the measurements are the state.
    measured, manipulated : sequence of Signal, optional
        The process signals: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i and
        time_step [s]; parameters reference_measurement_j, feedback_i_j, precompensator_i_j,
        bias_i, fading_time_i [s], low_limit_i, high_limit_i and those of the observer
        (`observers.current_observer`); state integral_i, last_output_i, estimate_j; outputs
        manipulated_i, status_i.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, or the signals do not match the numbers.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.

    Examples
    --------
    One sample with F = 2, N = 3, u° = 3, y° = 4 at a measurement of 4.5 and setpoint of 5:

    >>> law = state_feedback_law(1, 1, [1])
    >>> given = dict(setpoint_1=5, measurement_1=4.5, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(reference_measurement_1=4, feedback_1_1=2, precompensator_1_1=3, bias_1=3,
    ...               fading_time_1=10, low_limit_1=0, high_limit_1=10)
    >>> state, outputs, _ = law.function(
    ...     [0, 0],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0])
    5.0
    """
    state = StateSignals(
        signals.wired_signals("measurement", measurements, measured, "state feedback, measured"),
        signals.wired_signals("output", outputs, manipulated, "state feedback, manipulated"),
        tuple(controlled),
        observer,
    )
    parameters = state.reference_parameters()
    for i, output in enumerate(state.manipulated, start=1):
        parameters += [
            *state.feedback_parameters(i),
            *_precompensator(i, output, state),
            signals.duration(
                f"fading_time_{i}", f"time in which a bumpless start of {output.name} fades"
            ),
            *signals.output_parameters(i, output, "conditional_integration"),
        ]
    return step_law(
        "state_feedback",
        inputs=state.inputs(),
        parameters=parameters,
        state=state.states(),
        outputs=state.outputs(),
        equations=lambda symbols: _equations(symbols, state),
    )


def _precompensator(i: int, output: Signal, state: StateSignals) -> list[Signal]:
    followed = [state.measured[number - 1] for number in state.controlled]
    return [
        signals.gain(
            f"precompensator_{i}_{j}",
            signals.ratio_of_units(output.unit, measurement.unit),
            0.0,
            f"gain from the setpoint of {measurement.name} to {output.name}",
        )
        for j, measurement in enumerate(followed, start=1)
    ]


def _equations(symbols: Symbols, state: StateSignals) -> Equations:
    reading = state.read(symbols)
    wishes = [
        setpoint - symbols[f"reference_measurement_{number}"]
        for setpoint, number in zip(reading.setpoints, state.controlled, strict=True)
    ]
    time_step = ca.if_else(is_time_step(symbols["time_step"]), symbols["time_step"], 1)
    stages = []
    intermediates = {f"wish_{j}": value for j, value in enumerate(wishes, start=1)}
    for i, output in enumerate(state.manipulated, start=1):
        feedback = weighted_sum(symbols, f"feedback_{i}", reading.state)
        feedforward = weighted_sum(symbols, f"precompensator_{i}", wishes)
        intermediates |= {f"feedback_{i}": feedback, f"feedforward_{i}": feedforward}
        share = tracking_share(time_step, symbols[f"fading_time_{i}"])
        stages.append(
            output_stage(
                symbols,
                i,
                output,
                proportional=symbols[f"bias_{i}"] - feedback + feedforward,
                increment=-share * symbols[f"integral_{i}"],
                signals_are_numbers=reading.signals_are_numbers,
                sensors_are_good=reading.sensors_are_good,
                anti_windup="conditional_integration",
            )
        )
    return state.equations(symbols, reading, stages, intermediates)
