"""Controllers made of feedback gains, at rest at the operating point."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY as LQI_FAMILY
from clepsydra.controllers.linear_quadratic_integral import lqi_law
from clepsydra.controllers.state_feedback import FAMILY as FEEDBACK_FAMILY
from clepsydra.controllers.state_feedback import state_feedback_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.sampled.sampled_process import NotSampled
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint


def lqi_controller(
    name: str,
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    integral: np.ndarray,
    tracking_times: Sequence[float],
    anti_windup: AntiWindup,
    estimation: Estimation | None = None,
) -> Controller:
    """Return an LQI controller with these gains.

    Parameters
    ----------
    name : str
    model : LinearModel
        Its outputs are controlled and its inputs manipulated.
    measurements : tuple of str
        With the outputs among them.
    feedback : ndarray [m, N]
        F of the measurements, or of what is estimated.
    integral : ndarray [m, q]
        G.
    tracking_times : sequence of float
        One for each input, for back-calculation [s].
    anti_windup : AntiWindup
    estimation : Estimation, optional

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> levels = ("level_1", "level_2", "level_3")
    >>> gains = 1e-4 * np.ones((1, 3)), 1e-6 * np.ones((1, 1))
    >>> controller = lqi_controller("LQI, by hand", model, levels, *gains, [60.0], "none")
    >>> controller.values["feed.feedback.level_2"], controller.setpoints
    (0.0001, ('level_3',))
    """
    point = operating_point_of(model)
    law = lqi_law(
        *_signals(model, measurements),
        model.outputs,
        anti_windup,
        observer=None if estimation is None else estimation.structure(),
    )
    values = _common_values(model, measurements, feedback, estimation)
    values |= matrix_values("integral_gain", model.inputs, model.outputs, integral)
    if anti_windup == "back_calculation":
        values |= parts_values("tracking_time", model.inputs, tracking_times)
    values = designed_values(law, values, point, name)
    return Controller(
        name=name,
        family=LQI_FAMILY,
        design="",
        law=law,
        values=values,
        initial_state=_at_rest(model, estimation),
        measurements=measurements,
        setpoints=model.outputs,
        manipulated=model.inputs,
        notes=_notes(model, measurements, estimation),
    )


def state_feedback_controller(
    name: str,
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    precompensator: np.ndarray,
    fading_time: float,
    estimation: Estimation | None = None,
) -> Controller:
    """Return a controller of state feedback with precompensator with these gains.

    Parameters
    ----------
    name, model, measurements, feedback, estimation
        As for `lqi_controller`.
    precompensator : ndarray [m, q]
        N.
    fading_time : float
        In which a bumpless start fades [s].

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> levels = ("level_1", "level_2", "level_3")
    >>> gains = 1e-4 * np.ones((1, 3)), 1e-3 * np.ones((1, 1))
    >>> controller = state_feedback_controller("by hand", model, levels, *gains, 60.0)
    >>> controller.values["feed.precompensator.level_3"]
    0.001
    """
    point = operating_point_of(model)
    law = state_feedback_law(
        *_signals(model, measurements),
        model.outputs,
        observer=None if estimation is None else estimation.structure(),
    )
    values = _common_values(model, measurements, feedback, estimation)
    values |= matrix_values("precompensator", model.inputs, model.outputs, precompensator)
    values |= parts_values("fading_time", model.inputs, [fading_time] * len(model.inputs))
    values = designed_values(law, values, point, name)
    return Controller(
        name=name,
        family=FEEDBACK_FAMILY,
        design="",
        law=law,
        values=values,
        initial_state=_at_rest(model, estimation),
        measurements=measurements,
        setpoints=model.outputs,
        manipulated=model.inputs,
        notes=_notes(model, measurements, estimation),
    )


def sensitivity_peak(controller: Controller, model: LinearModel) -> float:
    """Return the sensitivity peak of a controller's sampled loop; infinite if it is unstable.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Of the process, with any outputs.

    Raises
    ------
    NotApplicable
        Dead times leave no sampled loop of a moderate size.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> model = cl.load("quadruple-tank").linear
    >>> round(sensitivity_peak(design_lqi(model), model), 2)
    1.07
    """
    try:
        loop = sampled_loop(controller, with_outputs(model, controller.measurements))
    except NotSampled as refusal:
        raise NotApplicable(
            controller.name, f"its sampled loop needs {refusal.expected}; {refusal.remedy}"
        ) from None
    return loop.maximum_sensitivity


def matrix_values(
    matrix: str, to: Sequence[str], by: Sequence[str], numbers: np.ndarray
) -> dict[str, float]:
    """Return the values of the numbers of a matrix.

    Examples
    --------
    >>> matrix_values("feedback", ["pump"], ["tank_1", "tank_2"], np.array([[2.0, 0.5]]))
    {'pump.feedback.tank_1': 2.0, 'pump.feedback.tank_2': 0.5}
    """
    return {
        effect(row, matrix, column): float(value)
        for row, values in zip(to, numbers, strict=True)
        for column, value in zip(by, values, strict=True)
    }


def parts_values(part: str, of: Sequence[str], values: Iterable[float]) -> dict[str, float]:
    """Return the values of one part of several signals.

    Examples
    --------
    >>> parts_values("bias", ["pump_1", "pump_2"], [3, 4])
    {'pump_1.bias': 3.0, 'pump_2.bias': 4.0}
    """
    return {path(name, part): float(value) for name, value in zip(of, values, strict=True)}


def rest_values(point: OperatingPoint, inputs: Sequence[str]) -> dict[str, float]:
    """Return bias and limits of outputs.

    Examples
    --------
    >>> import clepsydra as cl
    >>> rest_values(operating_point_of(cl.load("quadruple-tank").linear), ["pump_1"])
    {'pump_1.bias': 3.0, 'pump_1.low_limit': 0.0, 'pump_1.high_limit': 10.0}
    """
    at, moved = point.as_dict(), [point.process.signal(name) for name in inputs]
    return {
        **parts_values("bias", inputs, [at[name] for name in inputs]),
        **parts_values("low_limit", inputs, [signal.low for signal in moved]),
        **parts_values("high_limit", inputs, [signal.high for signal in moved]),
    }


def output_at_rest(point: OperatingPoint, inputs: Sequence[str]) -> dict[str, float]:
    """Return integral and last_output of outputs at rest, where the bias stands beside them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> output_at_rest(operating_point_of(cl.load("quadruple-tank").linear), ["pump_1"])
    {'pump_1.integral': 0.0, 'pump_1.last_output': 3.0}
    """
    at = point.as_dict()
    return {
        **parts_values("integral", inputs, [0.0] * len(inputs)),
        **parts_values("last_output", inputs, [at[name] for name in inputs]),
    }


def _signals(model: LinearModel, measurements: Sequence[str]) -> tuple[list[Signal], list[Signal]]:
    process = operating_point_of(model).process
    return [process.signal(y) for y in measurements], [process.signal(u) for u in model.inputs]


def _common_values(
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    estimation: Estimation | None,
) -> dict[str, float]:
    """Return the values of references, observer, feedback, biases and limits."""
    point = operating_point_of(model)
    at, state = point.as_dict(), measurements
    values = parts_values("reference", measurements, [at[name] for name in measurements])
    if estimation is not None:
        values |= estimation.values(*_signals(model, measurements))
        state = tuple(signal.name for signal in estimation.estimated)
    values |= matrix_values("feedback", model.inputs, state, feedback)
    return values | rest_values(point, model.inputs)


def _at_rest(model: LinearModel, estimation: Estimation | None) -> dict[str, float]:
    state = output_at_rest(operating_point_of(model), model.inputs)
    if estimation is not None:
        state |= {path(signal, "estimate"): 0.0 for signal in estimation.estimated}
    return state


def _notes(
    model: LinearModel, measurements: tuple[str, ...], estimation: Estimation | None
) -> tuple[str, ...]:
    count = len(measurements)
    sensors = "1 sensor" if count == 1 else f"{count} sensors"
    which = "it" if count == 1 else "any of them"
    on_sensors = (
        f"Needs {sensors}: {', '.join(measurements)}; a fault of {which} holds every output."
    )
    if estimation is None:
        return (on_sensors,)
    period = operating_point_of(model).process.sampling_period
    return (
        on_sensors,
        f"The matrices of its observer hold for a sampling period of {period:g} s and no other.",
    )
