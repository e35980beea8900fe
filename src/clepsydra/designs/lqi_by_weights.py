"""LQI with weights that the user gives."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.bryson import (
    acceptable_deviations,
    refuse_more_inputs,
    slowest_time_constant,
)
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.states.linear_quadratic import METHOD, lqi_gains, lqi_gains_by_weights
from clepsydra.designs.states.measured_states import measurements_of_states, with_outputs
from clepsydra.designs.states.quadratic_weights import (
    QuadraticWeights,
    checked_weights,
    of_weights,
)
from clepsydra.designs.states.state_controllers import lqi_controller, sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of


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
    model : LinearModel
        Of a process at an operating point; its outputs follow the setpoints.
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
    if model.delays is not None:
        raise NotApplicable(
            METHOD, "the process has dead time, and its law has no states for what is on its way"
        )
    refuse_more_inputs(model, METHOD)
    check_ranges(operating_point_of(model).process, model.outputs, model.inputs, METHOD)
    checked_weights(weights, model)
    if weights.integrals is None:
        raise InputError(
            "weights, integrals",
            "no integrals",
            f"weights for the integrals of {', '.join(model.outputs)}",
            f"add integrals, a number above 0 for each, as in {{ {model.outputs[0]} = 1e-4 }}",
        )
    measurements = measurements_of_states(model, METHOD)
    usual = acceptable_deviations(model, None, None, METHOD)
    try:
        gains = lqi_gains_by_weights(model, weights, period, usual.horizon)
    except NotApplicable as refusal:
        # Whose fault it is tell the usual weights: where these work, it is that of those given.
        lqi_gains(model, *usual.sizes(), usual.horizon, period)
        raise of_weights(refusal) from None
    feedback = np.linalg.solve(with_outputs(model, measurements).C.T, gains.feedback.T).T
    slowest = slowest_time_constant(gains.eigenvalues, period)
    controller = lqi_controller(
        "LQI, weights",
        model,
        measurements,
        feedback,
        gains.integral,
        [max(slowest, period)] * len(model.inputs),
        anti_windup,
    )
    peak = sensitivity_peak(controller, model)
    if math.isinf(peak):
        raise NotApplicable(METHOD, "the sampled loop with its gains is unstable")
    notes = controller.notes
    if peak > SENSITIVITY_LIMIT:
        notes = (
            *notes,
            f"The sensitivity peak is {peak:.2f}, above {SENSITIVITY_LIMIT:g}: weigh "
            "the inputs more.",
        )
    return dataclasses.replace(
        controller,
        design=(
            f"LQI with given weights; slowest closed-loop time constant {time_text(slowest)}, "
            f"sensitivity peak {peak:.2f}."
        ),
        notes=notes,
    )
