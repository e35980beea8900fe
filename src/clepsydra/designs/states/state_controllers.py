"""Controllers made of feedback gains, at rest at the operating point."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY as LQI_FAMILY
from clepsydra.controllers.linear_quadratic_integral import lqi_law
from clepsydra.controllers.state_feedback import FAMILY as FEEDBACK_FAMILY
from clepsydra.controllers.state_feedback import state_feedback_law
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import StepLaw

# A search for gains tries many in one law.
_lqi_law = lru_cache(maxsize=8)(lqi_law)
_state_feedback_law = lru_cache(maxsize=8)(state_feedback_law)


def lqi_controller(
    name: str,
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    integral: np.ndarray,
    tracking_times: ArrayLike,
    anti_windup: AntiWindup,
    estimation: Estimation | None = None,
) -> Controller:
    """Return an LQI controller with these gains.

    Parameters
    ----------
    model : LinearModel
        Its outputs are controlled and its inputs manipulated.
    measurements : tuple of str
        With the outputs among them.
    feedback : ndarray [m, N]
        F of the measurements, or of what is estimated.
    integral : ndarray [m, q]
        G.
    tracking_times : array_like
        One for each input, or one for all, for back-calculation [s].

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
    law = partial(_lqi_law, anti_windup=anti_windup)
    found = {"feedback": feedback, "integral_gain": integral, "tracking_time": tracking_times}
    return _controller(name, LQI_FAMILY, law, model, measurements, estimation, found)


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
    law = _state_feedback_law
    found: Mapping[str, ArrayLike] = {
        "feedback": feedback,
        "precompensator": precompensator,
        "fading_time": fading_time,
    }
    return _controller(name, FEEDBACK_FAMILY, law, model, measurements, estimation, found)


def sensitivity_peak(controller: Controller, model: LinearModel) -> float:
    """Return the sensitivity peak of a controller's sampled loop; infinite if it is unstable.

    Parameters
    ----------
    model : LinearModel
        Of the process, with any outputs.

    Raises
    ------
    NotApplicable
        Dead times leave no sampled loop of a moderate size.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> model = cl.load("quadruple-tank").linear
    >>> round(sensitivity_peak(design_lqi(model), model), 2)
    1.07
    """
    seen = with_outputs(model, controller.measurements)
    return sampled_loop(controller, seen).maximum_sensitivity


def note_on_sensors(measurements: Sequence[str]) -> str:
    """Return what a fault of a sensor does to a law that needs the whole state.

    Examples
    --------
    >>> note_on_sensors(["level"])
    'Needs 1 sensor: level; a fault of it holds every output.'
    """
    count = len(measurements)
    sensors, which = ("1 sensor", "it") if count == 1 else (f"{count} sensors", "any of them")
    return f"Needs {sensors}: {', '.join(measurements)}; a fault of {which} holds every output."


def _controller(
    name: str,
    family: str,
    law_of: Callable[..., StepLaw],
    model: LinearModel,
    measurements: tuple[str, ...],
    estimation: Estimation | None,
    found: Mapping[str, ArrayLike],
) -> Controller:
    point = operating_point_of(model)
    ends = measurements, model.inputs
    signals = (tuple(point.process.signal(name) for name in names) for names in ends)
    observer = None if estimation is None else estimation.structure()
    law = law_of(*signals, model.outputs, observer=observer)
    notes = [note_on_sensors(measurements)]
    if estimation is not None:
        found = {**found, **estimation.numbers()}
        notes.append(
            "The matrices of its observer hold for a sampling period of "
            f"{point.process.sampling_period:g} s and no other."
        )
    values, state = numbers_at(point, law.parameters, **found), numbers_at(point, law.state)
    return controller_at(point, name, family, law, values, state, notes=tuple(notes))
