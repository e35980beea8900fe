"""Multiloop PI by lambda tuning, for self-regulating elements and for integrating levels."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME, TimedLoop, design_by_time
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import model_words
from clepsydra.designs.models.delayed_lags import DelayedLags, half_rule

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.linear.linear_model import LinearModel

METHOD = "lambda"
#: The closed loop is slower than this many delays, unless the user asks for more speed.
DELAYS = 3.0
#: A lag of more than this many times the shortest λ acts like an integrator.
NEARLY_INTEGRATING = 10.0


def lambda_settings(model: DelayedLags, closed_loop_time_constant: float) -> PidSettings:
    """Return the settings by lambda tuning for a first-order or integrating model with delay.

    Self-regulating, the zero of the controller cancels the lag, and a setpoint step is answered
    with the time constant λ::

        K = τ/(k (λ + θ)),   Ti = τ

    Integrating with slope k', the loop is critically damped, with the delay as 1 − θs, and λ is
    the time after which a step of the load is arrested::

        K = (2 λ + θ)/(k' (λ + θ)²),   Ti = 2 λ + θ

    The first is also what internal model control gives for PI (Rivera, Morari and Skogestad
    1986), so there is no rule of that name here.

    Parameters
    ----------
    closed_loop_time_constant : float
        λ [s]

    References
    ----------
    For self-regulating elements D. E. Rivera, M. Morari and S. Skogestad, Industrial &
    Engineering Chemistry Process Design and Development 25(1), 1986, 252-265,
    doi 10.1021/i200032a041. For integrating ones T. Olsen and W. L. Bialkowski, Lambda tuning
    as a promising controller tuning method for the refinery, AIChE Spring National Meeting,
    2002; the formulas are derived here from the placed poles.

    Examples
    --------
    A level that integrates with 0.02 s⁻¹ and 1 s of delay, λ = 4 s:

    >>> lambda_settings(DelayedLags(0.02, math.inf, 1.0), 4.0)
    PidSettings(gain=18.0, integral_time=9.0, derivative_time=0.0)
    """
    time, delay = closed_loop_time_constant, model.delay
    if math.isinf(model.time_constant):
        integral_time = 2.0 * time + delay
        return PidSettings(integral_time / (model.slope * (time + delay) ** 2), integral_time)
    return PidSettings(1.0 / (model.slope * (time + delay)), model.time_constant)


@design(
    "lambda",
    "PI by lambda tuning",
    Studied(30, "PI, lambda"),
    keys=(CLOSED_LOOP_TIME,),
    method=METHOD,
)
def design_lambda(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    closed_loop_time_constant: float | None = None,
) -> Controller:
    """Design a PI controller for each pair by lambda tuning.

    Each paired element is reduced by the half rule, with its dead time and half a sampling
    period as delay. Without a given λ, each loop takes the shortest that is not below three
    effective delays and at which a setpoint step of a tenth of the measurement's range does not
    saturate the input; a self-regulating loop is not made faster than its own lag. Then all are
    lengthened by one factor until the sampled loops together have a sensitivity peak of 2
    (`designs.slowing_down`). A given λ is used as it is. An element whose lag is more than ten
    times λ is taken as integrating: to cancel such a lag would leave loads to be answered as
    slowly.

    Parameters
    ----------
    closed_loop_time_constant : float, optional
        λ of all loops [s].

    Raises
    ------
    NotApplicable
        An element has no first-order model, the loops are unstable together, or a setting is
        outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form is
        not PI, or λ is not above zero.

    References
    ----------
    As for `lambda_settings`.

    Examples
    --------
    A basin that integrates, sampled each minute: Ti = 2 λ + θ with θ = 30 s.

    >>> import clepsydra as cl
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> controller = design_lambda(
    ...     analysis.model, analysis.pairing, closed_loop_time_constant=3600.0)
    >>> round(controller.values["level.integral_time"], 6)
    7230.0
    """
    from clepsydra.designs.loops.multiloop import MultiloopPid, pi_only

    together, time = MultiloopPid(model, pairing, pi_only(form), METHOD), closed_loop_time_constant
    loops = together.each(lambda loop: _timed(loop, together.delay, time))
    source = "Lambda tuning (Olsen and Bialkowski 2002)"
    return design_by_time(together, loops, time, source, "First-order models by the half rule")


def _timed(loop: PairedLoop, delay: float, given: float | None) -> TimedLoop:
    lag = half_rule(loop.element, delay)
    rate = abs(lag.slope) * loop.largest_gain
    shortest = given
    if shortest is None:
        # As an integrator its gain is the largest where rate (λ + θ)² = 2 (λ + θ) − θ.
        inside = 1.0 - rate * lag.delay
        room = (1.0 + math.sqrt(inside)) / rate - lag.delay if inside > 0.0 else 0.0
        shortest = max(DELAYS * lag.delay, room)
    model, taken = lag, ""
    if lag.time_constant > NEARLY_INTEGRATING * shortest:
        model = replace(lag, time_constant=math.inf)
        taken = ", taken as integrating" if math.isfinite(lag.time_constant) else ""
    else:
        shortest = max(DELAYS * lag.delay, lag.time_constant, 1.0 / rate - lag.delay)
    words = model_words(lag, loop, taken)
    return TimedLoop(lambda time: lambda_settings(model, time), shortest, words)
