"""LQI with weights by Bryson's rule."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY, lqi_law
from clepsydra.design.applicability import NotApplicable
from clepsydra.design.input_room import DESIGN_STEP, check_ranges, room
from clepsydra.design.linear_quadratic import METHOD, lqi_gains
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.poles import origin_radius, time_constants
from clepsydra.linear.zeros import zeros
from clepsydra.process.process import Process


def design_lqi(
    process: Process,
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

    Parameters
    ----------
    process : Process
    model : LinearModel
        With an operating point; its outputs follow the setpoints.
    maximum_errors : mapping, optional
        Output name to its largest acceptable error [measurement unit]; default a tenth of the
        range.
    maximum_moves : mapping, optional
        Input name to its largest acceptable deviation from the operating point [input unit];
        default the room to the nearer limit.
    anti_windup : {"back_calculation", "clamping"}

    Returns
    -------
    Controller
        All states' measurements in the order of the states.

    Raises
    ------
    NotApplicable
        A state is not measured, or there are no stabilising gains.
    InputError
        A mapping names an unknown signal, or a deviation is not above zero.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> analysis = analyse(process)
    >>> controller = design_lqi(process, analysis.model)
    >>> round(controller.values["integral_gain_1_1"], 3)
    0.099
    """
    if model.point is None:
        raise NotApplicable(METHOD, "the model does not come from an operating point")
    if len(model.inputs) > len(model.outputs):
        # With more inputs, integrals that differ without effect would never settle.
        raise NotApplicable(
            METHOD,
            f"{len(model.inputs)} inputs move {len(model.outputs)} controlled outputs, and it "
            "integrates one error for each input",
        )
    check_ranges(process, model.outputs, model.inputs, METHOD)
    at = model.point.as_dict()
    measurements = _measurements_of_states(process, model)
    _check_measured(model.outputs, measurements)
    errors = _deviations(
        "maximum_errors", maximum_errors, model.outputs, _default_errors(process, model.outputs)
    )
    moves = _deviations(
        "maximum_moves", maximum_moves, model.inputs, _default_moves(process, model.inputs, at)
    )
    horizon = _horizon(model)
    gains = lqi_gains(model, errors, moves, horizon)
    # The law sees measurements: F x = (F M⁻¹) y where y = M x.
    slopes = _sensor_slopes(process, model.point, model.states, measurements)
    feedback = np.linalg.solve(slopes.T, gains.feedback.T).T
    controlled = [measurements.index(name) + 1 for name in model.outputs]

    values: dict[str, float] = {}
    initial_state: dict[str, float] = {}
    for j, name in enumerate(measurements, start=1):
        values[f"reference_measurement_{j}"] = at[name]
    for i, name in enumerate(model.inputs, start=1):
        signal = process.signal(name)
        row, integral = feedback[i - 1], gains.integral[i - 1]
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
    slowest = gains.poles[np.argmax(gains.poles.real)]
    return Controller(
        name="LQI, Bryson",
        family=FAMILY,
        design=(
            f"LQI with Bryson's weights, {_in_words(process, model, errors, moves)}, an error "
            f"lasting at most {horizon:.3g} s; slowest closed-loop pole {_pole(slowest)} rad/s."
        ),
        law=lqi_law(
            len(measurements),
            len(model.inputs),
            controlled,
            anti_windup,
            measured=[process.signal(name) for name in measurements],
            manipulated=[process.signal(name) for name in model.inputs],
        ),
        values=values,
        initial_state=initial_state,
        measurements=measurements,
        setpoints=model.outputs,
        manipulated=model.inputs,
        notes=(
            f"Needs {len(measurements)} sensors: {', '.join(measurements)}; a fault of any of "
            "them holds every output.",
        ),
    )


