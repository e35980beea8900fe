"""LQI with weights by Bryson's rule."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY, lqi_law
from clepsydra.design.applicability import NotApplicable, check_designed
from clepsydra.design.control_authority import DESIGN_STEP, check_ranges, control_authority
from clepsydra.design.linear_quadratic import METHOD, LqiGains, lqi_gains
from clepsydra.design.request import positive_number
from clepsydra.design.sampled_loop import sampled_loop
from clepsydra.design.sampling_period import check_sampling_period
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.poles import origin_radius, time_constants
from clepsydra.linear.zeros import zeros
from clepsydra.process.process import Process


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
    The gains are optimal for the process held over each sampling period
    (`design.linear_quadratic`), however long that is.

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
    anti_windup : {"back_calculation", "conditional_integration"}

    Returns
    -------
    Controller
        All states' measurements in the order of the states.

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
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> controller = design_lqi(analyse(load_process("quadruple-tank")).model)
    >>> round(controller.values["integral_gain_1_1"], 3)
    0.093
    """
    period = check_sampling_period(model)
    if model.delays is not None:
        raise NotApplicable(
            METHOD,
            "the process has dead time, and its law has no states for what is on its way",
        )
    point = operating_point_of(model)
    process = point.process
    if len(model.inputs) > len(model.outputs):
        # With more inputs, integrals that differ without effect would never settle.
        raise NotApplicable(
            METHOD,
            f"{len(model.inputs)} inputs move {len(model.outputs)} controlled outputs, and it "
            "integrates one error for each input",
        )
    check_ranges(process, model.outputs, model.inputs, METHOD)
    measurements = _measurements_of_states(process, model)
    errors = _deviations("maximum_errors", maximum_errors, _default_errors(process, model.outputs))
    moves = _deviations(
        "maximum_moves", maximum_moves, _default_moves(process, model.inputs, point.as_dict())
    )
    horizon = _horizon(model)
    gains = lqi_gains(
        model,
        np.array(list(errors.values())),
        np.array(list(moves.values())),
        horizon,
        period,
    )
    measured = _with_outputs(model, measurements)
    # The law sees measurements: F x = (F M⁻¹) y where y = M x.
    feedback = np.linalg.solve(measured.C.T, gains.feedback.T).T
    controller = _controller(
        measured, model.outputs, gains._replace(feedback=feedback), horizon, anti_windup
    )
    peak = sampled_loop(controller, measured).maximum_sensitivity
    if math.isinf(peak):
        raise NotApplicable(
            METHOD,
            "the sampled loop with its gains is unstable: they cannot be computed well enough "
            f"at a sampling period of {period:g} s",
        )
    slowest = _slowest_time_constant(gains.eigenvalues, period)
    return dataclasses.replace(
        controller,
        design=(
            f"LQI with Bryson's weights, {_in_words(process, errors | moves)}, an error lasting "
            f"at most {horizon:.3g} s; slowest closed-loop time constant {slowest:.3g} s, "
            f"sensitivity peak {peak:.2f}."
        ),
    )


def _controller(
    measured: LinearModel,
    outputs: tuple[str, ...],
    gains: LqiGains,
    horizon: float,
    anti_windup: AntiWindup,
) -> Controller:
    """Return the controller with gains for the measurements, at rest at the operating point."""
    point = operating_point_of(measured)
    process, at = point.process, point.as_dict()
    measurements = measured.outputs
    controlled = [measurements.index(name) + 1 for name in outputs]
    law = lqi_law(
        len(measurements),
        len(measured.inputs),
        controlled,
        anti_windup,
        measured=[process.signal(name) for name in measurements],
        manipulated=[process.signal(name) for name in measured.inputs],
    )
    values = {f"reference_measurement_{j}": at[name] for j, name in enumerate(measurements, 1)}
    initial_state: dict[str, float] = {}
    for i, name in enumerate(measured.inputs, start=1):
        signal, row, integral = process.signal(name), gains.feedback[i - 1], gains.integral[i - 1]
        values |= {f"feedback_{i}_{j}": float(value) for j, value in enumerate(row, start=1)}
        values |= {
            f"integral_gain_{i}_{j}": float(value) for j, value in enumerate(integral, start=1)
        }
        values |= {
            f"bias_{i}": at[name],
            f"low_limit_{i}": signal.low,
            f"high_limit_{i}": signal.high,
        }
        if anti_windup == "back_calculation":
            values[f"tracking_time_{i}"] = _tracking_time(row, integral, controlled, horizon)
        initial_state |= {f"integral_{i}": 0.0, f"last_output_{i}": at[name]}
    check_designed(law, values, METHOD)
    return Controller(
        name="LQI, Bryson",
        family=FAMILY,
        design="",
        law=law,
        values=values,
        initial_state=initial_state,
        measurements=measurements,
        setpoints=outputs,
        manipulated=measured.inputs,
        notes=(
            f"Needs {len(measurements)} sensors: {', '.join(measurements)}; a fault of any of "
            "them holds every output.",
        ),
    )


