"""PI controllers of averaging levels by arrest time: as slow as the vessel allows."""

from __future__ import annotations

import math
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.arguments.of_process import one_deviation
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.averaging_room import (
    Room,
    averaging_room,
    is_level,
    load_steps,
    smallest_area,
)
from clepsydra.designs.loops.multiloop import MultiloopPid, pi_only
from clepsydra.designs.loops.pairing import PairedLoop, Pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import by_pair
from clepsydra.designs.models.delayed_lags import DelayedLags, half_rule
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, note_on_peak
from clepsydra.linear.linear_model import LinearModel

METHOD = "arrest time"
_SOURCE = "Arrest time (Bialkowski; Olsen and Bialkowski 2002), poles placed"


def arrest_time_for(
    model: DelayedLags, deviation: float, load_rate: float, damping: float = 1.0
) -> float:
    """Return the arrest time with which a load step takes the level to this deviation [s].

    A load step that would at first move the level at the rate r moves it, under the settings
    of `arrest_settings` with λ = 1/ω and c as there, by::

        y(t) = r/(c λ²) · e^(−ζ t/λ) sin(√(1 − ζ²) t/λ) λ/√(1 − ζ²)

    It is arrested at t = λ a, with the deviation r e^(−ζ a)/(c λ), a = arccos ζ/√(1 − ζ²). With
    damping ζ = 1 that is t = λ, and without delay r λ/e: of a tank with the area A that a flow
    step ΔF fills, ΔF λ/(e A). The outflow then changes at first by r · 2 ζ/λ, for ζ ≥ 1/2 its
    fastest change: 2 ζ e^(−ζ a) ΔF²/(A y), 0.74 ΔF²/(A y) with ζ = 1 and 0.55 with ζ = 1/2. No
    controller does better than 1/2, which takes a ramp.

    Parameters
    ----------
    model : DelayedLags
        From the input to the level.
    deviation : float
        Allowed [output unit].
    load_rate : float
        r, its size [output unit/s].
    damping : float
        ζ of the placed poles, above 0 and at most 1.

    Raises
    ------
    NotApplicable
        The deviation is reached within the delay, or the level settles within it by itself.

    References
    ----------
    The idea is that of T. Olsen and W. L. Bialkowski, Lambda tuning as a promising controller
    tuning method for the refinery, AIChE Spring National Meeting, 2002; the formulas are
    derived here from the placed poles. T.-F. Cheung and W. L. Luyben, Industrial & Engineering
    Chemistry Fundamentals 18(1), 1979, 15-21, chart the same two quantities over the damping; the
    ramp is that of K. A. McDonald, T. J. McAvoy and A. Tits, AIChE Journal 32(1), 1986, 75-86.

    Examples
    --------
    A load that moves a level by 1 mm/s, and 20 cm of room: λ = e · 0.2 m/(1 mm/s).

    >>> round(arrest_time_for(DelayedLags(0.01, math.inf, 0.0), 0.2, 0.001) / math.e, 9)
    200.0
    """
    delay, turns = model.delay, _turns(damping)
    fastest = math.exp(damping * turns)
    span = fastest * deviation * (1.0 + delay / model.time_constant) / load_rate
    doubled = span - 2.0 * damping * delay
    inside = doubled**2 - (2.0 * delay) ** 2
    if doubled < 0.0 or inside < 0.0:
        raise NotApplicable(
            "its load uses up the allowed deviation within "
            f"{time_text(deviation / load_rate)}, too short beside a delay of {time_text(delay)}"
        )
    return 0.5 * (doubled + math.sqrt(inside)) * turns


def arrest_settings(model: DelayedLags, arrest_time: float, damping: float = 1.0) -> PidSettings:
    """Return the PI settings with which a load step is arrested after this time.

    The poles of the loop are placed at s² + 2 ζ s/λ + 1/λ² = 0, with the delay as 1 − θs::

        K/Ti = c/k',  c = (1 + θ/τ)/(λ² + 2 ζ λ θ + θ²)
        K = (c (2 ζ λ + θ) − 1/τ)/k'

    For τ → ∞ and ζ = 1 it is lambda tuning for an integrating level.

    Parameters
    ----------
    model : DelayedLags
        An integrator, or a level so slow that λ is below about 2 τ.
    arrest_time : float
        λ arccos ζ/√(1 − ζ²), with damping 1 it is λ [s].
    damping : float
        ζ, above 0 and at most 1.

    Raises
    ------
    NotApplicable
        The level settles by itself faster than the loop is to arrest it: K would be zero or
        have the wrong sign.

    References
    ----------
    As for `arrest_time_for`.

    Examples
    --------
    >>> arrest_settings(DelayedLags(0.01, math.inf, 0.0), 100.0)
    PidSettings(gain=2.0, integral_time=200.0, derivative_time=0.0)
    """
    delay, period = model.delay, arrest_time / _turns(damping)
    placed = period**2 + 2.0 * damping * period * delay + delay**2
    integral = (1.0 + delay / model.time_constant) / placed
    proportional = integral * (2.0 * damping * period + delay) - 1.0 / model.time_constant
    if proportional <= 0.0:
        raise NotApplicable(
            "the level does not integrate: it settles by itself with a time constant of "
            f"{time_text(model.time_constant)}, and an arrest time of {time_text(arrest_time)} is "
            "slower"
        )
    return PidSettings(proportional / model.slope, proportional / integral)


