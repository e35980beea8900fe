"""LQI with weights by Bryson's rule."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.control_authority import DESIGN_STEP, check_ranges, control_authority
from clepsydra.designs.request import in_shown_unit, positive_number
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.states.linear_quadratic import METHOD, LqiGains, bryson_weights, lqi_gains
from clepsydra.designs.states.measured_states import measurements_of_states, with_outputs
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.designs.states.relevant_states import without_idle_states
from clepsydra.designs.states.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.state_controllers import lqi_controller, sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.pade import at_rest
from clepsydra.linear.poles import origin_radius, time_constants
from clepsydra.linear.zeros import zeros
from clepsydra.process.process import Process

NAME = "LQI, Bryson"


class Deviations(NamedTuple):
    """The largest acceptable deviations, and how long an error may last.

    Parameters
    ----------
    errors, moves : dict
        Output and input names to deviations [their units].
    horizon : float
        T [s]

    Examples
    --------
    >>> Deviations({"level": 0.1}, {"pump": 3.0}, 30.0).slower(2.0)
    Deviations(errors={'level': 0.1}, moves={'pump': 1.5}, horizon=60.0)
    """

    errors: dict[str, float]
    moves: dict[str, float]
    horizon: float

    def slower(self, factor: float) -> Deviations:
        """Return deviations that ask for less: smaller moves and a longer horizon."""
        moves = {name: value / factor for name, value in self.moves.items()}
        return Deviations(self.errors, moves, self.horizon * factor)

    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return errors and moves as arrays [q] and [m]."""
        return np.array(list(self.errors.values())), np.array(list(self.moves.values()))

    def in_words(self, process: Process) -> str:
        """Return them as the reader sees them."""
        parts = [
            f"{name} {in_shown_unit(process.signal(name), value)}"
            for name, value in (self.errors | self.moves).items()
        ]
        return f"largest acceptable deviations {', '.join(parts)}"


