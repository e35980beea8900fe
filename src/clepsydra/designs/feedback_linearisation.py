"""Feedback linearisation: decoupled outputs, after a look at what they do not show."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache, partial

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.feedback_linearisation import (
    FAMILY,
    LinearisedProcess,
    feedback_linearisation_law,
)
from clepsydra.controllers.observers.observer import ModelObserver
from clepsydra.controllers.parameters import remembered_parameters
from clepsydra.controllers.virtual_input import (
    AlphaOn,
    VirtualAntiWindup,
)
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import Studied, design
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.loops.control_authority import check_ranges, control_authorities
from clepsydra.designs.saturation_rate import rates_in_words, saturation_rates
from clepsydra.designs.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.model_observer import model_observer, note_on_observer
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.designs.virtual_settings import (
    ARGUMENTS,
    VirtualSettings,
    checked_settings,
    settings_for,
    settling_time,
)
from clepsydra.linear.control_authority import DESIGN_STEP
from clepsydra.linear.internal_dynamics import internal_dynamics
from clepsydra.linear.lie_derivatives import NotLinearisable
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.relative_degree import VectorRelativeDegree, relative_degree

NAME = "Feedback linearisation"
#: No effect is divided by that is less than this share of what it is at the operating point.
SMALLEST_EFFECT = 1e-3


# Its equations do not depend on the settings, of which a search tries several.
_law = lru_cache(maxsize=8)(feedback_linearisation_law)


@design(
    "feedback_linearisation",
    "feedback linearisation",
    Studied(250, "Feedback linearisation"),
    keys=ARGUMENTS,
)
def design_feedback_linearisation(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    closed_loop_time_constant: float | None = None,
    settings: Sequence[VirtualSettings] | None = None,
    anti_windup: VirtualAntiWindup = "variable_structure",
    alpha: float | Sequence[float] | None = None,
    alpha_on: AlphaOn = "virtual",
    despite_unstable_internal_dynamics: bool = False,
) -> Controller:
    """Design feedback linearisation of a process, with a PI controller for each output.

    First the internal dynamics are looked at: what goes on while the outputs are held. The
    decoupling matrix may be regular and they unstable all the same; then the controller would
    hold the outputs until a tank overflows or an input saturates, and it is refused.

    Each output then follows as 1/(τ s + 1)^r, with the shortest τ at which a setpoint step of a
    tenth of the range does not saturate an input, lengthened until the sampled loop has a
    sensitivity peak of at most 2. Where the law needs a state that no sensor shows, or the
    measurements are chosen, an observer runs the equations of the process beside it, corrected
    by the gain of a Kalman filter (`designs.kalman`).

    Parameters
    ----------
    measurements : sequence of str, optional
        What an observer reads, with the controlled outputs among them; by default none is
        needed where every state that the law needs is measured.
    closed_loop_time_constant : float, optional
        τ of every output [s].
    settings : sequence of VirtualSettings, optional
        In place of τ, one for each output.
    anti_windup, alpha_on
        As for `feedback_linearisation_law`.
    alpha : float or sequence of float, optional
        α of the variable structure [1/s], or with ``alpha_on="input"`` [unit of d^r y/dt^r per
        unit of the input and second]; by its rule if left out.
    despite_unstable_internal_dynamics : bool
        For a demonstration of what happens.

    Raises
    ------
    NotApplicable
        There is no relative degree, the internal dynamics are unstable, a state can neither be
        measured nor estimated, or no slowing down makes the loop robust.
    InputError
        The model has no operating point, a name is unknown, a number is not above zero, an
        integral gain is not, settings do not come to rest, or α is outside of its rule.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, chapter 5,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> design_feedback_linearisation(model).measurements
    ('level_1', 'level_2', 'level_3', 'level_4')
    >>> model = cl.load("quadruple-tank-nonminimum-phase").linear
    >>> design_feedback_linearisation(model)
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: feedback linearisation is not applicable: \
while level_1 and level_2 are held, tank_3.level and tank_4.level run away, e times as far \
every 78.4 s (a zero at +0.0128 rad/s).
    """
    process = operating_point_of(model).process
    check_ranges(process, model.outputs, model.inputs)
    try:
        linearised = relative_degree(model)
    except NotLinearisable as refusal:
        raise NotApplicable(
            f"{refusal.place} ({refusal.value}): it needs {refusal.expected}; {refusal.remedy}"
        ) from None
    internal = internal_dynamics(model)
    if not internal.stable and not despite_unstable_internal_dynamics:
        raise NotApplicable(internal.words)
    observer, correction = _observer(model, linearised, measurements)
    designed = partial(
        feedback_linearisation_controller,
        model,
        linearised,
        anti_windup=anti_windup,
        alpha_on=alpha_on,
        observer=observer,
        correction=correction,
    )
    rates, slowed, notes = [1.0] * len(model.outputs), 1.0, tuple[str, ...]()
    if settings is not None:
        chosen = checked_settings(settings, model.outputs, linearised.degrees)
        words = "settings as given"
    else:
        times = _shortest_times(linearised)
        if closed_loop_time_constant is not None:
            times = [float(closed_loop_time_constant)] * len(times)
        elif internal.stable:
            found = slow_down(
                lambda factor: designed(_settings(times, linearised, factor), rates=rates),
                lambda each: sensitivity_peak(each, model),
            )
            slowed, notes = found.factor, note_on_slowing(found, "every output")
        chosen = _settings(times, linearised, slowed)
        words = "time constants " + ", ".join(
            f"{time_text(slowed * time)} of {name}"
            for time, name in zip(times, model.outputs, strict=True)
        )
    controller = designed(chosen, rates=rates)
    if internal.stable and math.isinf(sensitivity_peak(controller, model)):
        raise NotApplicable(f"the sampled loop is unstable with {words}")
    if anti_windup == "variable_structure":
        rates, said = _rates(chosen, linearised, alpha, alpha_on)
        words += said
    found_words = internal.words if internal.stable else f"Unstable: {internal.words}."
    pairs = zip(linearised.degrees, model.outputs, strict=True)
    degrees = ", ".join(f"{degree} of {name}" for degree, name in pairs)
    return designed(chosen, rates=rates).described(
        f"Input-output linearisation, relative degree {degrees}; {words}.",
        (found_words, *_notes(linearised, observer, controller), *notes),
        slowed,
    )


def feedback_linearisation_controller(
    model: LinearModel,
    linearised: VectorRelativeDegree,
    settings: Sequence[VirtualSettings],
    *,
    anti_windup: VirtualAntiWindup,
    rates: Sequence[float],
    alpha_on: AlphaOn = "virtual",
    observer: ModelObserver | None = None,
    correction: np.ndarray | None = None,
) -> Controller:
    """Return a controller with these settings at rest at the operating point, judged by no rule.

    Parameters
    ----------
    linearised : VectorRelativeDegree
        Of the model.
    settings : sequence of VirtualSettings
        One for each output.
    anti_windup, alpha_on
        As for `feedback_linearisation_law`.
    rates : sequence of float
        α of each output; with back-calculation 1/Tt [1/s].
    correction : ndarray, optional
        M of the observer.

    Raises
    ------
    NotApplicable
        A state is neither measured nor estimated, or a number is outside of what a controller
        takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> controller = feedback_linearisation_controller(
    ...     model, relative_degree(model), [settings_for(30.0, 3)], anti_windup="none", rates=[1])
    >>> round(controller.values["level_3.virtual_integral_gain"] * 30**4, 5)
    1.0
    """
    point = operating_point_of(model)
    at = point.as_dict()
    try:
        law = _law(linearised, anti_windup=anti_windup, alpha_on=alpha_on, observer=observer)
    except InputError as refusal:
        raise NotApplicable(
            f"{refusal.value} is neither measured nor estimated; {refusal.remedy}"
        ) from None
    alphas = np.array(rates)
    values = numbers_at(
        point,
        law.parameters,
        virtual_gain=[chosen.gain for chosen in settings],
        virtual_integral_gain=[chosen.integral_gain for chosen in settings],
        setpoint_weight=[chosen.setpoint_weight for chosen in settings],
        virtual_damping=[share for chosen in settings for share in chosen.damping],
        smallest_effect=_smallest_pivots(linearised),
        saturation_rate=alphas,
        saturation_feedback=alphas,
        tracking_time=1.0 / alphas,
        correction=[] if correction is None else correction[correction != 0.0],
    )
    values = designed_values(law, values, point)
    # At rest ν is zero: the integral holds what the setpoint weight leaves.
    integrals = [
        values[path(y, "virtual_gain")] * (1.0 - values[path(y, "setpoint_weight")]) * at[y]
        for y in model.outputs
    ]
    estimates = [] if observer is None else [at[name] for name in observer.equations.states]
    state = numbers_at(
        point, law.state, virtual_integral=integrals, was_in_force=1.0, estimate=estimates
    )
    state |= remembered_parameters(law, values)
    return controller_at(point, NAME, FAMILY, law, values, state)


def _smallest_pivots(linearised: VectorRelativeDegree) -> list[float]:
    """Return the share of each pivot of the elimination below which nothing is divided."""
    left = linearised.at_point
    pivots = [0.0] * len(left)
    for step, (j, i) in enumerate(linearised.order):
        pivots[j] = SMALLEST_EFFECT * float(left[j, i])
        for other, _ in linearised.order[step + 1 :]:
            left[other] -= left[j] * (left[other, i] / left[j, i])
    return pivots


def _settings(
    times: Sequence[float], linearised: VectorRelativeDegree, factor: float
) -> list[VirtualSettings]:
    pairs = zip(times, linearised.degrees, strict=True)
    return [settings_for(factor * time, degree) for time, degree in pairs]


def _shortest_times(linearised: VectorRelativeDegree) -> list[float]:
    """Return τ at which a setpoint step of a tenth of the range just uses up an input [s].

    The step moves d^r y/dt^r by its size over τ^r at once.
    """
    point = linearised.equations.point
    inverse = np.linalg.inv(linearised.at_point)
    rooms = control_authorities(point, linearised.equations.inputs)
    times = []
    for j, name in enumerate(linearised.equations.outputs):
        step = DESIGN_STEP * point.process.signal(name).span
        used = float(np.max(np.abs(inverse[:, j]) * step / rooms))
        times.append(float(used ** (1.0 / linearised.degrees[j])))
    return times


def _observer(
    model: LinearModel, linearised: VectorRelativeDegree, measurements: Sequence[str] | None
) -> tuple[ModelObserver | None, np.ndarray | None]:
    if measurements is None:
        try:
            LinearisedProcess(linearised)
        except InputError:
            pass
        else:
            return None, None
    horizon = max(_shortest_times(linearised))
    return model_observer(model, linearised.equations, measurements, horizon)


def _rates(
    settings: Sequence[VirtualSettings],
    linearised: VectorRelativeDegree,
    alpha: float | Sequence[float] | None,
    alpha_on: AlphaOn,
) -> tuple[list[float], str]:
    """Return α of each output by its rule, in the quantity on which it acts, and in words."""
    names = linearised.equations.outputs
    settling = {
        name: settling_time(setting, degree)
        for name, setting, degree in zip(names, settings, linearised.degrees, strict=True)
    }
    effects, paired = np.abs(linearised.at_point), dict(linearised.order)
    # In the virtual input an excess of an input counts by its effect, and so must α.
    on_input = alpha_on == "input"
    scale = [float(effects[j, paired[j]]) if on_input else 1.0 for j in range(len(effects))]
    found = saturation_rates(settling, names, alpha, scale if on_input else None)
    rates = [rate * effect for rate, effect in zip(found, scale, strict=True)]
    return rates, f"; α {rates_in_words(found, settling, names)}"


def _notes(
    linearised: VectorRelativeDegree, observer: ModelObserver | None, controller: Controller
) -> tuple[str, ...]:
    process = linearised.equations.point.process
    sensors = ", ".join(controller.measurements)
    notes = [f"Needs the sensors {sensors}; a fault of any of them holds every output."]
    if observer is not None:
        notes.append(note_on_observer(observer))
    disturbing = (signal.name for signal in process.disturbances)
    loads = [name for name in disturbing if path("model", name) in controller.values]
    if loads:
        notes.append(f"Takes {', '.join(loads)} as constant; the integrals make up for the rest.")
    return tuple(notes)
