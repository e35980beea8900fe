"""Multiloop PI and PID by SIMC, Skogestad's analytic rules."""

from __future__ import annotations

from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import Decoupling
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import NotApplicable, reasons_about
from clepsydra.designs.loops.closed_loop_time import TimedLoop, design_by_time
from clepsydra.designs.loops.multiloop import MultiloopPid, PairedLoop, checked_form
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.loops.pid_settings import PidSettings, SeriesSettings, from_series
from clepsydra.designs.loops.words import lag, slope
from clepsydra.designs.models.first_order_delay import FirstOrderDelay, half_rule
from clepsydra.designs.models.second_order_delay import SecondOrderDelay, half_rule_of_second_order
from clepsydra.linear.linear_model import LinearModel

METHOD = "SIMC"


def simc_settings(model: FirstOrderDelay, closed_loop_time_constant: float) -> PidSettings:
    """Return Skogestad's PI settings for a first-order model with delay.

    K = 1/(k') · 1/(τc + θ) with k' = k/τ, and Ti = min(τ, 4 (τc + θ)).

    Parameters
    ----------
    model : FirstOrderDelay
    closed_loop_time_constant : float
        τc [s]; the delay θ itself for tight control.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> simc_settings(FirstOrderDelay(1.0 / 1.1, 1.1, 0.1), 0.1)
    PidSettings(gain=5.5, integral_time=0.8, derivative_time=0.0)
    """
    horizon = closed_loop_time_constant + model.delay
    return PidSettings(1.0 / (model.slope * horizon), min(model.time_constant, 4.0 * horizon))


def simc_pid_settings(model: SecondOrderDelay, closed_loop_time_constant: float) -> PidSettings:
    """Return Skogestad's PID settings for a second-order model with delay, in ISA form.

    In series form, K' = 1/(k' (τc + θ)) with k' = k/τ1, Ti' = min(τ1, 4 (τc + θ)), Td' = τ2.

    Parameters
    ----------
    model : SecondOrderDelay
    closed_loop_time_constant : float
        τc [s]

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    A double lag of 2 s and 1 s with a delay of 0.25 s: K' = 4, Ti' = 2 s, Td' = 1 s.

    >>> simc_pid_settings(SecondOrderDelay(0.5, 2.0, 1.0, 0.25), 0.25)
    PidSettings(gain=6.0, integral_time=3.0, derivative_time=0.6666666666666666)
    """
    horizon = closed_loop_time_constant + model.delay
    return from_series(
        SeriesSettings(
            1.0 / (model.slope * horizon),
            min(model.time_constant, 4.0 * horizon),
            model.second_time_constant,
        )
    )


def design_simc(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    closed_loop_time_constant: float | None = None,
    decoupling: Decoupling | None = None,
) -> Controller:
    """Design a PI or PID controller for each pair by SIMC.

    Each paired element is reduced by the half rule, to first order for PI and to second order
    for PID, with its dead time and half a sampling period as delay. Without a given
    closed-loop time constant, each loop takes the shortest τc that is not below its effective
    delay and at which a setpoint step of a tenth of the measurement's range does not saturate
    the input by the gain of the rule; then all are lengthened by one factor until the sampled
    loops together have a sensitivity peak of 2 (`designs.loops.detuning`). A given τc is used as it
    is.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input), or mapping, optional
        The one that the relative gains suggest if left out.
    form : PidForm, optional
        PI in ISA form if left out.
    closed_loop_time_constant : float, optional
        τc of all loops [s].
    decoupling : {"static", "dynamic"}, optional
        Decouple the loops (`designs.decoupling`).

    Returns
    -------
    Controller
        Loop i for the i-th pair.

    Raises
    ------
    NotApplicable
        An element has no such model, no element has a second lag for a PID to work on, the
        loops are unstable together, there is no decoupler, or a setting is outside of what a
        controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form is
        neither PI nor PID, or τc is not above zero.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    The pumps stand at 3 V of 10 V, the sensors have 10 V: a step of 1 V has room for K = 3.

    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> round(controller.values["level_1.proportional_gain"], 6)
    3.0
    """
    form, actions = checked_form(form, METHOD)
    together = MultiloopPid(model, pairing, form, METHOD, decoupling)
    delay = together.process.sampling_period / 2.0
    source = "SIMC (Skogestad 2003)"
    if actions == "PI":
        loops = [_first_order(loop, delay) for loop in together.loops]
        models = "First-order models by the half rule"
        return design_by_time(together, loops, closed_loop_time_constant, source, models)
    reduced = [_reduced_to_second_order(loop, delay) for loop in together.loops]
    if not any(each.second_time_constant for each in reduced):
        raise NotApplicable(METHOD, "no element has a second lag, so that its PID would be the PI")
    loops = [_second_order(*pair) for pair in zip(together.loops, reduced, strict=True)]
    models = "Second-order models by the half rule"
    return design_by_time(together, loops, closed_loop_time_constant, source, models)


def _first_order(loop: PairedLoop, delay: float) -> TimedLoop:
    with reasons_about(loop.pair):
        model = half_rule(loop.element, delay, method=METHOD)
    return TimedLoop(
        lambda time: simc_settings(model, time),
        _shortest(loop, model),
        f"{slope(model.slope, loop.output, loop.input)}, {lag(model.time_constant)}, "
        f"delay {time_text(model.delay)}",
    )


def _reduced_to_second_order(loop: PairedLoop, delay: float) -> SecondOrderDelay:
    with reasons_about(loop.pair):
        return half_rule_of_second_order(loop.element, delay, method=METHOD)


def _second_order(loop: PairedLoop, model: SecondOrderDelay) -> TimedLoop:
    return TimedLoop(
        lambda time: simc_pid_settings(model, time),
        _shortest(loop, model),
        f"{slope(model.slope, loop.output, loop.input)}, {lag(model.time_constant)}, second time "
        f"constant {time_text(model.second_time_constant)}, delay {time_text(model.delay)}",
    )


def _shortest(loop: PairedLoop, model: FirstOrderDelay | SecondOrderDelay) -> float:
    """Return the shortest closed-loop time constant that delay and input allow [s]."""
    return max(model.delay, 1.0 / (abs(model.slope) * loop.largest_gain) - model.delay)