def design_lqi(
    model: LinearModel,
    *,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control with weights by Bryson's rule.

    The horizon T for which a largest error may last is a third of the slowest time constant
    of the model (a tank that integrates has none and is passed over), or 1/z of its slowest
    zero z in the right half-plane where that is longer: no controller removes an error sooner.
    Of a tank that only integrates it is the time in which the largest moves make the largest
    error. The gains are optimal for the process held over each sampling period
    (`designs.states.linear_quadratic`), however long that is. Where the sensitivity peak of the
    loop is above 2, moves are made smaller and the horizon longer by one factor until it is 2.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs follow the setpoints.
    maximum_errors : mapping, optional
        Output name to its largest acceptable error [measurement unit]; default a tenth of the
        range.
    maximum_moves : mapping, optional
        Input name to its largest acceptable deviation from the operating point [input unit];
        default the distance to the nearer limit.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
        With conditional integration it is input-constrained LQI.

    Returns
    -------
    Controller
        All states' measurements in the order of the states; states that act on no output are
        left out.

    Raises
    ------
    NotApplicable
        The process has dead time, a state is not measured, there are no stabilising gains, or
        one is outside of what a controller takes.
    InputError
        The model has no operating point, a mapping names an unknown signal, a deviation is
        not above zero, or the anti-windup is unknown.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_lqi(cl.load("quadruple-tank").linear)
    >>> round(controller.values["pump_1.integral_gain.level_1"], 3)
    0.093
    """
    return weighed_lqi(model, maximum_errors, maximum_moves, anti_windup).controller


class WeighedLqi(NamedTuple):
    """An LQI controller, and the weights that made it.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Whose states and inputs are weighed.
    weights : QuadraticWeights
    horizon : float
        T [s]

    Examples
    --------
    See `weighed_lqi`.
    """

    controller: Controller
    model: LinearModel
    weights: QuadraticWeights
    horizon: float


def weighed_lqi(
    model: LinearModel,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> WeighedLqi:
    """Return the controller of `design_lqi` with its weights, from where others may be tuned.

    Parameters
    ----------
    model, maximum_errors, maximum_moves, anti_windup
        As for `design_lqi`.

    Raises
    ------
    NotApplicable, InputError
        As `design_lqi`.

    Examples
    --------
    A tenth of the range of 0 to 10 V is an acceptable error, so that the output weighs 1/V²:

    >>> import clepsydra as cl
    >>> found = weighed_lqi(cl.load("quadruple-tank").linear)
    >>> found.weights.states.diagonal()  # C is 50 V/m
    array([2500., 2500.,    0.,    0.])
    """
    period = check_sampling_period(model)
    if model.delays is not None:
        raise NotApplicable(
            METHOD,
            "the process has dead time, and its law has no states for what is on its way; LQI "
            "with a Kalman filter has them",
        )
    process = operating_point_of(model).process
    refuse_more_inputs(model, METHOD)
    check_ranges(process, model.outputs, model.inputs, METHOD)
    model = without_idle_states(model)
    measurements = measurements_of_states(model, METHOD)
    deviations = acceptable_deviations(model, maximum_errors, maximum_moves, METHOD)
    measured = with_outputs(model, measurements)

    def designed(factor: float) -> tuple[Controller, LqiGains]:
        gains = _gains(model, deviations.slower(factor), period)
        # The law sees measurements: F x = (F M⁻¹) y where y = M x.
        feedback = np.linalg.solve(measured.C.T, gains.feedback.T).T
        times = tracking_times(model, measurements, feedback, gains, deviations.horizon * factor)
        controller = lqi_controller(
            NAME, model, measurements, feedback, gains.integral, times, anti_windup
        )
        return controller, gains

    if math.isinf(sensitivity_peak(designed(1.0)[0], model)):
        raise NotApplicable(
            METHOD,
            "the sampled loop with its gains is unstable: they cannot be computed well enough "
            f"at a sampling period of {period:g} s",
        )
    found = slow_down(designed, lambda design: sensitivity_peak(design[0], model), METHOD)
    controller, gains = found.design
    slowest = slowest_time_constant(gains.eigenvalues, period)
    asked = deviations.slower(found.factor)
    controller = dataclasses.replace(
        controller,
        design=(
            "LQI with Bryson's weights, "
            f"{asked.in_words(process)}, an error lasting at most {time_text(asked.horizon)}; "
            f"slowest closed-loop time constant {time_text(slowest)}, sensitivity peak "
            f"{found.peak:.2f}."
        ),
        notes=(*controller.notes, *note_on_slowing(found, "the regulator")),
        slowed=found.factor,
    )
    weights = bryson_weights(model, *asked.sizes(), asked.horizon)
    return WeighedLqi(controller, model, weights, asked.horizon)


def refuse_more_inputs(model: LinearModel, method: str) -> None:
    """Refuse more inputs than outputs: integrals that differ without effect never settle.

    Raises
    ------
    NotApplicable

    Examples
    --------
    >>> import clepsydra as cl
    >>> refuse_more_inputs(cl.load("quadruple-tank").linear, "LQI")
    """
    if len(model.inputs) > len(model.outputs):
        raise NotApplicable(
            method,
            f"{len(model.inputs)} inputs move {len(model.outputs)} controlled outputs, and it "
            "integrates one error for each input",
        )


def acceptable_deviations(
    model: LinearModel,
    maximum_errors: Mapping[str, float] | None,
    maximum_moves: Mapping[str, float] | None,
    method: str,
) -> Deviations:
    """Return Bryson's deviations: the default ones, with those that were given in their place.

    Parameters
    ----------
    model, maximum_errors, maximum_moves
        As for `design_lqi`.
    method : str
        For the message.

    Raises
    ------
    InputError
        A mapping names an unknown signal, or a deviation is not above zero.
    NotApplicable
        The model has nothing to tell a horizon from.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> acceptable_deviations(model, {"level_1": 0.5}, None, "LQI").errors
    {'level_1': 0.5, 'level_2': 1.0}
    """
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    errors = _given(
        f"{method}, maximum_errors",
        maximum_errors,
        {name: DESIGN_STEP * process.signal(name).span for name in model.outputs},
    )
    moves = _given(
        f"{method}, maximum_moves",
        maximum_moves,
        {name: control_authority(process.signal(name), at[name]) for name in model.inputs},
    )
    sizes = np.array(list(errors.values())), np.array(list(moves.values()))
    return Deviations(errors, moves, _horizon(model, *sizes, method))


def slowest_time_constant(eigenvalues: np.ndarray, period: float) -> float:
    """Return the time in which the slowest mode shrinks to 1/e [s].

    Examples
    --------
    >>> round(slowest_time_constant(np.array([0.5, math.exp(-0.1)]), 2.0), 9)
    20.0
    """
    largest = float(np.max(np.abs(eigenvalues), initial=0.0))
    return -period / math.log(largest) if largest > 0.0 else 0.0


def _gains(model: LinearModel, deviations: Deviations, period: float) -> LqiGains:
    return lqi_gains(model, *deviations.sizes(), deviations.horizon, period)


def _horizon(model: LinearModel, errors: np.ndarray, moves: np.ndarray, method: str) -> float:
    """Return the time for which a largest error may last [s]."""
    late = 0.0 if model.delays is None else float(model.delays.times.sum())
    model = at_rest(model)
    times = [float(time) for time in time_constants(model) if math.isfinite(time) and time > 0.0]
    radius = origin_radius(model.A)
    inverse = [1.0 / abs(zero) for zero in zeros(model) if zero.real > radius]
    if times or inverse or late:
        return max(max(times, default=0.0) / 3.0, max(inverse, default=0.0), late)
    rates = np.abs(model.C @ model.B) @ moves
    if not np.all(rates > 0.0):
        raise NotApplicable(method, "the model has no time constant to scale the weights with")
    return float(np.max(errors / rates))


def _given(
    place: str, given: Mapping[str, float] | None, default: dict[str, float]
) -> dict[str, float]:
    """Return the default deviations with those that were given in their place, checked."""
    if given is not None and not isinstance(given, Mapping):
        raise InputError(place, given, "names with numbers", "give a dictionary")
    for name, value in (given or {}).items():
        if name not in default:
            raise InputError(place, name, f"one of {', '.join(default)}", "correct the name")
        positive_number(
            f"{place}, {name}",
            value,
            f"a deviation above zero, as a number in the unit of {name}",
            "give its largest acceptable deviation",
        )
    return {name: float((given or {}).get(name, value)) for name, value in default.items()}


def tracking_times(
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    gains: LqiGains,
    horizon: float,
) -> list[float]:
    """Return proportional over integral gain of the controlled outputs, a PI's Ti [s].

    Parameters
    ----------
    model : LinearModel
    measurements : tuple of str
    feedback : ndarray [m, measurements]
        F of the measurements.
    gains : LqiGains
    horizon : float
        For an input that the integrators do not move [s].

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> tracking_times(tank, ("level",), 6.0 * one, LqiGains(6.0 * one, 2.0 * one, one[0]), 9.0)
    [3.0]
    """
    columns = [measurements.index(name) for name in model.outputs]
    times = []
    for row, integral in zip(feedback, gains.integral, strict=True):
        proportional, size = np.linalg.norm(row[columns]), np.linalg.norm(integral)
        # An input that the integrators do not move cannot wind up: any time will do.
        both = size > 0.0 and proportional > 0.0
        times.append(float(proportional / size) if both else horizon)
    return times
