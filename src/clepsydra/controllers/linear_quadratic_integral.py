"""LQI: state feedback with integral action on the controlled outputs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup, check_anti_windup
from clepsydra.controllers.blocks.output_stage import output_stage
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.controllers.state_reading import StateSignals
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "LQI"


def lqi_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    controlled: Sequence[str],
    anti_windup: AntiWindup = "back_calculation",
    *,
    observer: ObserverStructure | None = None,
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
    measured, manipulated : sequence of Signal or str
        The process signals: they lend their names, units and ranges; without an observer there
        is a measurement for each state of the process.
    controlled : sequence of str
        The measurements that have setpoints.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    observer : ObserverStructure, optional
        Without it the measurements are the state.

    Returns
    -------
    StepLaw
        Inputs sp of each controlled measurement, pv and good of each one, mode, manual and
        tracking of each output, and time_step [s]; parameters reference of each measurement,
        feedback.STATE, integral_gain.MEASUREMENT [per second], bias, low_limit, high_limit and,
        for back-calculation, tracking_time [s] of each output, and those of the observer
        (`observers.current_observer`); state integral and last_output of each output, estimate
        of each state; outputs out and status of each output.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, a signal is named twice, or the anti-windup is
        unknown or clamping: the integral is not the whole output here, so that the limits of
        the output are none for it.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control: Linear Quadratic Methods,
    Prentice Hall 1990, chapter 2.

    Examples
    --------
    One sample with F = 2, G = 0.1, u° = 3, y° = 4 at a measurement of 4.5 and setpoint of 5:

    >>> law = lqi_law(["level"], ["pump"], ["level"], "conditional_integration")
    >>> given = dict(sp=5, pv=4.5, good=1, mode=1, time_step=1)
    >>> values = {"level.reference": 4, "pump.feedback.level": 2, "pump.bias": 3,
    ...           "pump.integral_gain.level": 0.1, "pump.low_limit": 0, "pump.high_limit": 10}
    >>> state, outputs, _ = law.function(
    ...     [0, 0],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (2.0, 0.05)
    """
    check_lqi_anti_windup(anti_windup)
    state = StateSignals.of(measured, manipulated, controlled, observer, "LQI law")
    parameters = state.reference_parameters()
    for u in state.manipulated:
        parameters += [
            *state.feedback_parameters(u),
            *state.integral_parameters(u),
            signals.at_rest(u, "bias"),
            *signals.output_parameters(u, anti_windup),
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


def _equations(symbols: Symbols, state: StateSignals, anti_windup: AntiWindup) -> Equations:
    reading = state.read(symbols)
    errors = reading.errors
    stages, intermediates = [], dict(errors)
    for u in state.manipulated:
        feedback = state.fed_back(symbols, u, reading)
        rate = state.of_controlled(symbols, u, "integral_gain", list(errors.values()))
        intermediates |= {path(u, "feedback"): feedback, path(u, "integral_rate"): rate}
        stages.append(
            output_stage(
                symbols,
                u,
                proportional=symbols[path(u, "bias")] - feedback,
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
