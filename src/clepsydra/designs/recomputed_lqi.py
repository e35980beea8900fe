"""LQI whose gains are recomputed in every sample from the linear model at the present state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.observers.measured_state import MeasuredState, ProcessState
from clepsydra.controllers.process_equations import ProcessEquations, process_equations
from clepsydra.controllers.recomputed_lqi import FAMILY, cost_names, recomputed_lqi_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.bryson import (
    acceptable_deviations,
    refuse_more_inputs,
    slowest_time_constant,
    tracking_times,
)
from clepsydra.designs.designed_values import designed_values, rounded_numbers, rounded_symmetric
from clepsydra.designs.extended_kalman import (
    FoundFilter,
    acting_model,
    extended_kalman,
    notes_on_filter,
    refuse_dead_time,
)
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.sampled.steps_in_a_sample import steps_in_a_sample
from clepsydra.designs.states.linear_quadratic import (
    LqiGains,
    bryson_weights,
    check_independent,
    refuse_feedthrough,
    scaled_cost,
)
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.designs.states.nonlinear_lqi_values import (
    gain_values,
    output_values,
)
from clepsydra.designs.states.riccati import Regulator, optimal_regulator
from clepsydra.designs.states.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.state_controllers import (
    lqi_controller,
    output_at_rest,
    parts_values,
    sensitivity_peak,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

NAME = "LQI, recomputed"
#: A larger matrix to invert makes a law that nobody can read or check on a plant.
MOST_INPUTS = 4
#: So many states and integrals at most, or the Riccati equation fills the controller.
MOST_STATES = 10
#: A linear model that changes by less, as a share of its entries, is the same everywhere.
_LEAST_CHANGE = 1e-6
#: Of the ranges, where the linear model is compared.
_SHARES = (0.1, 0.3, 0.7, 0.9)


class StationaryLqi(NamedTuple):
    """The regulator to which the recursion comes at the operating point.

    Parameters
    ----------
    gains : LqiGains
    cost : ndarray [n + q, n + q]
        P in scaled states and errors.
    sizes : ndarray [n]
        In which the states are scaled.
    errors, moves, horizons : ndarray [q], [m], [q]
        The largest deviations and how long they may last.

    Examples
    --------
    >>> one = np.eye(1)
    >>> StationaryLqi(LqiGains(one, one, np.array([0.5])), np.eye(2), *[np.ones(1)] * 4).sizes
    array([1.])
    """

    gains: LqiGains
    cost: np.ndarray
    sizes: np.ndarray
    errors: np.ndarray
    moves: np.ndarray
    horizons: np.ndarray


def design_recomputed_lqi(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
    steps: int = 1,
) -> Controller:
    """Design LQI control whose gains follow the operating point without a table.

    At the operating point its gains are those of `designs.bryson.design_lqi`; elsewhere they
    follow from the same largest deviations and the linear model at the present state and at the
    inputs, filtered over the horizon. Where sensors show every state they are read; else, or
    where measurements are chosen, an extended Kalman filter estimates the states
    (`designs.extended_kalman`). Where the sensitivity peak at the operating point is above 2, moves
    are made smaller and the horizon longer by one factor until it is 2.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs follow the setpoints.
    measurements : sequence of str, optional
        What the filter reads; naming them asks for the filter.
    maximum_errors, maximum_moves : mapping, optional
        As for `designs.bryson.design_lqi`.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    steps : int
        Of the Riccati difference equation in a sample.

    Returns
    -------
    Controller

    Raises
    ------
    NotApplicable
        The process has dead time, a state is neither measured nor can it be estimated, there
        are more than four inputs or ten states and integrals, or no stabilising gains.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, the
        steps are not 1 to 20, or the anti-windup is unknown.

    References
    ----------
    J. R. Cloutier, State-dependent Riccati equation techniques: an overview, American Control
    Conference 1997, 932-936, doi 10.1109/ACC.1997.609663.

    Examples
    --------
    At the operating point the gains are those of LQI by Bryson's rule:

    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> model = cl.load("averaging-tank").linear
    >>> gains = [design_lqi(model).values["inflow.integral_gain.volume"],
    ...          design_recomputed_lqi(model).initial_state["inflow.integral_gain.volume"]]
    >>> [round(gain, 6) for gain in gains]
    [0.144569, 0.144569]
    """
    process = operating_point_of(model).process
    _check_steps(steps)
    refuse_dead_time(model, NAME)
    refuse_more_inputs(model, NAME)
    check_ranges(process, model.outputs, model.inputs, NAME)
    refuse_feedthrough(model, NAME)
    check_independent(model, NAME)
    equations = process_equations(model)
    _check_size(equations)
    if change_over_ranges(equations) < _LEAST_CHANGE:
        raise NotApplicable(
            NAME, "the linear model is the same in every state, so that its gains never change"
        )
    acting = acting_model(model, equations)
    period = process.sampling_period
    deviations = acceptable_deviations(acting, maximum_errors, maximum_moves, NAME)
    source, found_filter = _source(model, equations, measurements, deviations.horizon)

    def designed(factor: float) -> tuple[Controller, StationaryLqi]:
        asked = deviations.slower(factor)
        horizons = np.full(len(asked.errors), asked.horizon)
        stationary = stationary_lqi(acting, *asked.sizes(), horizons, period)
        linear = _linear(acting, source, found_filter, stationary, asked.horizon, anti_windup)
        return linear, stationary

    found = slow_down(designed, lambda design: sensitivity_peak(design[0], model), NAME)
    asked = deviations.slower(found.factor)
    linear, stationary = found.design
    times = [linear.values.get(path(u, "tracking_time"), 1.0) for u in model.inputs]
    controller = recomputed_lqi_controller(
        equations, source, found_filter, stationary, asked.horizon, times, anti_windup, steps
    )
    slowest = slowest_time_constant(stationary.gains.eigenvalues, period)
    estimated, notes = "", linear.notes
    if found_filter is not None:
        notes = notes_on_filter(found_filter)
        estimated = (
            f"; extended Kalman filter for {', '.join(equations.states)}, {found_filter.words}"
        )
    of_a_sample = "one step" if steps == 1 else f"{steps} steps"
    return dataclasses.replace(
        controller,
        design=(
            f"LQI with Bryson's weights, {asked.in_words(process)}, an error lasting at most "
            f"{time_text(asked.horizon)}; in every sample {of_a_sample} of the Riccati equation "
            f"with the linear model at the present state{estimated}; at the operating point "
            f"slowest closed-loop time constant {time_text(slowest)}, sensitivity peak "
            f"{found.peak:.2f}."
        ),
        notes=(
            *notes,
            "Its gains are states, which start at those of the operating point.",
            *note_on_slowing(found, "the regulator"),
        ),
        slowed=found.factor,
    )


def recomputed_lqi_controller(
    equations: ProcessEquations,
    source: ProcessState,
    found_filter: FoundFilter | None,
    stationary: StationaryLqi,
    input_filter_time: float,
    tracking_times: Sequence[float],
    anti_windup: AntiWindup,
    steps: int = 1,
) -> Controller:
    """Return a recomputed LQI controller at rest at the operating point, judged by no rule.

    Parameters
    ----------
    equations : ProcessEquations
    source : ProcessState
    found_filter : FoundFilter or None
        Where the source is an extended Kalman filter.
    stationary : StationaryLqi
        Its weights are those of the law.
    input_filter_time : float
        Time constant in which the model follows the inputs [s].
    tracking_times : sequence of float
        One for each input, for back-calculation [s].
    anti_windup : AntiWindup
    steps : int

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("averaging-tank").linear
    >>> equations = process_equations(model)
    >>> weights = np.array([1e3, 0.5]), np.array([0.5, 3e3]), np.array([2.0, 4.0])
    >>> found = stationary_lqi(model, *weights, 0.1)
    >>> recomputed_lqi_controller(
    ...     equations, MeasuredState(equations), None, found, 5.0, [1.0, 1.0], "none").measurements
    ('concentration', 'volume')
    """
    _, doublings = steps_in_a_sample(equations, NAME)
    law = recomputed_lqi_law(source, anti_windup, doublings=doublings, steps=steps)
    values = {"input_filter_time": input_filter_time}
    for part, of, numbers in (
        ("largest_error", equations.outputs, stationary.errors),
        ("largest_move", equations.inputs, stationary.moves),
        ("horizon", equations.outputs, stationary.horizons),
        ("size", equations.states, stationary.sizes),
    ):
        values |= parts_values(part, of, numbers)
    values |= output_values(equations, tracking_times, anti_windup)
    constants = {parameter.name: parameter.initial for parameter in law.parameters}
    found = gain_values(equations, stationary.gains)
    gains = [entry for entry in law.state if isinstance(entry, Signal) and entry.name in found]
    point = equations.point
    state = output_at_rest(point, equations.inputs) | rounded_numbers(gains, found, point)
    at = point.as_dict()
    state |= {path(name, "filtered"): at[name] for name in equations.inputs}
    if found_filter is not None:
        values |= found_filter.values
        state |= found_filter.state
    values = designed_values(law, constants | values, point, NAME)
    size, cost = len(stationary.cost), rounded_symmetric(stationary.cost)
    entries = [float(cost[j, k]) for j in range(size) for k in range(j, size)]
    state |= zip(cost_names(equations), entries, strict=True)
    return Controller(
        name=NAME,
        family=FAMILY,
        design="",
        law=law,
        values=values,
        initial_state=state,
        measurements=source.measurements,
        setpoints=equations.outputs,
        manipulated=equations.inputs,
    )


def change_over_ranges(equations: ProcessEquations) -> float:
    """Return by what share of its largest entry the linear model changes within the ranges.

    Examples
    --------
    >>> import clepsydra as cl
    >>> change_over_ranges(process_equations(cl.load("eight-tanks").linear)) < 1e-9
    True
    """
    point = equations.point
    at = point.as_dict()
    states = equations.signals_of_states()
    inputs = [point.process.signal(name) for name in equations.inputs]
    values = equations.values([equations.A, equations.B])
    rest = [np.array([at[signal.name] for signal in group]) for group in (states, inputs)]
    first = values(*rest)
    largest = 0.0
    for share in _SHARES:
        places = [
            np.array([_placed(signal, at[signal.name], share) for signal in group])
            for group in (states, inputs)
        ]
        for found in (values(places[0], rest[1]), values(rest[0], places[1]), values(*places)):
            for matrix, before in zip(found, first, strict=True):
                size = float(np.abs(before).max(initial=0.0)) or 1.0
                largest = max(largest, float(np.abs(matrix - before).max(initial=0.0)) / size)
    return largest


def _placed(signal: Signal, value: float, share: float) -> float:
    return signal.low + share * signal.span if np.isfinite(signal.span) else value


def stationary_lqi(
    model: LinearModel,
    errors: np.ndarray,
    moves: np.ndarray,
    horizons: np.ndarray,
    period: float,
) -> StationaryLqi:
    """Return the regulator and the cost to go to which the recursion comes where nothing moves.

    Parameters
    ----------
    model : LinearModel
        With the states of the equations.
    errors, moves, horizons : ndarray [q], [m], [q]
        ȳ [output unit], ū [input unit] and T [s] of Bryson's weights.
    period : float
        [s]

    Raises
    ------
    NotApplicable
        The Riccati equation has no stabilising solution.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("averaging-tank").linear
    >>> weights = np.array([1e3, 0.5]), np.array([0.5, 3e3]), np.array([2.0, 4.0])
    >>> stationary_lqi(model, *weights, 0.1).cost.shape
    (4, 4)
    """
    horizon = float(np.max(horizons))
    weights = bryson_weights(model, errors, moves, horizon)
    cost, sizes, scales = scaled_cost(model, weights, period, horizon)
    n, q = len(sizes), len(errors)
    sums = errors * horizons
    C = period * model.C * sizes / sums[:, None]
    held = np.block([[cost.held, np.zeros((n, q))], [C, np.eye(q)]])
    moved = np.vstack([cost.moved, np.zeros((q, len(moves)))])
    Q = np.eye(n + q)
    Q[:n, :n] = cost.Q
    N = np.vstack([cost.N, np.zeros((q, len(moves)))])
    found: Regulator = optimal_regulator(held, moved, Q, N, cost.R, NAME)
    gain = scales[:, None] * found.gain
    gains = LqiGains(gain[:, :n] / sizes, gain[:, n:] / sums, found.eigenvalues)
    return StationaryLqi(gains, found.cost, sizes, errors, moves, horizons)


def _source(
    model: LinearModel,
    equations: ProcessEquations,
    measurements: Sequence[str] | None,
    horizon: float,
) -> tuple[ProcessState, FoundFilter | None]:
    if measurements is None:
        try:
            return MeasuredState(equations), None
        except InputError:
            pass
    found = extended_kalman(model, equations, measurements, horizon, NAME)
    return found.observer, found


def _linear(
    acting: LinearModel,
    source: ProcessState,
    found_filter: FoundFilter | None,
    stationary: StationaryLqi,
    horizon: float,
    anti_windup: AntiWindup,
) -> Controller:
    """Return LQI with the gains at rest: the linear model of the law at the operating point."""
    gains, estimation = stationary.gains, None
    feedback, times = gains.feedback, [horizon] * len(acting.inputs)
    if found_filter is not None:
        estimation = found_filter.estimation
    else:
        shown = with_outputs(acting, source.measurements).C
        feedback = np.linalg.solve(shown.T, feedback.T).T
        times = tracking_times(acting, source.measurements, feedback, gains, horizon)
    return lqi_controller(
        NAME,
        acting,
        source.measurements,
        feedback,
        gains.integral,
        times,
        anti_windup,
        estimation,
    )


def _check_steps(steps: int) -> None:
    if isinstance(steps, bool) or not isinstance(steps, int) or not 1 <= steps <= 20:
        raise InputError(
            f"{NAME}, steps", steps, "a whole number from 1 to 20", "one step is enough in most"
        )


def _check_size(equations: ProcessEquations) -> None:
    if len(equations.inputs) > MOST_INPUTS:
        raise NotApplicable(
            NAME,
            f"it solves for {len(equations.inputs)} inputs in every sample, and takes at most "
            f"{MOST_INPUTS}",
        )
    size = len(equations.states) + len(equations.outputs)
    if size > MOST_STATES:
        raise NotApplicable(
            NAME,
            f"{size} states and integrals make {size * (size + 1) // 2} numbers of the Riccati "
            f"equation, and it takes {MOST_STATES} at most; schedule the gains by tables",
        )
