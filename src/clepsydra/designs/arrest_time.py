"""PI controllers of averaging levels by arrest time: as slow as the vessel allows."""

from __future__ import annotations

import math
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import NotApplicable, reasons_about
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.arguments.of_process import one_deviation
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.averaging_room import averaging_room, is_level, largest_load
from clepsydra.designs.loops.multiloop import MultiloopPid, PairedLoop, pi_only
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.loops.pid_settings import PidSettings, slowed_down
from clepsydra.designs.models.first_order_delay import FirstOrderDelay, half_rule
from clepsydra.designs.request import in_shown_unit, positive_number
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, note_on_peak
from clepsydra.linear.linear_model import LinearModel

METHOD = "arrest time"
_SOURCE = "Arrest time, critically damped (Bialkowski; Olsen and Bialkowski 2002)"


def arrest_time_for(model: FirstOrderDelay, deviation: float, load_rate: float) -> float:
    """Return the arrest time λ with which a load step takes the level to this deviation [s].

    A load step that would at first move the level at the rate r moves it, under the settings
    of `arrest_settings`, by y(t) = (r/c) t/λ² e^(−t/λ) with c = (1 + θ/τ)/(λ + θ)². It is
    arrested at t = λ, with the deviation r (λ + θ)²/((1 + θ/τ) λ e); without delay that is
    r λ/e.

    Parameters
    ----------
    model : FirstOrderDelay
        From the input to the level.
    deviation : float
        Allowed [output unit].
    load_rate : float
        r, its size [output unit/s].

    Raises
    ------
    NotApplicable
        The deviation is reached within the delay, or the level settles within it by itself.

    References
    ----------
    The idea is that of T. Olsen and W. L. Bialkowski, Lambda tuning as a promising controller
    tuning method for the refinery, AIChE Spring National Meeting, 2002; the formulas are
    derived here from the placed poles.

    Examples
    --------
    A load that moves a level by 1 mm/s, and 20 cm of room: λ = e · 0.2 m/(1 mm/s).

    >>> round(arrest_time_for(FirstOrderDelay(0.01, math.inf, 0.0), 0.2, 0.001) / math.e, 9)
    200.0
    """
    delay = model.delay
    span = math.e * deviation * (1.0 + delay / model.time_constant) / load_rate
    inside = span * (span - 4.0 * delay)
    if inside < 0.0:
        raise NotApplicable(
            METHOD,
            f"its load uses up the allowed deviation of {deviation:.3g} within "
            f"{time_text(deviation / load_rate)}, too short beside a delay of {time_text(delay)}",
        )
    return 0.5 * (span - 2.0 * delay + math.sqrt(inside))


def arrest_settings(model: FirstOrderDelay, arrest_time: float) -> PidSettings:
    """Return the PI settings with which a load step is arrested after this time, damping 1.

    Both poles of the loop are placed at −1/λ, with the delay as 1 − θs::

        K/Ti = c/k',  c = (1 + θ/τ)/(λ + θ)²
        K = (c (2 λ + θ) − 1/τ)/k'

    For τ → ∞ it is lambda tuning for an integrating level.

    Parameters
    ----------
    model : FirstOrderDelay
        An integrator, or a level so slow that λ is below about 2 τ.
    arrest_time : float
        λ [s]

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
    >>> arrest_settings(FirstOrderDelay(0.01, math.inf, 0.0), 100.0)
    PidSettings(gain=2.0, integral_time=200.0, derivative_time=0.0)
    """
    delay = model.delay
    integral = (1.0 + delay / model.time_constant) / (arrest_time + delay) ** 2
    proportional = integral * (2.0 * arrest_time + delay) - 1.0 / model.time_constant
    if proportional <= 0.0:
        raise NotApplicable(
            METHOD,
            "the level does not integrate: it settles by itself with a time constant of "
            f"{time_text(model.time_constant)}, and an arrest time of {time_text(arrest_time)} is "
            "slower",
        )
    return PidSettings(proportional / model.slope, proportional / integral)


class _Averaging(NamedTuple):
    """One loop: its settings, and where they come from in words."""

    settings: PidSettings
    words: str


