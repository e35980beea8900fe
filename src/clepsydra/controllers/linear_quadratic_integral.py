"""LQI: state feedback from measured signals with integral action on the controlled outputs."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import AntiWindup, check_anti_windup
from clepsydra.controllers.blocks.output_stage import output_stage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, value_or_zero
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "LQI"


def lqi_law(
    states: int,
    outputs: int,
    controlled: Sequence[int],
    anti_windup: AntiWindup = "back_calculation",
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of linear-quadratic-integral control.

    In automatic, with the measurements y, their values y° and the output u° (the bias) at the
    operating point, and the controlled measurements y_c::

        v  = u° − F (y − y°) + I
        u  = min(high limit, max(low limit, v))
        I⁺ = I + Δt G (r − y_c) + min(Δt/Tt, 1) (u − v)      back-calculation
        I⁺ = I + Δt G (r − y_c)  unless it pushes further into saturation      conditional integration

    The integrators stand behind the integral gain G, in the unit of their output, so that
    mode, anti-windup and hold act on each output by itself, as in a PI controller
    (`blocks.output_stage.output_stage`). A fault of any sensor holds all outputs that are in
    automatic, since each needs the whole state.

    Parameters
    ----------
    states : int
        Number of measurements, one for each state of the process.
    outputs : int
        Number of manipulated variables.
    controlled : sequence of int
        For setpoint_1, setpoint_2, … the number (from 1) of its measurement.
    anti_windup : {"back_calculation", "conditional_integration"}
    measured, manipulated : sequence of Signal, optional
        The process signals: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i and
        time_step [s]; parameters reference_measurement_j, feedback_i_j, integral_gain_i_j
        [per second], bias_i, low_limit_i, high_limit_i and, for back-calculation,
        tracking_time_i [s]; state integral_i, last_output_i; outputs manipulated_i,
        status_i.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, the signals do not match the numbers, or the
        anti-windup is unknown.

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
    check_anti_windup(anti_windup)
    measured = signals.wired_signals("measurement", states, measured, "LQI law, measured")
    manipulated = signals.wired_signals("output", outputs, manipulated, "LQI law, manipulated")
    controlled = tuple(controlled)
    if not controlled or any(number not in range(1, states + 1) for number in controlled):
        raise InputError(
            "LQI law, controlled",
            controlled,
            f"numbers of measurements from 1 to {states}",
            "give for each setpoint the measurement that follows it",
        )
    references = [
        signals.gain(
            f"reference_measurement_{j}",
            measurement.unit,
            0.0,
            f"{measurement.name} at the operating point",
        )
        for j, measurement in enumerate(measured, start=1)
    ]
    parameters, state, results = references, [], []
    for i, output in enumerate(manipulated, start=1):
        parameters = [
            *parameters,
            *_gains(i, output, measured, controlled),
            *signals.output_parameters(i, output, anti_windup),
        ]
        state += signals.output_state(i, output)
        results += signals.output_signals(i, output)

    def equations(symbols: Symbols) -> Equations:
        return _equations(symbols, controlled, outputs, states, anti_windup)

    return step_law(
        "linear_quadratic_integral",
        inputs=[
            *signals.setpoint_inputs([measured[number - 1] for number in controlled]),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(manipulated),
        ],
        parameters=parameters,
        state=state,
        outputs=results,
        equations=equations,
    )


def _gains(
    i: int, output: Signal, measured: Sequence[Signal], controlled: Sequence[int]
) -> list[Signal]:
    feedback = [
        signals.gain(
            f"feedback_{i}_{j}",
            signals.ratio_of_units(output.unit, measurement.unit),
            0.0,
            f"feedback gain from {measurement.name} to {output.name}",
        )
        for j, measurement in enumerate(measured, start=1)
    ]
    integral = [
        signals.gain(
            f"integral_gain_{i}_{j}",
            signals.ratio_of_units(output.unit, measured[number - 1].unit, "s"),
            0.0,
            f"integral gain from the error of {measured[number - 1].name} to {output.name}",
        )
        for j, number in enumerate(controlled, start=1)
    ]
    bias = signals.gain(f"bias_{i}", output.unit, 0.0, f"{output.name} at the operating point")
    return [*feedback, *integral, bias]


def _equations(
    symbols: Symbols,
    controlled: Sequence[int],
    outputs: int,
    states: int,
    anti_windup: AntiWindup,
) -> Equations:
    raw_measurements = [symbols[f"measurement_{j}"] for j in range(1, states + 1)]
    raw_setpoints = [symbols[f"setpoint_{j}"] for j in range(1, len(controlled) + 1)]
    valid = [is_number(value) for value in [*raw_measurements, *raw_setpoints]]
    numbers = [
        value_or_zero(*pair)
        for pair in zip([*raw_measurements, *raw_setpoints], valid, strict=True)
    ]
    measurements, setpoints = numbers[:states], numbers[states:]
    sensors_are_good = all_of([symbols[f"sensor_{j}"] for j in range(1, states + 1)])
    deviations = [
        measurement - symbols[f"reference_measurement_{j}"]
        for j, measurement in enumerate(measurements, start=1)
    ]
    errors = [
        setpoint - measurements[number - 1]
        for setpoint, number in zip(setpoints, controlled, strict=True)
    ]
    stages = []
    intermediates = {f"deviation_{j}": value for j, value in enumerate(deviations, start=1)}
    intermediates |= {f"error_{j}": value for j, value in enumerate(errors, start=1)}
    for i in range(1, outputs + 1):
        feedback = _weighted_sum(symbols, f"feedback_{i}", deviations)
        rate = _weighted_sum(symbols, f"integral_gain_{i}", errors)
        intermediates |= {f"feedback_{i}": feedback, f"integral_rate_{i}": rate}
        stages.append(
            output_stage(
                symbols,
                i,
                proportional=symbols[f"bias_{i}"] - feedback,
                increment=symbols["time_step"] * rate,
                signals_are_numbers=all_of(valid),
                sensors_are_good=sensors_are_good,
                anti_windup=anti_windup,
            )
        )
    return stage_equations(stages, intermediates)


def _weighted_sum(symbols: Symbols, prefix: str, values: list[ca.SX]) -> ca.SX:
    total = symbols[f"{prefix}_1"] * values[0]
    for number, value in enumerate(values[1:], start=2):
        total = total + symbols[f"{prefix}_{number}"] * value
    return total
