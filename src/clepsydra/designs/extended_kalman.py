"""LQI with an extended Kalman filter: states estimated by the process's own equations."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import effect, path
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY, nonlinear_lqi_law
from clepsydra.controllers.observers.extended_kalman import ExtendedKalman
from clepsydra.controllers.process_equations import (
    ProcessEquations,
    process_equations,
)
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.bryson import (
    acceptable_deviations,
    refuse_more_inputs,
    slowest_time_constant,
)
from clepsydra.designs.designed_values import designed_values, rounded_symmetric
from clepsydra.designs.kalman import Noise, input_variances, kalman_gain, process_noise
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.sampled.sampled_process import held_over
from clepsydra.designs.sampled.steps_in_a_sample import steps_in_a_sample
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.linear_quadratic import (
    LqiGains,
    bryson_weights,
    lqi_gains_by_weights,
)
from clepsydra.designs.states.nonlinear_lqi_values import (
    constant_values,
    gain_values,
    output_values,
)
from clepsydra.designs.states.observed_process import ObservedProcess, observed_process
from clepsydra.designs.states.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.state_controllers import (
    lqi_controller,
    output_at_rest,
    parts_values,
    sensitivity_peak,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of

NAME = "LQI with extended Kalman filter"


class FoundFilter(NamedTuple):
    """An extended Kalman filter, its numbers, and the linear filter that it is at rest.

    Parameters
    ----------
    observer : ExtendedKalman
    values : dict
        Of its parameters but the constants of the process.
    state : dict
        Its memory at rest at the operating point.
    estimation : Estimation
        The stationary filter at the operating point.
    words : str
        Where its noise comes from.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> found = extended_kalman(model, process_equations(model), None, 30.0, "by hand")
    >>> round(found.values["level_1.sensor_noise"], 6)  # [V]
    0.05
    """

    observer: ExtendedKalman
    values: dict[str, float]
    state: dict[str, float]
    estimation: Estimation
    words: str


def design_lqi_extended_kalman(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control of states that an extended Kalman filter estimates.

    The regulator is that of `designs.bryson.design_lqi` for the operating point. The filter runs
    the equations of the process, so that its estimate holds away from the operating point too,
    and computes its gain as it goes. Its noise is that of `designs.kalman.process_noise`. At rest
    at the operating point it is the Kalman filter there; the regulator is slowed down by one
    factor until the sensitivity peak of that sampled loop is 2.

    Parameters
    ----------
    model : LinearModel
    measurements, maximum_errors, maximum_moves, anti_windup
        As for `designs.lqi_kalman.design_lqi_kalman`.

    Returns
    -------
    Controller

    Raises
    ------
    NotApplicable
        The process has dead time, the measurements do not show what has to be known, there are
        no stabilising gains, or no slowing down makes the loop robust.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, or
        the anti-windup is unknown.

    References
    ----------
    A. H. Jazwinski, Stochastic Processes and Filtering Theory, Academic Press 1970, chapter 8.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_lqi_extended_kalman(cl.load("quadruple-tank").linear)
    >>> controller.measurements
    ('level_1', 'level_2')
    """
    process = operating_point_of(model).process
    refuse_dead_time(model, NAME)
    refuse_more_inputs(model, NAME)
    check_ranges(process, model.outputs, model.inputs, NAME)
    equations = process_equations(model)
    acting = acting_model(model, equations)
    period = process.sampling_period
    deviations = acceptable_deviations(acting, maximum_errors, maximum_moves, NAME)
    found_filter = extended_kalman(model, equations, measurements, deviations.horizon, NAME)

    def designed(factor: float) -> tuple[Controller, LqiGains]:
        asked = deviations.slower(factor)
        weights = bryson_weights(acting, *asked.sizes(), asked.horizon)
        gains = lqi_gains_by_weights(acting, weights, period, asked.horizon, NAME)
        linear = lqi_controller(
            NAME,
            acting,
            found_filter.observer.measurements,
            gains.feedback,
            gains.integral,
            [asked.horizon] * len(model.inputs),
            anti_windup,
            found_filter.estimation,
        )
        return linear, gains

    found = slow_down(designed, lambda design: sensitivity_peak(design[0], model), NAME)
    _, gains = found.design
    asked = deviations.slower(found.factor)
    law = nonlinear_lqi_law(found_filter.observer, anti_windup)
    values = found_filter.values | constant_values(found_filter.observer)
    values |= gain_values(equations, gains) | output_values(
        equations, [asked.horizon] * len(model.inputs), anti_windup
    )
    values = designed_values(law, values, equations.point, NAME)
    slowest = [
        slowest_time_constant(each, period)
        for each in (gains.eigenvalues, found_filter.estimation.error_poles)
    ]
    return Controller(
        name=NAME,
        family=FAMILY,
        design=(
            f"LQI with Bryson's weights, {asked.in_words(process)}, an error lasting at most "
            f"{time_text(asked.horizon)}; extended Kalman filter for "
            f"{', '.join(equations.states)}, "
            f"{found_filter.words}; at the operating point slowest time constants "
            f"{time_text(slowest[0])} of the regulator and {time_text(slowest[1])} of the filter, "
            f"sensitivity peak {found.peak:.2f}."
        ),
        law=law,
        values=values,
        initial_state=output_at_rest(equations.point, equations.inputs) | found_filter.state,
        measurements=found_filter.observer.measurements,
        setpoints=model.outputs,
        manipulated=model.inputs,
        notes=(*notes_on_filter(found_filter), *note_on_slowing(found, "the regulator")),
        slowed=found.factor,
    )