@design(
    "arrest_time",
    "PI that averages, by its arrest time",
    Studied(10, "PI, arrest time"),
    keys=(
        number("arrest_time", "a time", "arrest time of all loops", unit="s", example='"5 min"'),
        one_deviation(
            "deviation", "how far levels may move at the load steps that the process names"
        ),
    ),
)
def design_arrest_time(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    arrest_time: float | None = None,
    deviation: float | None = None,
) -> Controller:
    """Design PI controllers that let levels move, so that the flows behind them hardly do.

    Of each pair the largest load step that the process names, taken alone, is arrested when the
    level has used the allowed deviation. Without a given one that is the way to the nearest end
    of the measurement's range, floor, rim or level switch, less a margin of a tenth of the
    range. Loops whose sensitivity peak together is above 2 are slowed down, which an arrest
    time given by the user is not.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input), or mapping, optional
        The one that the relative gains suggest if left out.
        The outputs are levels or volumes.
    form : PidForm, optional
        PI in ISA form if left out.
    arrest_time : float, optional
        λ of all loops [s].
    deviation : float, optional
        Allowed for every load step, of all loops [output unit].

    Returns
    -------
    Controller
        Loop i for the i-th pair.

    Raises
    ------
    NotApplicable
        An output is no level, a level settles by itself too soon, there is no load step or no
        room, an element has no first-order model, the loops are unstable together, or a setting
        is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the form is
        not PI, a number is not above zero, or both numbers are given.

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
    form = pi_only(form, METHOD)
    _check(arrest_time, deviation)
    together = MultiloopPid(model, pairing, form, METHOD)
    loops = []
    for loop in together.loops:
        with reasons_about(loop.pair):
            loops.append(_averaging(together, model, loop, arrest_time, deviation))
    settings = [loop.settings for loop in loops]
    words = "; ".join(
        f"{paired.pair}: {loop.words}" for paired, loop in zip(together.loops, loops, strict=True)
    )
    notes = [f"{words}."]
    if arrest_time is None:
        found = together.detuned(lambda factor: slowed_down(settings, factor))
        if found.factor > 1.0:
            notes.append(
                f"The loops were slowed down {found.factor:.3g} times, so that together they keep "
                f"a sensitivity peak of {SENSITIVITY_LIMIT:g}: the levels move further."
            )
    else:
        found = together.as_given(settings, f"an arrest time of {arrest_time:g} s")
        notes += note_on_peak(found.peak, "choose a longer arrest time")
    return together.controller(found, _SOURCE, notes)


def _averaging(
    together: MultiloopPid,
    model: LinearModel,
    loop: PairedLoop,
    arrest_time: float | None,
    deviation: float | None,
) -> _Averaging:
    process = together.process
    if not is_level(process, loop.output.name):
        raise NotApplicable(METHOD, f"{loop.output.name} is no level: nobody lets it drift")
    reduced = half_rule(loop.element, process.sampling_period / 2.0, method=METHOD)
    if arrest_time is not None:
        return _Averaging(
            arrest_settings(reduced, arrest_time),
            f"load steps are arrested after {time_text(arrest_time)}",
        )
    load = largest_load(model, loop.output.name, METHOD)
    room = deviation or averaging_room(together.point, loop.output, METHOD)
    time = arrest_time_for(reduced, room, load.rate)
    return _Averaging(
        arrest_settings(reduced, time),
        f"a load step of {load.signal} by "
        f"{in_shown_unit(process.signal(load.signal), load.size)} is let use "
        f"{in_shown_unit(loop.output, room)} and is arrested after {time_text(time)}",
    )


def _check(arrest_time: float | None, deviation: float | None) -> None:
    if arrest_time is not None:
        positive_number(f"{METHOD}, arrest_time", arrest_time, "a time above 0 s", "give seconds")
    if deviation is not None:
        positive_number(
            f"{METHOD}, deviation", deviation, "a deviation above 0", "give it in the output's unit"
        )
    if arrest_time is not None and deviation is not None:
        raise InputError(
            f"{METHOD}, arrest_time",
            arrest_time,
            "either an arrest time or a deviation",
            "leave one of them out: each follows from the other",
        )
