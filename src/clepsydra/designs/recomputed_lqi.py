"""LQI whose gains are recomputed in every sample from the linear model at the present state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.observers.state_source import MeasuredState, ProcessState
from clepsydra.controllers.recomputed_lqi import FAMILY, recomputed_lqi_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import whole_number
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.design import Studied, design
from clepsydra.designs.designed_values import rounded_numbers, rounded_symmetric
from clepsydra.designs.sampled.steps_in_a_sample import at_share, steps_in_a_sample
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import (
    ANTI_WINDUP,
    LqiGains,
    check_independent,
    refuse_feedthrough,
)
from clepsydra.designs.states.process_filter import (
    FoundFilter,
    acting_model,
    extended_kalman,
    process_state_controller,
)
from clepsydra.designs.states.robust_lqi import StateLqi, check_lqi
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.process_equations import ProcessEquations, process_equations

NAME = "LQI, recomputed"
#: A larger matrix to invert makes a law that nobody can read or check on a plant.
MOST_INPUTS = 4
#: So many states and integrals at most, or the Riccati equation fills the controller.
MOST_STATES = 10
#: A linear model that changes by less, as a share of its entries, is the same everywhere.
_LEAST_CHANGE = 1e-6
#: Of the ranges, where the linear model is compared.
_NOTE = "Its gains are states, which start at those of the operating point."
_GAINS = ("feedback", "integral_gain")
_SHARES = (0.1, 0.3, 0.7, 0.9)


@design(
    "recomputed_lqi",
    "LQI recomputed in each sample",
    Studied(200, "LQI, recomputed"),
    keys=(
        MEASUREMENTS,
        *DEVIATIONS,
        ANTI_WINDUP,
        whole_number("steps", "steps of the Riccati equation in a sample", 20),
    ),
)
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

    At the operating point its gains are those of `designs.lqi.design_lqi`; elsewhere they
    follow from the same largest deviations and the linear model at the present state and at the
    inputs, filtered over the horizon. Where sensors show every state they are read; else, or
    where measurements are chosen, an extended Kalman filter estimates the states
    (`designs.lqi_extended_kalman`). Where the sensitivity peak at the operating point is above 2,
    moves are made smaller and the horizon longer by one factor until it is 2.

    Parameters
    ----------
    measurements : sequence of str, optional
        What the filter reads; naming them asks for the filter.
    maximum_errors, maximum_moves : mapping, optional
        As for `designs.lqi.design_lqi`.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    steps : int
        Of the Riccati difference equation in a sample.

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
    >>> from clepsydra.designs.lqi import design_lqi
    >>> model = cl.load("averaging-tank").linear
    >>> gains = [design_lqi(model).values["inflow.integral_gain.volume"],
    ...          design_recomputed_lqi(model).initial_state["inflow.integral_gain.volume"]]
    >>> [round(gain, 6) for gain in gains]
    [0.144569, 0.144569]
    """
    process = operating_point_of(model).process
    check_lqi(model, process.delayed, "its equations have")
    refuse_feedthrough(model)
    check_independent(model)
    equations = process_equations(model)
    _check_size(equations)
    if change_over_ranges(equations) < _LEAST_CHANGE:
        raise NotApplicable(
            "the linear model is the same in every state, so that its gains never change"
        )
    acting = acting_model(model, equations)
    deviations = acceptable_deviations(acting, maximum_errors, maximum_moves)
    source, by = _source(model, equations, measurements, deviations.horizon)
    estimation = None if by is None else by.estimation
    lqi = StateLqi(NAME, acting, deviations, source.measurements, anti_windup, estimation)
    found = lqi.robust(model)
    linear, gains, asked = found.design
    errors, moves = asked.sizes()
    controller = recomputed_lqi_controller(
        source,
        gains,
        anti_windup,
        steps,
        by,
        largest_error=errors,
        largest_move=moves,
        horizon=asked.horizon,
        input_filter_time=asked.horizon,
        tracking_time=[
            linear.values[p.name] for p in linear.law.parameters if p.part == "tracking_time"
        ],
    )
    of_a_sample = "one step" if steps == 1 else f"{steps} steps"
    return lqi.described(
        found,
        controller.described("", [_NOTE]),
        f"; in every sample {of_a_sample} of the Riccati equation with the linear model at the "
        f"present state{'' if by is None else f'; {by.words}'}",
        "at the operating point ",
    )


def recomputed_lqi_controller(
    source: ProcessState,
    gains: LqiGains,
    anti_windup: AntiWindup,
    steps: int = 1,
    by: FoundFilter | None = None,
    **numbers: ArrayLike,
) -> Controller:
    """Return a recomputed LQI controller at rest at the operating point, judged by no rule.

    Parameters
    ----------
    gains : LqiGains
        To which the recursion comes at the operating point.
    by : FoundFilter, optional
        Where the source is an extended Kalman filter.
    **numbers : array_like
        largest_error, largest_move and horizon [s] of the weights, input_filter_time [s], and for
        back-calculation tracking_time [s].

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.bryson_rule import bryson_weights
    >>> from clepsydra.designs.states.linear_quadratic import lqi_gains
    >>> model = cl.load("averaging-tank").linear
    >>> errors, moves, horizons = np.array([1e3, 0.5]), np.array([0.5, 3e3]), np.array([2.0, 4.0])
    >>> gains = lqi_gains(model, bryson_weights(model, errors, moves, horizons), 0.1, 4.0)
    >>> recomputed_lqi_controller(
    ...     MeasuredState(process_equations(model)), gains, "none", largest_error=errors,
    ...     largest_move=moves, horizon=horizons, input_filter_time=5.0).measurements
    ('concentration', 'volume')
    """
    equations = source.equations
    _, doublings = steps_in_a_sample(equations)
    law = recomputed_lqi_law(source, anti_windup, doublings=doublings, steps=steps)
    cost = rounded_symmetric(gains.cost)
    state = {
        "feedback": gains.feedback,
        "integral_gain": gains.integral,
        "cost": cost[np.triu_indices(len(cost))],
    }
    controller = process_state_controller(
        NAME, FAMILY, law, source, numbers | {"size": gains.sizes}, state, by
    )
    entries = [entry for entry in law.state if isinstance(entry, Signal) and entry.matrix in _GAINS]
    rounded = rounded_numbers(entries, controller.initial_state, equations.point)
    return dataclasses.replace(controller, initial_state=rounded)


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
        places = at_share(share, states, rest[0]), at_share(share, inputs, rest[1])
        for found in (values(places[0], rest[1]), values(rest[0], places[1]), values(*places)):
            for matrix, before in zip(found, first, strict=True):
                size = float(np.abs(before).max(initial=0.0)) or 1.0
                largest = max(largest, float(np.abs(matrix - before).max(initial=0.0)) / size)
    return largest


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
    found = extended_kalman(model, equations, measurements, horizon)
    return found.observer, found


def _check_size(equations: ProcessEquations) -> None:
    count, size = len(equations.inputs), len(equations.states) + len(equations.outputs)
    if count > MOST_INPUTS:
        raise NotApplicable(
            f"it solves for {count} inputs in every sample, and takes at most {MOST_INPUTS}"
        )
    if size > MOST_STATES:
        raise NotApplicable(
            f"{size} states and integrals make {size * (size + 1) // 2} numbers of the Riccati "
            f"equation, and it takes {MOST_STATES} at most; schedule the gains by tables"
        )
