"""Multiloop PI: one proportional-integral controller for each pair of signals."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import AntiWindup, check_anti_windup
from clepsydra.controllers.blocks.output_stage import (
    OutputStage,
    output_stage,
    stage_equations,
)
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "multiloop PI"


def multiloop_pi_law(
    loops: int,
    anti_windup: AntiWindup = "back_calculation",
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of PI controllers, loop i from measurement_i to manipulated_i.

    In automatic, with error e = r − y and gain K, integral time Ti, setpoint weight b::

        v  = K (b r − y) + I
        u  = min(high limit, max(low limit, v))
        I⁺ = I + Δt K/Ti e + min(Δt/Tt, 1) (u − v)      back-calculation
        I⁺ = I + Δt K/Ti e  unless it pushes further into saturation      conditional integration

    The integral I is in the unit of the output and holds the bias. What happens in the other
    modes and with unusable inputs is written in `blocks.output_stage.output_stage`.

    Parameters
    ----------
    loops : int
        Number of loops.
    anti_windup : {"back_calculation", "conditional_integration"}
    measured, manipulated : sequence of Signal, optional
        The process signals of loop 1, 2, …: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs setpoint_i, measurement_i, sensor_i, mode_i, manual_i, tracking_i and
        time_step [s]; parameters proportional_gain_i, integral_time_i [s],
        setpoint_weight_i [1], low_limit_i, high_limit_i and, for back-calculation,
        tracking_time_i [s]; state integral_i, last_output_i; outputs manipulated_i,
        status_i.

    Raises
    ------
    InputError
        There is no loop, the signals are not one for each loop, or the anti-windup is unknown.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapters 3 and 13.

    Examples
    --------
    One sample at an error of 1 with K = 2, Ti = 10 s, I = 5, inside wide limits:

    >>> law = multiloop_pi_law(1, "conditional_integration")
    >>> given = dict(setpoint_1=1, measurement_1=0, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(proportional_gain_1=2, integral_time_1=10, setpoint_weight_1=1,
    ...               low_limit_1=0, high_limit_1=100)
    >>> state, outputs, _ = law.function(
    ...     [5, 0],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (7.0, 5.2)
    """
    check_anti_windup(anti_windup)
    measured = signals.wired_signals("measurement", loops, measured, "PI law, measured")
    manipulated = signals.wired_signals("output", loops, manipulated, "PI law, manipulated")
    parameters, state, outputs = [], [], []
    for i, (measurement, output) in enumerate(zip(measured, manipulated, strict=True), start=1):
        parameters += _settings(i, measurement, output)
        parameters += signals.output_parameters(i, output, anti_windup)
        state += signals.output_state(i, output)
        outputs += signals.output_signals(i, output)

    def equations(symbols: Symbols) -> Equations:
        intermediates: dict[str, ca.SX] = {}
        stages = [_loop(symbols, i, anti_windup, intermediates) for i in range(1, loops + 1)]
        return stage_equations(stages, intermediates)

    return step_law(
        "multiloop_pi",
        inputs=[
            *signals.setpoint_inputs(measured),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(manipulated),
        ],
        parameters=parameters,
        state=state,
        outputs=outputs,
        equations=equations,
    )


def _settings(i: int, measurement: Signal, output: Signal) -> list[Signal]:
    return [
        signals.gain(
            f"proportional_gain_{i}",
            signals.ratio_of_units(output.unit, measurement.unit),
            1.0,
            f"proportional gain from {measurement.name} to {output.name}",
        ),
        signals.duration(f"integral_time_{i}", "integral time"),
        Signal(
            f"setpoint_weight_{i}",
            low=0.0,
            high=1.0,
            initial=1.0,
            description="share of the setpoint in the proportional part",
        ),
    ]


def _loop(
    symbols: Symbols, i: int, anti_windup: AntiWindup, intermediates: dict[str, ca.SX]
) -> OutputStage:
    """Write loop i, and add the names of its values on the way to the intermediates."""
    raw_setpoint, raw_measurement = symbols[f"setpoint_{i}"], symbols[f"measurement_{i}"]
    setpoint_valid, measurement_valid = is_number(raw_setpoint), is_number(raw_measurement)
    setpoint = value_or_zero(raw_setpoint, setpoint_valid)
    measurement = value_or_zero(raw_measurement, measurement_valid)
    gain = symbols[f"proportional_gain_{i}"]
    integral_gain = gain / symbols[f"integral_time_{i}"]
    error = setpoint - measurement
    proportional = gain * (symbols[f"setpoint_weight_{i}"] * setpoint - measurement)
    increment = (symbols["time_step"] * integral_gain) * error
    intermediates |= {
        f"setpoint_is_number_{i}": setpoint_valid,
        f"measurement_is_number_{i}": measurement_valid,
        f"error_{i}": error,
        f"integral_gain_{i}": integral_gain,
        f"proportional_{i}": proportional,
        f"increment_{i}": increment,
    }
    return output_stage(
        symbols,
        i,
        proportional=proportional,
        increment=increment,
        signals_are_numbers=ca.logic_and(setpoint_valid, measurement_valid),
        sensors_are_good=symbols[f"sensor_{i}"],
        anti_windup=anti_windup,
    )