def extended_kalman(
    model: LinearModel,
    equations: ProcessEquations,
    measurements: Sequence[str] | None,
    horizon: float,
    method: str,
) -> FoundFilter:
    """Return an extended Kalman filter with the noise of `designs.kalman.process_noise`.

    Parameters
    ----------
    model : LinearModel
    equations : ProcessEquations
        Of the model.
    measurements : sequence of str or None
        As for `designs.states.observed_process.observed_process`.
    horizon : float
        About the time that a response takes [s].
    method : str
        For the message.

    Raises
    ------
    NotApplicable
        The measurements do not show a state that does not come to rest by itself, there are too
        many states, or the process is too fast for its sampling period.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> found = extended_kalman(model, process_equations(model), ["level_3"], 60.0, "by hand")
    >>> len(found.state)  # three estimates and six covariances
    9
    """
    observed = observed_process(model, measurements, method)
    process, at = equations.point.process, equations.point.as_dict()
    noise = process_noise(observed, horizon)
    steps = {
        name: abs(size)
        for element in process.elements
        for name, size in element.load_steps().items()
        if name in model.disturbances and size != 0.0
    }
    loads = [name for name in steps if equations.by_constant([name]).nnz()]
    acting = acting_model(model, equations)
    substeps, doublings = steps_in_a_sample(equations, method)
    try:
        observer = ExtendedKalman(
            equations, observed.measurements, tuple(loads), substeps, doublings
        )
    except InputError as refusal:
        raise NotApplicable(
            method, f"{refusal.value} states would have to be estimated; {refusal.remedy}"
        ) from None
    root = math.sqrt(horizon)
    moves = np.sqrt(input_variances(observed)) * root
    sizes = np.array([steps[name] * root for name in loads])
    deviations = np.sqrt(np.diag(noise.measurement))
    values = parts_values("input_noise", equations.inputs, moves)
    values |= parts_values("load_noise", loads, sizes)
    values |= parts_values("sensor_noise", observed.measurements, deviations)
    estimation, covariance = _stationary(observed, acting, equations, moves, sizes, loads, noise)
    covariance = rounded_symmetric(covariance)
    states = equations.states
    memory = {path(name, "estimate"): at[name] for name in states}
    memory |= {
        effect(x, "covariance", other): float(covariance[j, k])
        for j, x in enumerate(states)
        for k, other in list(enumerate(states))[j:]
    }
    return FoundFilter(observer, values, memory, estimation, noise.words)


def refuse_dead_time(model: LinearModel, method: str) -> None:
    """Refuse a process with dead time: its equations have no state for what is on its way.

    Raises
    ------
    NotApplicable

    Examples
    --------
    >>> import clepsydra as cl
    >>> refuse_dead_time(cl.load("quadruple-tank").linear, NAME)
    """
    if operating_point_of(model).process.motion.delays:
        raise NotApplicable(
            method,
            "the process has dead time, and its equations have no states for what is on its way; "
            "LQI with a Kalman filter has them",
        )


def acting_model(model: LinearModel, equations: ProcessEquations) -> LinearModel:
    """Return the linear model at the operating point with the states of the equations.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("wet-well").linear
    >>> acting_model(model, process_equations(model)).states
    ('well.level', 'duty.actual', 'standby.actual')
    """
    whole = linearise(operating_point_of(model)).select(model.outputs, model.inputs)
    kept = [whole.states.index(name) for name in equations.states]
    return dataclasses.replace(
        whole,
        A=whole.A[np.ix_(kept, kept)],
        B=whole.B[kept],
        E=whole.E[kept],
        C=whole.C[:, kept],
        states=equations.states,
    )


def notes_on_filter(found: FoundFilter) -> tuple[str, ...]:
    """Return what the reader has to know of an extended Kalman filter.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> found = extended_kalman(model, process_equations(model), None, 30.0, "by hand")
    >>> notes_on_filter(found)[1]
    'It runs the equations of the process in every sample, in 1 step, with the numbers model.*.'
    """
    names = found.observer.measurements
    sensors = "1 sensor" if len(names) == 1 else f"{len(names)} sensors"
    which = "it" if len(names) == 1 else "any of them"
    steps = found.observer.substeps
    return (
        f"Needs {sensors}: {', '.join(names)}; a fault of {which} holds every output.",
        "It runs the equations of the process in every sample, in "
        f"{steps} step{'' if steps == 1 else 's'}, with the numbers model.*.",
    )


def _stationary(
    observed: ObservedProcess,
    acting: LinearModel,
    equations: ProcessEquations,
    moves: np.ndarray,
    sizes: np.ndarray,
    loads: Sequence[str],
    noise: Noise,
) -> tuple[Estimation, np.ndarray]:
    """Return the filter to which the recursion comes at rest at the operating point, and P."""
    held, moved = held_over(acting.A, acting.B, observed.period)
    rows = [acting.disturbances.index(name) for name in loads]
    S = (acting.B * moves**2) @ acting.B.T + (acting.E[:, rows] * sizes**2) @ acting.E[:, rows].T
    W = 0.5 * observed.period * (S + held @ S @ held.T)
    at = np.array([equations.point.as_dict()[name] for name in equations.states])
    inputs = np.array([equations.point.as_dict()[name] for name in equations.inputs])
    readings = ca.vertcat(*(equations.reading(name) for name in observed.measurements))
    (shown,) = equations.values([ca.jacobian(readings, equations.state)])(at, inputs)
    found = kalman_gain(held, shown, noise._replace(process=W))
    signals = tuple(equations.signals_of_states())
    return Estimation(signals, held, moved, shown, found.gain), found.covariance
