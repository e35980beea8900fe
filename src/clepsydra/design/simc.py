"""Multiloop PI by SIMC, Skogestad's analytic rules."""

from __future__ import annotations

import math

from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.design.applicability import NotApplicable
from clepsydra.design.detuning import SENSITIVITY_LIMIT, Detuned, detune
from clepsydra.design.element import Element
from clepsydra.design.first_order_delay import FirstOrderDelay, half_rule
from clepsydra.design.input_room import DESIGN_STEP, largest_proportional_gain
from clepsydra.design.loop_transfer import PiSettings, loop_transfer
from clepsydra.design.multiloop import (
    Pairing,
    multiloop_pi,
    output_sizes,
    paired_loops,
    settings_in_words,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.sensitivity import maximum_sensitivity
from clepsydra.process.process import Process

METHOD = "SIMC"


def simc_settings(model: FirstOrderDelay, closed_loop_time_constant: float) -> PiSettings:
    """Return Skogestad's PI settings for a first-order model with delay.

    K = 1/(k') · 1/(τc + θ) with k' = k/τ, and Ti = min(τ, 4 (τc + θ)).

    Parameters
    ----------
    model : FirstOrderDelay
    closed_loop_time_constant : float
        τc [s]; the delay θ itself for tight control.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309, eq. (23) and (24),
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> simc_settings(FirstOrderDelay(1.0 / 1.1, 1.1, 0.1), 0.1)
    PiSettings(gain=5.5, integral_time=0.8)
    """
    horizon = closed_loop_time_constant + model.delay
    return PiSettings(1.0 / (model.slope * horizon), min(model.time_constant, 4.0 * horizon))


def design_simc(
    process: Process,
    model: LinearModel,
    pairing: Pairing,
    *,
    anti_windup: AntiWindup = "back_calculation",
    closed_loop_time_constant: float | None = None,
) -> Controller:
    """Design a PI controller for each pair by SIMC.

    Each paired element is reduced by the half rule, with half a sampling period as delay.
    Without a given closed-loop time constant, each loop takes the shortest τc that is not
    below its effective delay and at which a setpoint step of a tenth of the measurement's
    range does not saturate the input; then all are lengthened by one factor until the loops
    together have a sensitivity peak of 2 (`design.detuning`). A given τc is used as it is.

    Parameters
    ----------
    process : Process
    model : LinearModel
        With an operating point.
    pairing : sequence of (output, input)
    anti_windup : {"back_calculation", "clamping"}
    closed_loop_time_constant : float, optional
        τc of all loops [s].

    Returns
    -------
    Controller
        Loop i for the i-th pair.

    Raises
    ------
    NotApplicable
        An element has no first-order model, or the loops are unstable together.
    InputError
        The pairing is no pairing of the model, or τc is not above zero.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    The pumps stand at 3 V of 10 V, the sensors have 10 V: a step of 1 V has room for K = 3.

    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> analysis = analyse(process)
    >>> controller = design_simc(process, analysis.model, analysis.pairing)
    >>> round(controller.values["proportional_gain_1"], 6)
    3.0
    """
    loops = paired_loops(process, model, pairing, METHOD)
    period = process.sampling_period
    reduced = [
        _reduced(loop.element, period / 2.0, f"{loop.output} by {loop.input_name}")
        for loop in loops
    ]
    sizes = output_sizes(process, loops)
    selected = model.select([loop.output for loop in loops], [loop.input_name for loop in loops])
    if closed_loop_time_constant is None:
        times = []
        for loop, each in zip(loops, reduced, strict=True):
            largest = largest_proportional_gain(
                process, loop.output, loop.input_name, loop.resting_input
            )
            times.append(max(each.delay, 1.0 / (abs(each.slope) * largest) - each.delay))
        detuned = detune(
            lambda factor: [
                simc_settings(each, factor * time)
                for each, time in zip(reduced, times, strict=True)
            ],
            selected,
            period,
            sizes,
            METHOD,
        )
        times = [detuned.factor * time for time in times]
    else:
        times = [_given_time(closed_loop_time_constant)] * len(loops)
        settings = tuple(simc_settings(each, times[0]) for each in reduced)
        loop_model = loop_transfer(selected, settings, period, sizes)
        detuned = Detuned(settings, 1.0, maximum_sensitivity(*loop_model).peak)
        if math.isinf(detuned.peak):
            raise NotApplicable(
                METHOD,
                f"the loops together are unstable at a closed-loop time constant of {times[0]:g} s",
            )
    approximations = "; ".join(
        f"{loop.output} by {loop.input_name}: slope {each.slope:.3g}/s, time constant "
        f"{each.time_constant:.3g} s, delay {each.delay:.3g} s, closed-loop time constant "
        f"{time:.3g} s"
        for loop, each, time in zip(loops, reduced, times, strict=True)
    )
    return multiloop_pi(
        process,
        model,
        loops,
        detuned.settings,
        anti_windup=anti_windup,
        method=METHOD,
        design=(
            f"SIMC (Skogestad 2003), {settings_in_words(process, loops, detuned.settings)}; "
            f"sensitivity peak of all loops together {detuned.peak:.2f}."
        ),
        notes=[f"First-order models by the half rule: {approximations}.", *_notes(detuned)],
    )


def _reduced(found: Element, delay: float, pair: str) -> FirstOrderDelay:
    try:
        return half_rule(found, delay, method=METHOD)
    except NotApplicable as refusal:
        raise NotApplicable(METHOD, f"{pair}: {refusal.reason}") from None


def _given_time(value: float) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(
            "SIMC, closed_loop_time_constant", value, "a time above 0 s", "give it in seconds"
        )
    return value


def _notes(detuned: Detuned) -> list[str]:
    if detuned.factor > 1.0:
        return [
            f"The closed-loop time constants were lengthened {detuned.factor:.3g} times, so that "
            f"the interacting loops keep a sensitivity peak of {SENSITIVITY_LIMIT:g}."
        ]
    if detuned.peak > SENSITIVITY_LIMIT:
        return [
            f"The sensitivity peak is {detuned.peak:.2f}, above {SENSITIVITY_LIMIT:g}: choose a "
            "longer closed-loop time constant."
        ]
    return [
        f"A setpoint step of {100 * DESIGN_STEP:.0f} % of the range was taken for the choice of "
        "the closed-loop time constants."
    ]
