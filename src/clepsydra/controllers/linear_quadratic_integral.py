"""LQI: state feedback with integral action on the controlled outputs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup, check_anti_windup
from clepsydra.controllers.blocks.output_stage import output_stage
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.controllers.state_reading import StateSignals, weighted_sum
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "LQI"


def lqi_law(
    measurements: int,
    outputs: int,
    controlled: Sequence[int],
    anti_windup: AntiWindup = "back_calculation",
    *,
    observer: ObserverStructure | None = None,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of linear-quadratic-integral control.

    In automatic, with the state's deviation x (the measurements' y − y°, or an observer's
    estimate), the output u° (the bias) at the operating point, and the controlled measurements
    y_c::

        v  = u° − F x + I
        u  = min(high limit, max(low limit, v))
        I⁺ = I + Δt G (r − y_c) + min(Δt/Tt, 1) (u − v)      back-calculation
        I⁺ = I + Δt G (r − y_c)  unless it pushes further into saturation
                                                             conditional integration
        I⁺ = I + Δt G (r − y_c)                              none

    The second is input-constrained LQI. The integrators stand behind the integral gain G, in
    the unit of their output, so that mode, anti-windup and hold act on each output by itself,
    as in a PI controller (`blocks.output_stage.output_stage`). A fault of any sensor holds all
    outputs that are in automatic, since each needs the whole state; an observer goes on with
    the inputs that are held.

    Parameters
    ----------
    measurements, outputs : int
        Numbers of measurements and of manipulated variables; without an observer there is a
        measurement for each state of the process.
    controlled : sequence of int
        For setpoint_1, setpoint_2, … the number (from 1) of its measurement.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    observer : ObserverStructure, optional
        Without it the measurements are the state.
    measured, manipulated : sequence of Signal, optional
        The process signals: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i and
        time_step [s]; parameters reference_measurement_j, feedback_i_j, integral_gain_i_j
        [per second], bias_i, low_limit_i, high_limit_i, for back-calculation tracking_time_i
        [s], and those of the observer (`observers.current_observer`); state integral_i,
        last_output_i, estimate_j; outputs manipulated_i, status_i.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, the signals do not match the numbers, or the
        anti-windup is unknown or clamping: the integral is not the whole output here, so that
        the limits of the output are none for it.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control: Linear Quadratic Methods,
    Prentice Hall 1990, chapter 2.

    Examples
    --------
    One sample with F = 2, G = 0.1, u° = 3, y° = 4 at a measurement of 4.5 and setpoint of 5:

    >>> law = lqi_law(1, 1, [1], "conditional_integration")
    >>> given = dict(setpoint_1=5, measurement_1=4.5, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(reference_measurement_1=4, feedback_1_1=2, integral_gain_1_1=0.1,
    ...               bias_1=3, low_limit_1=0, high_limit_1=10)
    >>> state, outputs, _ = law.function(
    ...     [0, 0],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (2.0, 0.05)
    """
    check_lqi_anti_windup(anti_windup)
    state = StateSignals(
        signals.wired_signals("measurement", measurements, measured, "LQI law, measured"),
        signals.wired_signals("output", outputs, manipulated, "LQI law, manipulated"),
        tuple(controlled),
        observer,
    )
    parameters = state.reference_parameters()
    for i, output in enumerate(state.manipulated, start=1):
        *feedback, bias = state.feedback_parameters(i)
        parameters += [
            *feedback,
            *_integral_gains(i, output, state),
            bias,
            *signals.output_parameters(i, output, anti_windup),
        ]
    return step_law(
        "linear_quadratic_integral",
        inputs=state.inputs(),
        parameters=parameters,
        state=state.states(),
        outputs=state.outputs(),
        equations=lambda symbols: _equations(symbols, state, anti_windup),
        description=(f"Anti-windup: {IN_WORDS[anti_windup]}.",),
    )


def _integral_gains(i: int, output: Signal, state: StateSignals) -> list[Signal]:
    followed = [state.measured[number - 1] for number in state.controlled]
    return [
        signals.gain(
            f"integral_gain_{i}_{j}",
            signals.ratio_of_units(output.unit, measurement.unit, "s"),
            0.0,
            f"integral gain from the error of {measurement.name} to {output.name}",
        )
        for j, measurement in enumerate(followed, start=1)
    ]


def _equations(symbols: Symbols, state: StateSignals, anti_windup: AntiWindup) -> Equations:
    reading = state.read(symbols)
    errors = [
        setpoint - reading.measurements[number - 1]
        for setpoint, number in zip(reading.setpoints, state.controlled, strict=True)
    ]
    stages = []
    intermediates = {f"error_{j}": value for j, value in enumerate(errors, start=1)}
    for i, output in enumerate(state.manipulated, start=1):
        feedback = weighted_sum(symbols, f"feedback_{i}", reading.state)
        rate = weighted_sum(symbols, f"integral_gain_{i}", errors)
        intermediates |= {f"feedback_{i}": feedback, f"integral_rate_{i}": rate}
        stages.append(
            output_stage(
                symbols,
                i,
                output,
                proportional=symbols[f"bias_{i}"] - feedback,
                increment=symbols["time_step"] * rate,
                signals_are_numbers=reading.signals_are_numbers,
                sensors_are_good=reading.sensors_are_good,
                anti_windup=anti_windup,
            )
        )
    return state.equations(symbols, reading, stages, intermediates)


def check_lqi_anti_windup(anti_windup: str) -> None:
    """Refuse clamping: the integral is not the whole output.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_lqi_anti_windup("back_calculation")
    """
    check_anti_windup(anti_windup)
    if anti_windup == "clamping":
        known = [name for name in get_args(AntiWindup) if name != "clamping"]
        raise InputError(
            "LQI law, anti_windup",
            anti_windup,
            f"one of {', '.join(known)}: its integral is not the whole output",
            "choose conditional_integration",
        )