def _turns(damping: float) -> float:
    """Return arccos ζ/√(1 − ζ²), the arrest time over 1/ω."""
    root = math.sqrt(1.0 - damping**2)
    return math.acos(damping) / root if root > 0.0 else 1.0


@design(
    "arrest_time",
    "PI that averages, by its arrest time",
    Studied(10, "PI, arrest time"),
    keys=(
        number("arrest_time", "a time", "arrest time of all loops", unit="s", example='"5 min"'),
        one_deviation(
            "deviation", "how far levels may move at the load steps that the process names"
        ),
        number("damping", "a damping", "ζ of the loop, 1 if left out", high=1.0, example="0.7"),
    ),
    method=METHOD,
)
def design_arrest_time(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    arrest_time: float | None = None,
    deviation: float | None = None,
    damping: float = 1.0,
) -> Controller:
    """Design PI controllers that let levels move, so that the flows behind them hardly do.

    Of each pair every load step that the process names, taken alone, is arrested before the level
    has used the allowed deviation; the worst decides, by its size and its direction. Without a
    given deviation a level with a band may go to its ends, another as far either way as to the
    nearest of the ends of the measurement's range, floor, rim and level switch, less a margin
    (`averaging_room`). A tank whose walls are not upright is taken with the smallest surface that
    it has there. Loops whose sensitivity peak together is above 2 are slowed down, which an arrest
    time given by the user is not.

    Parameters
    ----------
    arrest_time : float, optional
        λ of all loops [s].
    deviation : float, optional
        Allowed for every load step, of all loops [output unit].
    damping : float
        ζ of all loops. Less of it lessens the fastest change of the flow, to three quarters at
        ζ = 1/2, and lets level and flow swing.

    Raises
    ------
    NotApplicable
        An output is no level, a level settles by itself too soon, there is no load step or no
        room, an element has no first-order model, the loops are unstable together, or a setting
        is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form is
        not PI, a number is not above zero, the damping is above 1, or both arrest time and
        deviation are given.

    References
    ----------
    As for `arrest_time_for`.

    Examples
    --------
    A basin of 1000 m², 5 m deep and half full, and a load step of 0.12 m³/s. There is room for
    40 % of the range, 2 m: λ = e · 2 m/(0.12 mm/s) less a sampling period of 60 s.

    >>> import clepsydra as cl
    >>> analysis = cl.load("equalisation-tank").analysis
    >>> controller = design_arrest_time(analysis.model, analysis.pairing)
    >>> round(math.e * 2.0 / 0.12e-3), controller.notes[0][-22:]
    (45305, 'arrested after 12.6 h.')
    """
    form = pi_only(form)
    if arrest_time is not None and deviation is not None:
        expected, remedy = "either an arrest time or a deviation", "leave one of them out"
        raise InputError(
            "arrest_time", arrest_time, expected, f"{remedy}: each follows from the other"
        )
    together = MultiloopPid(model, pairing, form, METHOD)
    found = together.each(
        lambda loop: _averaging(together, model, loop, arrest_time, deviation, damping)
    )
    settings = [setting for setting, _ in found]
    notes = [f"{by_pair(together.loops, [said for _, said in found])}."]
    if arrest_time is None:
        tuned = together.detuned(settings)
        if tuned.factor > 1.0:
            notes.append(
                f"The loops were slowed down {tuned.factor:.3g} times, so that together they keep "
                f"a sensitivity peak of {SENSITIVITY_LIMIT:g}: the levels move further."
            )
    else:
        tuned = together.as_given(settings, f"an arrest time of {arrest_time:g} s")
        notes += note_on_peak(tuned.peak, "choose a longer arrest time")
    return together.controller(tuned, _SOURCE, notes)


def _averaging(
    together: MultiloopPid,
    model: LinearModel,
    loop: PairedLoop,
    arrest_time: float | None,
    deviation: float | None,
    damping: float,
) -> tuple[PidSettings, str]:
    """Return the settings of one loop, and where they come from in words."""
    process, output = together.process, loop.output
    if not is_level(process, output.name):
        raise NotApplicable(f"{output.name} is no level: nobody lets it drift")
    reduced = half_rule(loop.element, together.delay)
    if arrest_time is not None:
        words = f"load steps are arrested after {time_text(arrest_time)}"
        return arrest_settings(reduced, arrest_time, damping), words
    banded = output.name in process.bands
    others = [u for u in model.inputs if u != loop.input.name] if banded else []
    loads = load_steps(model, output.name, others)
    room = averaging_room(together.point, output)
    if deviation is not None:
        room = Room(deviation, deviation)
    # How far a level then moves the other way, over its deviation.
    root = math.sqrt(1.0 - damping**2)
    back = math.exp(-math.pi * damping / root) if root > 0.0 else 0.0
    load = max(loads, key=lambda each: abs(each.rate) / room.against(each.rate, back))
    allowed = room.against(load.rate, back)
    area = smallest_area(together.point, output, room)
    narrow = replace(
        reduced, slope=reduced.slope / area, time_constant=reduced.time_constant * area
    )
    time = arrest_time_for(narrow, allowed, abs(load.rate) / area, damping)
    size = in_shown_unit(process.signal(load.signal), load.size)
    return arrest_settings(narrow, time, damping), (
        f"a load step of {load.signal} by {size} may move it by {in_shown_unit(output, allowed)} "
        f"and is arrested after {time_text(time)}"
    )
