"""LQI: state feedback with integral action on the controlled outputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import get_args

import casadi as ca

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.controllers.blocks.final_element import output_stage
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.observers.linear_state import LinearState, ObserverStructure
from clepsydra.controllers.observers.state_source import StateSource
from clepsydra.program.step_law import StepLaw, Symbols

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
    as in a PI controller (`blocks.final_element.output_stage`). A fault of any sensor holds all
    outputs that are in automatic, since each needs the whole state; an observer goes on with
    the inputs that are held.

    `measured`, `manipulated`: the process signals: they lend their names, units and ranges; without
    an observer there is a measurement for each state of the process; `controlled`: the measurements
    that have setpoints; `observer`: without it the measurements are the state.

    Raises InputError: the anti-windup is unknown or clamping: the integral is not the whole output
    here, so that the limits of the output are none for it.

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
    state = LinearState(measured, manipulated, controlled, observer)
    return lqi_law_of(state, anti_windup)


def lqi_law_of(source: StateSource, anti_windup: AntiWindup = "back_calculation") -> StepLaw:
    """Write the step law of LQI with fixed gains on a state, however it is known.

    As `lqi_law`, u = u° − F (x − x°) + I, with x from an extended Kalman filter, for one, whose
    parameters and state are among those of the law.

    Raises InputError: the anti-windup is unknown or clamping.
    """
    name = "linear_quadratic_integral" if source.from_rest else "nonlinear_lqi"
    return varying_lqi(name, source, anti_windup)


def varying_lqi(
    name: str,
    source: StateSource,
    anti_windup: AntiWindup,
    *,
    gains: Callable[[Sample, Reading, Sequence[ca.SX]], Symbols] | None = None,
    words: Sequence[str] = (),
) -> StepLaw:
    """Write the step law u = u° − F x + I, whose gains F and G may change without a bump.

    Where they do the integral takes up what a change of F makes of −F x, I + (F − F₋) x, so that
    a change of the gains alone moves nothing: between two samples u moves by −F₋ Δx + Δt G e.
    This is the velocity form of a scheduled controller, whose linear model at each point is the
    one that was designed there, and which needs no table of the outputs at rest.

    `name`: an identifier; `gains`: writes the gains of a sample, from what is read and what is
    known of the state, and returns F and G by name, where F of the last one is the law's state by
    that name; without it they are the law's parameters; `words`: for the reader of the law.

    Raises InputError: the anti-windup is unknown or clamping.

    References
    ----------
    I. Kaminer, A. M. Pascoal, P. P. Khargonekar and E. E. Coleman, A velocity algorithm for the
    implementation of gain-scheduled controllers, Automatica 31(8), 1995, 1185-1191,
    doi 10.1016/0005-1098(95)00026-S.
    """
    check_choice("anti_windup", anti_windup, get_args(AntiWindup))
    if anti_windup == "clamping":
        known = [name for name in get_args(AntiWindup) if name != "clamping"]
        raise InputError(
            "anti_windup",
            anti_windup,
            f"one of {', '.join(known)}: its integral is not the whole output",
            "choose conditional_integration",
        )

    def applied(sample: Sample, reading: Reading, known: Sequence[ca.SX]) -> list[ca.SX]:
        if gains is None:
            sample.parameters(*source.gains())
        now = sample.symbols if gains is None else gains(sample, reading, known)
        deviations = source.deviations(sample, known)
        errors = {
            path(y, "error"): reading.setpoints[y.name] - reading.measurements[y.name]
            for y in source.controlled
        }
        sample.named |= errors
        fed_back = source.feedback.times(now, deviations)
        rates = source.integral_gain.times(now, list(errors.values()))
        former = source.feedback.times(sample.symbols, deviations)
        found = []
        for u, back, before, rate in zip(source.manipulated, fed_back, former, rates, strict=True):
            (bias,) = sample.parameters(signals.at_rest(u, "bias"))
            sample.name(u, {"fed_back": back, "integral_rate": rate})
            found.append(
                output_stage(
                    sample,
                    u,
                    reading,
                    proportional=bias - back,
                    increment=sample["time_step"] * rate,
                    anti_windup=anti_windup,
                    taken_up=None if gains is None else back - before,
                )
            )
        return found

    description = (f"Anti-windup: {IN_WORDS[anti_windup]}.", *words)
    return source.law(name, applied, description)
