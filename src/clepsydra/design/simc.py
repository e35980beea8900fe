"""Multiloop PI by SIMC, Skogestad's analytic rules."""

from __future__ import annotations

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.design.applicability import reasons_about
from clepsydra.design.control_authority import DESIGN_STEP
from clepsydra.design.detuning import SENSITIVITY_LIMIT, Detuned, as_given, detune
from clepsydra.design.first_order_delay import FirstOrderDelay, half_rule
from clepsydra.design.multiloop import MultiloopPi, PairedLoop, Pairing, note_on_peak
from clepsydra.design.pi_settings import PiSettings
from clepsydra.design.request import positive_number
from clepsydra.linear.linear_model import LinearModel

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
    model: LinearModel,
    pairing: Pairing,
    *,
    anti_windup: AntiWindup = "back_calculation",
    closed_loop_time_constant: float | None = None,
) -> Controller:
    """Design a PI controller for each pair by SIMC.

    Each paired element is reduced by the half rule, with its dead time and half a sampling
    period as delay. Without a given closed-loop time constant, each loop takes the shortest τc
    that is not below its effective delay and at which a setpoint step of a tenth of the
    measurement's range does not saturate the input; then all are lengthened by one factor
    until the sampled loops together have a sensitivity peak of 2 (`design.detuning`). A given
    τc is used as it is.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input)
    anti_windup : {"back_calculation", "conditional_integration"}
    closed_loop_time_constant : float, optional
        τc of all loops [s].

    Returns
    -------
    Controller
        Loop i for the i-th pair.

    Raises
    ------
    NotApplicable
        An element has no first-order model, the loops are unstable together, or a setting is
        outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the
        anti-windup is unknown, or τc is not above zero.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    The pumps stand at 3 V of 10 V, the sensors have 10 V: a step of 1 V has room for K = 3.

    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> round(controller.values["proportional_gain_1"], 6)
    3.0
    """
    together = MultiloopPi(model, pairing, anti_windup, METHOD)
    reduced = [_reduced(loop, together.process.sampling_period / 2.0) for loop in together.loops]

    def settings_at(times: list[float]) -> list[PiSettings]:
        return [simc_settings(each, time) for each, time in zip(reduced, times, strict=True)]

    if closed_loop_time_constant is None:
        shortest = [_shortest(*pair) for pair in zip(together.loops, reduced, strict=True)]
        found = detune(
            lambda factor: settings_at([factor * time for time in shortest]), together.peak, METHOD
        )
        times = [found.factor * time for time in shortest]
    else:
        time = _given_time(closed_loop_time_constant)
        times = [time] * len(reduced)
        choice = f"a closed-loop time constant of {time:g} s"
        found = as_given(settings_at(times), together.peak, METHOD, choice)
    return together.controller(
        found, "SIMC (Skogestad 2003)", _notes(found, together.loops, reduced, times)
    )


def _reduced(loop: PairedLoop, delay: float) -> FirstOrderDelay:
    with reasons_about(loop.pair):
        return half_rule(loop.element, delay, method=METHOD)


def _shortest(loop: PairedLoop, reduced: FirstOrderDelay) -> float:
    """Return the shortest closed-loop time constant that delay and input allow [s]."""
    return max(reduced.delay, 1.0 / (abs(reduced.slope) * loop.largest_gain) - reduced.delay)


def _given_time(value: float) -> float:
    place = f"{METHOD}, closed_loop_time_constant"
    return positive_number(place, value, "a time above 0 s", "give it in seconds")


def _notes(
    found: Detuned,
    loops: list[PairedLoop],
    reduced: list[FirstOrderDelay],
    times: list[float],
) -> list[str]:
    approximations = "; ".join(
        f"{loop.pair}: slope {each.slope:.3g}/s, time constant {each.time_constant:.3g} s, "
        f"delay {each.delay:.3g} s, closed-loop time constant {time:.3g} s"
        for loop, each, time in zip(loops, reduced, times, strict=True)
    )
    notes = [f"First-order models by the half rule: {approximations}."]
    if found.factor > 1.0:
        notes.append(
            f"The closed-loop time constants were lengthened {found.factor:.3g} times, so that "
            f"the interacting loops keep a sensitivity peak of {SENSITIVITY_LIMIT:g}."
        )
    elif found.peak > SENSITIVITY_LIMIT:
        notes += note_on_peak(found, "choose a longer closed-loop time constant")
    else:
        notes.append(
            f"A setpoint step of {100 * DESIGN_STEP:.0f} % of the range was taken for the choice "
            "of the closed-loop time constants."
        )
    return notes