def _measurements_of_states(process: Process, model: LinearModel) -> tuple[str, ...]:
    chosen = []
    for state in model.states:
        # Where two sensors show a state, the one that is controlled is meant.
        showing = [name for name, shown in process.measured_state.items() if shown == state]
        if not showing:
            raise NotApplicable(METHOD, f"{state} is not measured, and it needs every state")
        chosen.append(next((name for name in showing if name in model.outputs), showing[0]))
    return tuple(chosen)


def _check_measured(outputs: tuple[str, ...], measurements: tuple[str, ...]) -> None:
    for name in outputs:
        if name not in measurements:
            raise NotApplicable(METHOD, f"{name} shows a state that another sensor shows too")


def _horizon(model: LinearModel) -> float:
    """Return the time for which a largest error may last [s]."""
    times = [float(time) for time in time_constants(model) if math.isfinite(time) and time > 0.0]
    radius = origin_radius(model.A)
    inverse = [1.0 / abs(zero) for zero in zeros(model) if zero.real > radius]
    if not times and not inverse:
        raise NotApplicable(METHOD, "the model has no time constant to scale the weights with")
    return max(max(times, default=0.0) / 3.0, max(inverse, default=0.0))


def _default_errors(process: Process, names: tuple[str, ...]) -> dict[str, float]:
    signals = [process.signal(name) for name in names]
    return {signal.name: DESIGN_STEP * (signal.high - signal.low) for signal in signals}


def _default_moves(
    process: Process, names: tuple[str, ...], at: Mapping[str, float]
) -> dict[str, float]:
    signals = [process.signal(name) for name in names]
    return {signal.name: room(signal.low, signal.high, at[signal.name]) for signal in signals}


def _deviations(
    what: str, given: Mapping[str, float] | None, names: tuple[str, ...], default: dict[str, float]
) -> np.ndarray:
    unknown = sorted(set(given or {}) - set(names))
    if unknown:
        raise InputError(
            f"{METHOD}, {what}", unknown[0], f"one of {', '.join(names)}", "correct the name"
        )
    values = default | dict(given or {})
    for name in names:
        value = values[name]
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(
                f"{METHOD}, {what}, {name}",
                value,
                "a deviation above zero",
                "give its largest acceptable deviation",
            )
    return np.array([values[name] for name in names])


def _sensor_slopes(
    process: Process, point: OperatingPoint, states: Sequence[str], measurements: Sequence[str]
) -> np.ndarray:
    """Return M = ∂y/∂x of the chosen measurements at the operating point [n, n]."""
    state = ca.SX.sym("x", len(process.state))
    parameters = ca.SX.sym("p", len(process.parameters))
    slopes = ca.Function(
        "slopes",
        [state, parameters],
        [ca.densify(ca.jacobian(process.measure(state, parameters), state))],
    )(point.state, process.parameter_values)
    order = [signal.name for signal in process.measurements]
    levels = [signal.name for signal in process.state]
    rows = [order.index(name) for name in measurements]
    columns = [levels.index(name) for name in states]
    return np.array(slopes)[np.ix_(rows, columns)]


def _tracking_time(
    feedback: np.ndarray, integral: np.ndarray, controlled: list[int], horizon: float
) -> float:
    """Return proportional over integral gain of the controlled outputs, a PI's Ti."""
    proportional = np.linalg.norm([feedback[number - 1] for number in controlled])
    size = np.linalg.norm(integral)
    # An input that the integrators do not move cannot wind up: any time will do.
    return float(proportional / size) if size > 0.0 and proportional > 0.0 else horizon


def _in_words(process: Process, model: LinearModel, errors: np.ndarray, moves: np.ndarray) -> str:
    parts = [
        f"{name} {value:.3g} {process.signal(name).unit}"
        for name, value in zip((*model.outputs, *model.inputs), (*errors, *moves), strict=True)
    ]
    return "largest acceptable deviations " + ", ".join(parts)


def _pole(pole: complex) -> str:
    if abs(pole.imag) < 1e-9 * abs(pole):
        return f"{pole.real:.3g}"
    return f"{pole.real:.3g} ± {abs(pole.imag):.3g} j"
