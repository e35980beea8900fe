"""LQI with weights that the user gives."""

from __future__ import annotations

import math

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.weights import WEIGHTS
from clepsydra.designs.design import design
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.slowing_down import note_on_peak
from clepsydra.designs.states.bryson_rule import acceptable_deviations
from clepsydra.designs.states.linear_quadratic import (
    ANTI_WINDUP,
    lqi_gains,
    slowest_time_constant,
)
from clepsydra.designs.states.measured_states import measurements_of_states, of_measurements
from clepsydra.designs.states.quadratic_weights import (
    QuadraticWeights,
    by_weights,
    checked_weights,
)
from clepsydra.designs.states.robust_lqi import check_lqi
from clepsydra.designs.states.state_controllers import lqi_controller, sensitivity_peak
from clepsydra.linear.linear_model import LinearModel


@design(
    "lqi_by_weights",
    "LQI by given weights",
    keys=(WEIGHTS, ANTI_WINDUP),
    method="LQI",
)
def design_lqi_by_weights(
    model: LinearModel,
    weights: QuadraticWeights,
    *,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control with given weights.

    The gains minimise ∫ xᵀ Q x + uᵀ R u dt + Δt Σ wᵀ W w for the process held over each
    sampling period. They are used as they come out; the notes say where the loop's sensitivity
    peak is above 2.

    Parameters
    ----------
    weights : QuadraticWeights
        Of its states, inputs and of the integrals of its outputs, see also `diagonal_weights`.
    anti_windup : {"back_calculation", "conditional_integration", "none"}

    Returns
    -------
    Controller
        All states' measurements in the order of the states.

    Raises
    ------
    NotApplicable
        The process has dead time, a state is not measured, there are no stabilising gains with
        any weights, or the loop is unstable.
    InputError
        The weights do not fit the model, those of the integrals are missing, or these weights
        have no stabilising gains.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.quadratic_weights import diagonal_weights
    >>> model = cl.load("three-tanks").linear
    >>> weights = diagonal_weights(model, {"tank_3.level": 1.0}, {"feed": 1e6}, {"level_3": 1e-5})
    >>> controller = design_lqi_by_weights(model, weights)
    >>> controller.measurements
    ('level_1', 'level_2', 'level_3')
    """
    period = check_sampling_period(model)
    check_lqi(model, model.delays)
    checked_weights(weights, model)
    if weights.integrals is None:
        expected = f"weights for the integrals of {', '.join(model.outputs)}"
        remedy = f"add integrals, a number above 0 for each, as in {{ {model.outputs[0]} = 1e-4 }}"
        raise InputError("weights, integrals", Finding("no integrals"), expected, remedy)
    measurements = measurements_of_states(model)
    usual = acceptable_deviations(model, None, None)
    gains = by_weights(
        lambda each: lqi_gains(model, each, period, usual.horizon), weights, usual.weights(model)
    )
    slowest = slowest_time_constant(gains.eigenvalues, period)
    feedback = of_measurements(model, measurements, gains.feedback)
    parts = measurements, feedback, gains.integral, max(slowest, period), anti_windup
    controller = lqi_controller("LQI, weights", model, *parts)
    peak = sensitivity_peak(controller, model)
    if math.isinf(peak):
        raise NotApplicable("the sampled loop with its gains is unstable")
    return controller.described(
        f"LQI with given weights; slowest closed-loop time constant {time_text(slowest)}, "
        f"sensitivity peak {peak:.2f}.",
        note_on_peak(peak, "weigh the inputs more"),
    )
