"""LQR with a precompensator, by Bryson's rule or by given weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.arguments.weights import WEIGHTS
from clepsydra.designs.design import Studied, design
from clepsydra.designs.kalman import (
    input_variances,
    kalman_gain,
    process_noise,
    with_wandering,
)
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.estimation import Estimation, with_loads
from clepsydra.designs.states.feedback_controller import feedback_controller, states_to_feed_back
from clepsydra.designs.states.linear_quadratic import (
    check_independent,
    lqr_gains,
    slowest_time_constant,
)
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.designs.states.quadratic_weights import (
    QuadraticWeights,
    by_weights,
    checked_weights,
)
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

NAME = "LQR with precompensator"


@design(
    "lqr",
    "LQR with a precompensator",
    Studied(210, "LQR with precompensator"),
    keys=(WEIGHTS, MEASUREMENTS, *DEVIATIONS),
)
def design_lqr(
    model: LinearModel,
    *,
    weights: QuadraticWeights | None = None,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
) -> Controller:
    """Design a linear-quadratic regulator with a precompensator for the setpoints.

    u = u° − F x + N (r − r°), with F from the Riccati equation of the process held over each
    sampling period and N from its static gain. Where sensors show every state they are fed
    back as measured; else, or with dead time, a Kalman filter estimates the states and a
    constant load at each input, which is taken off the input. Where the sensitivity peak of the
    sampled loop is above 2, the moves are made smaller by one factor until it is 2; given
    weights count that much more for the inputs.

    Parameters
    ----------
    weights : QuadraticWeights, optional
        Of the states that act on the outputs and of the inputs; default Bryson's weights.
    measurements : sequence of str, optional
        What a filter reads; naming them asks for the filter. See
        `designs.states.observed_process.observed_process`.
    maximum_errors, maximum_moves : mapping, optional
        For Bryson's weights, as for `designs.lqi.design_lqi`.

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, the measurements do not show what has to be
        known, there are no stabilising gains with any weights, or no slowing down makes the loop
        robust.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, or
        the weights do not fit the model, weigh no state, or have no stabilising gains.

    References
    ----------
    G. F. Franklin, J. D. Powell and M. Workman, Digital Control of Dynamic Systems, 3rd
    edition, Addison-Wesley 1998, chapters 8 and 9.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_lqr(cl.load("quadruple-tank").linear)
    >>> round(controller.values["pump_1.feedback.level_1"], 2)
    2.46
    """
    process = operating_point_of(model).process
    check_ranges(process, model.outputs, model.inputs)
    check_independent(model)
    observed, measured = states_to_feed_back(model, measurements)
    seen, period = observed.model, observed.period
    deviations = acceptable_deviations(seen, maximum_errors, maximum_moves)
    usual, (_, moves), horizon = deviations.weights(seen), deviations.sizes(), deviations.horizon
    basic = usual if weights is None else _given(weights, seen)
    estimation = None if measured else _filter(observed, horizon)

    def designed(factor: float) -> tuple[Controller, float]:
        found = by_weights(
            lambda each: lqr_gains(seen, each, period, horizon),
            QuadraticWeights(basic.states, basic.inputs * factor**2),
            None if weights is None else usual,
        )
        slowest = slowest_time_constant(found.eigenvalues, period)
        parts = observed, found.gain, moves, slowest, estimation
        return feedback_controller(NAME, *parts), slowest

    found = slow_down(designed, lambda design: sensitivity_peak(design[0], model))
    controller, slowest = found.design
    by = "given weights"
    if weights is None:
        by = f"Bryson's weights, {deviations.slower(found.factor).in_words(process)}"
    estimated = "" if estimation is None else f"; Kalman filter for {estimation.names}"
    return controller.described(
        f"LQR with {by}{estimated}; slowest closed-loop time constant {time_text(slowest)}, "
        f"sensitivity peak {found.peak:.2f}.",
        note_on_slowing(found, "the regulator"),
        found.factor,
    )


def _given(weights: QuadraticWeights, model: LinearModel) -> QuadraticWeights:
    """Return weights that a user gave, if a regulator without integrals can come of them."""
    checked_weights(weights, model)
    if weights.integrals is not None:
        expected = "weights of states and inputs alone: this regulator has no integrals"
        remedy = "remove them, or choose LQI by given weights"
        raise InputError("weights, integrals", "weights of integrals", expected, remedy)
    if not np.any(weights.states):
        expected = f"a weight above 0 for one or more of {', '.join(model.states)}"
        remedy = "add it: without one the regulator does best by doing nothing"
        raise InputError("weights, states", Finding("no weight above 0"), expected, remedy)
    return weights


def _filter(observed: ObservedProcess, horizon: float) -> Estimation:
    """Return the Kalman filter of the states and of a load at each input that wanders."""
    noise = process_noise(observed, horizon)
    whole = with_loads(observed)
    # In the horizon a load wanders as far as an input is unsure of itself.
    whole_noise = with_wandering(noise, input_variances(observed), observed.period, horizon)
    found = kalman_gain(whole.held, whole.shown, whole_noise)
    return Estimation.of(whole, found.gain)