def _with_outputs(model: LinearModel, measurements: tuple[str, ...]) -> LinearModel:
    """Return the model with other measurements of its process as outputs."""
    shown = linearise(operating_point_of(model)).select(outputs=measurements)
    columns = [shown.states.index(name) for name in model.states]
    no_feedthrough = np.zeros((len(measurements), len(model.inputs)))
    return dataclasses.replace(model, C=shown.C[:, columns], D=no_feedthrough, outputs=measurements)


def _measurements_of_states(process: Process, model: LinearModel) -> tuple[str, ...]:
    chosen = []
    for state in model.states:
        # Where two sensors show a state, the one that is controlled is meant.
        showing = [name for name, shown in process.measured_state.items() if shown == state]
        if not showing:
            raise NotApplicable(METHOD, f"{state} is not measured, and it needs every state")
        chosen.append(next((name for name in showing if name in model.outputs), showing[0]))
    for name in model.outputs:
        if name not in chosen:
            raise NotApplicable(METHOD, f"{name} shows a state that another sensor shows too")
    return tuple(chosen)


def _horizon(model: LinearModel) -> float:
    """Return the time for which a largest error may last [s]."""
    times = [float(time) for time in time_constants(model) if math.isfinite(time) and time > 0.0]
    radius = origin_radius(model.A)
    inverse = [1.0 / abs(zero) for zero in zeros(model) if zero.real > radius]
    if not times and not inverse:
        raise NotApplicable(METHOD, "the model has no time constant to scale the weights with")
    return max(max(times, default=0.0) / 3.0, max(inverse, default=0.0))


def _default_errors(process: Process, names: tuple[str, ...]) -> dict[str, float]:
    return {name: DESIGN_STEP * process.signal(name).span for name in names}


def _default_moves(
    process: Process, names: tuple[str, ...], at: Mapping[str, float]
) -> dict[str, float]:
    return {name: control_authority(process.signal(name), at[name]) for name in names}


def _deviations(
    what: str, given: Mapping[str, float] | None, default: dict[str, float]
) -> dict[str, float]:
    """Return the default deviations with those that were given in their place, checked."""
    place = f"{METHOD}, {what}"
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


def _tracking_time(
    feedback: np.ndarray, integral: np.ndarray, controlled: list[int], horizon: float
) -> float:
    """Return proportional over integral gain of the controlled outputs, a PI's Ti."""
    proportional = np.linalg.norm([feedback[number - 1] for number in controlled])
    size = np.linalg.norm(integral)
    # An input that the integrators do not move cannot wind up: any time will do.
    return float(proportional / size) if size > 0.0 and proportional > 0.0 else horizon


def _in_words(process: Process, deviations: Mapping[str, float]) -> str:
    parts = [
        f"{name} {value:.3g} {process.signal(name).unit}" for name, value in deviations.items()
    ]
    return "largest acceptable deviations " + ", ".join(parts)


def _slowest_time_constant(eigenvalues: np.ndarray, period: float) -> float:
    """Return the time in which the slowest mode shrinks to 1/e [s]."""
    largest = float(np.max(np.abs(eigenvalues)))
    return -period / math.log(largest) if largest > 0.0 else 0.0
