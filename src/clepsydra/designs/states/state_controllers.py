"""Controllers made of feedback gains, at rest at the operating point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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
    >>> controller.values["feedback_1_2"], controller.setpoints
    (0.0001, ('level_3',))
    """
    point = operating_point_of(model)
    process = point.process
    law = lqi_law(
        len(measurements),
        len(model.inputs),
        [measurements.index(output) + 1 for output in model.outputs],
        anti_windup,
        observer=None if estimation is None else estimation.structure(),
        measured=[process.signal(each) for each in measurements],
        manipulated=[process.signal(each) for each in model.inputs],
    )
    values = _common_values(model, measurements, feedback, estimation)
    for i, row in enumerate(integral, start=1):
        values |= {f"integral_gain_{i}_{j}": float(value) for j, value in enumerate(row, start=1)}
        if anti_windup == "back_calculation":
            values[f"tracking_time_{i}"] = float(tracking_times[i - 1])
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
    >>> controller.values["precompensator_1_1"]
    0.001
    """
    point = operating_point_of(model)
    process = point.process
    law = state_feedback_law(
        len(measurements),
        len(model.inputs),
        [measurements.index(output) + 1 for output in model.outputs],
        observer=None if estimation is None else estimation.structure(),
        measured=[process.signal(each) for each in measurements],
        manipulated=[process.signal(each) for each in model.inputs],
    )
    values = _common_values(model, measurements, feedback, estimation)
    for i, row in enumerate(precompensator, start=1):
        values |= {f"precompensator_{i}_{j}": float(value) for j, value in enumerate(row, start=1)}
        values[f"fading_time_{i}"] = fading_time
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


def _common_values(
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    estimation: Estimation | None,
) -> dict[str, float]:
    """Return the values of references, observer, feedback, biases and limits."""
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    values = {f"reference_measurement_{j}": at[name] for j, name in enumerate(measurements, 1)}
    if estimation is not None:
        values |= estimation.values()
    for i, (name, row) in enumerate(zip(model.inputs, feedback, strict=True), start=1):
        signal = process.signal(name)
        values |= {f"feedback_{i}_{j}": float(value) for j, value in enumerate(row, start=1)}
        values |= {
            f"bias_{i}": at[name],
            f"low_limit_{i}": signal.low,
            f"high_limit_{i}": signal.high,
        }
    return values


def _at_rest(model: LinearModel, estimation: Estimation | None) -> dict[str, float]:
    at = operating_point_of(model).as_dict()
    state: dict[str, float] = {}
    for i, name in enumerate(model.inputs, start=1):
        state |= {f"integral_{i}": 0.0, f"last_output_{i}": at[name]}
    if estimation is not None:
        state |= {f"estimate_{j}": 0.0 for j in range(1, len(estimation.estimated) + 1)}
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
