"""Nonlinear model predictive control: how far it looks ahead, and how fast it finds loads."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.nonlinear_mpc import (
    WANDERING_SHARE,
    NonlinearPredictiveStep,
    nonlinear_mpc_law,
)
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import design
from clepsydra.designs.kalman import Noise, kalman_gain, sensor_noise
from clepsydra.designs.loops.control_authority import check_ranges, control_authorities
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.sampled.steps_in_a_sample import steps_in_a_sample
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, Search, slow_down
from clepsydra.designs.states.bryson_rule import DEVIATIONS, Deviations, acceptable_deviations
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.poles import time_constants
from clepsydra.linear.process_equations import process_equations
from clepsydra.optimal_control.acting_model import ActingModel
from clepsydra.optimal_control.grid import growing_grid
from clepsydra.optimal_control.load_filter import LoadFilter
from clepsydra.optimal_control.plant_model import PlantModel
from clepsydra.optimal_control.refusal import refusal

NAME = "Nonlinear MPC"
#: Blocks of the plan: of one sample at first, and all of them.
_SINGLE, _BLOCKS = 6, 20
#: The horizon, in times of what a response takes, and the shortest one.
_AHEAD, _SHORTEST = 8.0, 2.0
_SLOWER = Search(
    4.0,
    0.05,
    True,
    "counting moves as up to {most:.0f} times as large does not bring the sensitivity peak to "
    "{limit:g}: {reached}",
    "every loop is unstable",
)


@design(
    "nonlinear_mpc",
    "nonlinear model predictive control",
    keys=(
        number("horizon", "a time", "how far it looks ahead", unit="s", example='"10 min"'),
        *DEVIATIONS,
        number(
            "move_weight", "a weight", "of the squares of moves, 0.03 if left out", example="0.03"
        ),
    ),
)
def design_nonlinear_mpc(
    model: LinearModel,
    *,
    horizon: float | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    move_weight: float = 0.03,
) -> Controller:
    """Design nonlinear model predictive control: in every sample it looks for the best inputs.

    IPOPT minimises Σ ∫ |e|/ē dt + w Δt Σ (Δu/ū)² over a horizon, on the nonlinear equations of the
    process and within the limits of its inputs; levels stay within their tanks, and nothing trips
    or runs dry, as far as that can be had. Errors below a twentieth of ē count by their squares.
    The plan has 20 blocks, which grow, and the first input of it is given out. That is what
    `clepsydra.limit` minimises, by a controller that knows the process and its limits, and no
    setpoint before it comes.

    An extended Kalman filter estimates contents, and of as many inputs as there are outputs the
    load: what is added to them without being asked for. So no error stays. Moves are made dearer
    until the sensitivity peak of the sampled loop is 2.

    It is a law in Python, for comparison: it is not exported, nor in the studies of all
    controllers. It takes some 20 ms a sample on a process of four tanks, so that a run of an hour
    with a sample a second takes a minute.

    Parameters
    ----------
    horizon : float, optional
        How far it looks ahead [s]; default eight times what a response takes: a third of all time
        constants together, or the inverse of the slowest zero in the right half-plane.
    maximum_errors : mapping, optional
        ē: what each error is divided by [its unit]; default a tenth of the range.
    maximum_moves : mapping, optional
        ū: what each move within a sample is divided by [its unit]; default the distance to the
        nearer limit.
    move_weight : float
        w: a larger one moves less, by noise too [1].

    Raises
    ------
    NotApplicable
        A level averages, the process has dead time, switches or friction, there are fewer inputs
        than outputs, the outputs do not show what has to be known, or no filter makes the loop
        robust.
    InputError
        The model has no operating point, the horizon is too short, a signal is unknown, or a
        number is not above zero.

    References
    ----------
    J. B. Rawlings, D. Q. Mayne and M. M. Diehl, Model Predictive Control: Theory, Computation, and
    Design, 2nd ed., Nob Hill 2017.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_nonlinear_mpc(cl.load("three-tanks").linear)
    >>> controller.measurements, controller.manipulated
    (('level_3',), ('feed',))
    """
    point = operating_point_of(model)
    _check_process(point, model)
    asked = acceptable_deviations(model, maximum_errors, maximum_moves)
    ahead = _horizon(horizon, model, asked.horizon)
    found = slow_down(
        lambda factor: _designed(model, asked, ahead, move_weight * factor**2),
        lambda controller: sampled_loop(controller, model).maximum_sensitivity,
        _SLOWER,
    )
    words = (
        f"Least error over {time_text(ahead)}, {asked.in_words(point.process)}; extended Kalman "
        f"filter that finds loads in {time_text(asked.horizon / WANDERING_SHARE)}, maximum "
        f"sensitivity {found.peak:.2f}."
    )
    return found.design.described(words, _note_on_moves(found.factor))


def _note_on_moves(factor: float) -> tuple[str, ...]:
    """Return a note where moves were made dearer."""
    if factor == 1.0:
        return ()
    return (
        f"Each move counts as one {factor:.3g} times as large, so that the loop keeps a "
        f"sensitivity peak of at most {SENSITIVITY_LIMIT:g}.",
    )


def _check_process(point: OperatingPoint, model: LinearModel) -> None:
    process = point.process
    judged = tuple(name for name in model.outputs if name not in process.averaging)
    if averaging := [name for name in model.outputs if name in process.averaging]:
        raise NotApplicable(f"{averaging[0]} is meant to move, not to follow a setpoint")
    if process.delayed:
        raise NotApplicable(f"the process has dead time: {', '.join(process.delayed)}")
    if reason := refusal(point, judged):
        raise NotApplicable(reason)
    if len(model.inputs) < len(model.outputs):
        raise NotApplicable("there are fewer inputs than controlled outputs")
    check_ranges(process, model.outputs, model.inputs)


def _horizon(given: float | None, model: LinearModel, response: float) -> float:
    """Return how far to look ahead [s]."""
    period = operating_point_of(model).process.sampling_period
    lags = [float(time) for time in time_constants(model) if 0.0 < time < np.inf]
    answer = max(response, sum(lags) / 3.0)
    if given is None:
        return max(_AHEAD * answer, _SINGLE * period)
    shortest = max(_SHORTEST * answer, _SINGLE * period)
    if given < shortest:
        raise InputError(
            "horizon", f"{given:g} s", f"at least {shortest:.3g} s, in which the plant answers",
            "look further ahead, or leave it out",
        )  # fmt: skip
    return given


def _designed(
    model: LinearModel, asked: Deviations, horizon: float, move_weight: float
) -> Controller:
    """Return the controller of these deviations, whose filter finds loads within their horizon."""
    point = operating_point_of(model)
    process, period = point.process, point.process.sampling_period
    errors, moves = asked.sizes()
    ends = np.array([[u.low, u.high] for u in process.inputs]).T
    plant = PlantModel(
        point, point, model.outputs, errors, (ends[0], ends[1]), point.disturbances[None, :]
    )
    acting = ActingModel(plant, model.inputs)
    low, high = acting.input_ends
    substeps, _ = steps_in_a_sample(process_equations(model))
    filter = LoadFilter(acting, period, substeps, _loaded(model, asked.horizon))
    authorities = control_authorities(point, model.inputs) / (high - low)
    samples = max(round(horizon / period), _SINGLE)
    step = NonlinearPredictiveStep(
        filter,
        growing_grid(samples, samples, period, single=_SINGLE, blocks=_BLOCKS),
        moves / (high - low),
        move_weight,
        authorities,
        asked.horizon,
        sensor_noise(process, model.outputs) / errors,
    )
    law = nonlinear_mpc_law(step)
    state = numbers_at(point, law.state) | step.begin(_covariance(step))
    values = numbers_at(point, law.parameters)
    return controller_at(point, NAME, "nonlinear MPC", law, values, state)


def _loaded(model: LinearModel, time: float) -> np.ndarray:
    """Return on which inputs a load is estimated: as many as outputs, those that act most.

    They are the pivots of the transfer matrix at 1/time, in shares of the ranges.
    """
    from scipy.linalg import qr

    signal = operating_point_of(model).process.signal
    spans = ([signal(name).span for name in names] for names in (model.outputs, model.inputs))
    outputs, inputs = (np.array(each) for each in spans)
    shifted = np.eye(len(model.A)) / time - model.A
    gains = model.C @ np.linalg.solve(shifted, model.B) / outputs[:, None] * inputs
    _, pivots = qr(gains, mode="r", pivoting=True)
    found = np.zeros(len(model.inputs), bool)
    found[pivots[: len(model.outputs)]] = True
    return found


def _covariance(step: NonlinearPredictiveStep) -> np.ndarray:
    """Return the covariance of the filter at rest, after a measurement."""
    held, _, shown = step.filter.at_rest
    kept = np.append(np.ones(len(step.filter.model.rest), bool), step.filter.loads)
    among = np.ix_(kept, kept)
    given = Noise(step.noise[among], np.diag(step.sensors**2), "")
    gained = kalman_gain(held[among], shown[:, kept], given)
    found = np.zeros_like(held)
    found[among] = gained.covariance - gained.gain @ shown[:, kept] @ gained.covariance
    return (found + found.T) / 2.0
