"""Multiloop PI and PID by SIMC, Skogestad's analytic rules."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from clepsydra.base.words import time_text
from clepsydra.controllers.decoupling import Decoupling
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import word
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME, TimedLoop, design_by_time
from clepsydra.designs.loops.pid_settings import PidSettings, SeriesSettings, from_series
from clepsydra.designs.loops.words import model_words
from clepsydra.designs.models.delayed_lags import DelayedLags, half_rule

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.designs.loops.published_rule import RuleActions
    from clepsydra.linear.linear_model import LinearModel

METHOD = "SIMC"


def simc_settings(model: DelayedLags, closed_loop_time_constant: float) -> PidSettings:
    """Return Skogestad's settings for lags with delay: PI for one lag, PID in ISA form for two.

    In series form, K' = 1/(k' (τc + θ)) with k' = k/τ1, Ti' = min(τ1, 4 (τc + θ)), Td' = τ2.

    Parameters
    ----------
    closed_loop_time_constant : float
        τc [s]; the delay θ itself for tight control.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> simc_settings(DelayedLags(1.0 / 1.1, 1.1, 0.1), 0.1)
    PidSettings(gain=5.5, integral_time=0.8, derivative_time=0.0)

    A double lag of 2 s and 1 s with a delay of 0.25 s: K' = 4, Ti' = 2 s, Td' = 1 s.

    >>> simc_settings(DelayedLags(0.5, 2.0, 0.25, 1.0), 0.25)
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


@design(
    "simc",
    "PI or PID by SIMC",
    Studied(20, "PI, SIMC"),
    Studied(80, "PI, SIMC, static decoupling", {"decoupling": "static"}),
    Studied(90, "PI, SIMC, dynamic decoupling", {"decoupling": "dynamic"}),
    Studied(120, "PID, SIMC", {"actions": "PID"}),
    keys=(
        CLOSED_LOOP_TIME,
        word("decoupling", "each loop also answers to what the others move", Decoupling),
    ),
    method=METHOD,
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
    loops together have a sensitivity peak of 2 (`designs.slowing_down`). A given τc is used as it
    is.

    Parameters
    ----------
    closed_loop_time_constant : float, optional
        τc of all loops [s].
    decoupling : {"static", "dynamic"}, optional
        Decouple the loops (`designs.decoupling`).

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
    from clepsydra.designs.loops.multiloop import MultiloopPid

    together = MultiloopPid(model, pairing, form, METHOD, decoupling)
    order = "First" if together.actions == "PI" else "Second"
    loops = together.each(lambda loop: simc_loop(loop, together.delay, together.actions))
    if order == "Second" and not any(loop.settings_at(1.0).derivative_time for loop in loops):
        raise NotApplicable("no element has a second lag, so that its PID would be the PI")
    models = f"{order}-order models by the half rule"
    time, source = closed_loop_time_constant, "SIMC (Skogestad 2003)"
    return design_by_time(together, loops, time, source, models)


def simc_loop(loop: PairedLoop, delay: float, actions: RuleActions) -> TimedLoop:
    """Return a loop by the half rule, its model of first order for PI and of second for PID.

    Without a given time it is the delay itself, or longer where a setpoint step of a tenth of the
    range would saturate the input.
    """
    model, more = half_rule(loop.element, delay, 1 if actions == "PI" else 2), ""
    if actions == "PID":
        more = f", second time constant {time_text(model.second_time_constant)}"
    shortest = max(model.delay, 1.0 / (abs(model.slope) * loop.largest_gain) - model.delay)
    return TimedLoop(partial(simc_settings, model), shortest, model_words(model, loop, more))
