"""The extended Kalman filter of a process at an operating point: its noise and where it rests."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.observers.extended_kalman import ExtendedKalman
from clepsydra.controllers.observers.state_source import ProcessState
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.designed_values import rounded_symmetric
from clepsydra.designs.kalman import input_variances, kalman_gain, load_steps, process_noise
from clepsydra.designs.sampled.sampled_process import held_over
from clepsydra.designs.sampled.steps_in_a_sample import steps_in_a_sample
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.state_controllers import note_on_sensors
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.process_equations import ProcessEquations
from clepsydra.program.step_law import StepLaw


class FoundFilter(NamedTuple):
    """An extended Kalman filter, its numbers, and the linear filter that it is at rest.

    Parameters
    ----------
    noises : dict
        Standard deviations by the parameter that they are.
    memory : dict
        Its estimate and covariance at rest at the operating point.
    estimation : Estimation
        The stationary filter at the operating point.
    words : str
        What it estimates, and where its noise comes from.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> model = cl.load("quadruple-tank").linear
    >>> found = extended_kalman(model, process_equations(model), None, 30.0)
    >>> found.noises["sensor_noise"].round(6)  # [V]
    array([0.05, 0.05])
    >>> found.notes[1]
    'It runs the equations of the process in every sample, in 1 step, with the numbers model.*.'
    """

    observer: ExtendedKalman
    noises: dict[str, ArrayLike]
    memory: dict[str, ArrayLike]
    estimation: Estimation
    words: str

    @property
    def notes(self) -> tuple[str, str]:
        """What the reader has to know of it."""
        steps = self.observer.substeps
        return (
            note_on_sensors(self.observer.measurements),
            "It runs the equations of the process in every sample, in "
            f"{steps} step{'' if steps == 1 else 's'}, with the numbers model.*.",
        )


def extended_kalman(
    model: LinearModel,
    equations: ProcessEquations,
    measurements: Sequence[str] | None,
    horizon: float,
) -> FoundFilter:
    """Return an extended Kalman filter with the noise of `designs.kalman.process_noise`.

    Parameters
    ----------
    equations : ProcessEquations
        Of the model.
    measurements : sequence of str or None
        As for `designs.states.observed_process.observed_process`.
    horizon : float
        About the time that a response takes [s].

    Raises
    ------
    NotApplicable
        The measurements do not show a state that does not come to rest by itself, there are too
        many states, or the process is too fast for its sampling period.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> model = cl.load("three-tanks").linear
    >>> found = extended_kalman(model, process_equations(model), ["level_3"], 60.0)
    >>> len(found.memory["estimate"]), len(found.memory["covariance"])
    (3, 6)
    """
    observed = observed_process(model, measurements)
    states, outputs = equations.states, observed.measurements
    noise, steps = process_noise(observed, horizon), load_steps(model)
    loads = [name for name in steps if equations.by_constant([name]).nnz()]
    substeps, doublings = steps_in_a_sample(equations)
    try:
        observer = ExtendedKalman(equations, outputs, tuple(loads), substeps, doublings)
    except InputError as refusal:
        raise NotApplicable(
            f"{refusal.value} states would have to be estimated; {refusal.remedy}"
        ) from None
    root = math.sqrt(horizon)
    moves = np.sqrt(input_variances(observed)) * root
    sizes = np.array([abs(steps[name]) * root for name in loads])
    # The filter to which the recursion comes at rest at the operating point.
    acting = acting_model(model, equations)
    held, moved = held_over(acting.A, acting.B, observed.period)
    rows = [acting.disturbances.index(name) for name in loads]
    S = (acting.B * moves**2) @ acting.B.T + (acting.E[:, rows] * sizes**2) @ acting.E[:, rows].T
    W = 0.5 * observed.period * (S + held @ S @ held.T)
    at = equations.point.as_dict()
    readings = ca.vertcat(*(equations.reading(name) for name in outputs))
    shown = equations.at(ca.jacobian(readings, equations.state))
    found = kalman_gain(held, shown, noise._replace(process=W))
    covariance = rounded_symmetric(found.covariance)
    sensors = np.sqrt(np.diag(noise.measurement))
    noises = {"input_noise": moves, "load_noise": sizes, "sensor_noise": sensors}
    upper = covariance[np.triu_indices(len(states))]
    memory: dict[str, ArrayLike] = {"estimate": [at[name] for name in states], "covariance": upper}
    estimated = tuple(equations.signals_of_states())
    estimation = Estimation(estimated, held, moved, shown, found.gain)
    words = f"extended Kalman filter for {', '.join(states)}, {noise.words}"
    return FoundFilter(observer, noises, memory, estimation, words)


def process_state_controller(
    name: str,
    family: str,
    law: StepLaw,
    source: ProcessState,
    numbers: Mapping[str, ArrayLike],
    state: Mapping[str, ArrayLike],
    by: FoundFilter | None,
) -> Controller:
    """Return a controller whose state is that of the equations of the process.

    Parameters
    ----------
    source : ProcessState
        Of the law.
    numbers, state : dict
        Those found of its parameters and of its state (`at_operating_point.numbers_at`).
    by : FoundFilter or None
        Where the source is an extended Kalman filter.

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.
    """
    point = source.equations.point
    notes: tuple[str, ...] = (note_on_sensors(source.measurements),)
    if by is not None:
        numbers, state, notes = {**numbers, **by.noises}, {**state, **by.memory}, by.notes
    values = numbers_at(point, law.parameters, **numbers)
    start = numbers_at(point, law.state, **state)
    return controller_at(point, name, family, law, values, start, notes=notes)


def acting_model(model: LinearModel, equations: ProcessEquations) -> LinearModel:
    """Return the linear model at the operating point with the states of the equations.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> model = cl.load("wet-well").linear
    >>> acting_model(model, process_equations(model)).states
    ('well.level', 'duty.actual', 'standby.actual')
    """
    whole = linearise(operating_point_of(model)).select(model.outputs, model.inputs)
    return whole.of_states([whole.states.index(name) for name in equations.states])
