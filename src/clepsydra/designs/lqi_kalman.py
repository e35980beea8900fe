"""LQI with a Kalman filter: for states that no sensor shows, and for dead time."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.bryson import (
    acceptable_deviations,
    refuse_more_inputs,
    slowest_time_constant,
)
from clepsydra.designs.kalman import kalman_gain, process_noise
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.linear_quadratic import bryson_weights, lqi_gains_by_weights
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.slowing_down import note_on_slowing, slow_down
from clepsydra.designs.states.state_controllers import lqi_controller, sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

NAME = "LQI with Kalman filter"


def design_lqi_kalman(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control of states that a Kalman filter estimates.

    The regulator is that of `designs.bryson.design_lqi`, the filter follows from the noise of
    `designs.kalman.process_noise`. The filter estimates the states only: under a constant load
    its estimate has a bias, which the integrators take up, since they integrate the measured
    errors. A load estimated in addition would be a second integrator for the same purpose.
    With dead time what is on its way is estimated too, so that the law predicts what a change
    will do before it shows.

    With an observer the margins of the regulator are lost (Doyle 1978), so that the regulator
    is slowed down by one factor until the sensitivity peak of the whole sampled loop is 2.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs follow the setpoints.
    measurements : sequence of str, optional
        What the filter reads, with the controlled outputs among them; default the controlled
        outputs alone where sensors show every state, else all sensors of use
        (`designs.states.observed_process`).
    maximum_errors, maximum_moves, anti_windup
        As for `designs.bryson.design_lqi`.

    Returns
    -------
    Controller

    Raises
    ------
    NotApplicable
        The measurements do not show what has to be known, too much would have to be estimated,
        there are no stabilising gains, or no slowing down makes the loop robust.
    InputError
        The model has no operating point, a signal is unknown, a deviation is not above zero, or
        the anti-windup is unknown.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 11.

    Examples
    --------
    The last of eight tanks is measured and seven are estimated:

    >>> import clepsydra as cl
    >>> model = cl.load("three-tanks").linear
    >>> controller = design_lqi_kalman(model, measurements=["level_3"])
    >>> states = [name for name in controller.initial_state if name.endswith(".estimate")]
    >>> controller.measurements, len(states)
    (('level_3',), 3)
    """
    process = operating_point_of(model).process
    refuse_more_inputs(model, NAME)
    check_ranges(process, model.outputs, model.inputs, NAME)
    observed = observed_process(model, measurements, NAME)
    seen, period = observed.model, observed.period
    deviations = acceptable_deviations(seen, maximum_errors, maximum_moves, NAME)
    noise = process_noise(observed, deviations.horizon)
    found_filter = kalman_gain(observed.held, observed.shown, noise)
    estimation = Estimation(
        observed.estimated, observed.held, observed.moved, observed.shown, found_filter.gain
    )

    def designed(factor: float) -> tuple[Controller, np.ndarray]:
        asked = deviations.slower(factor)
        weights = bryson_weights(seen, *asked.sizes(), asked.horizon)
        gains = lqi_gains_by_weights(seen, weights, period, asked.horizon, NAME)
        controller = lqi_controller(
            NAME,
            seen,
            observed.measurements,
            gains.feedback,
            gains.integral,
            [asked.horizon] * len(seen.inputs),
            anti_windup,
            estimation,
        )
        return controller, gains.eigenvalues

    found = slow_down(designed, lambda design: sensitivity_peak(design[0], model), NAME)
    controller, eigenvalues = found.design
    asked = deviations.slower(found.factor)
    names = ", ".join(signal.name for signal in observed.estimated)
    slowest = [
        slowest_time_constant(each, period) for each in (eigenvalues, estimation.error_poles)
    ]
    return dataclasses.replace(
        controller,
        design=(
            "LQI with Bryson's weights, "
            f"{asked.in_words(process)}, an error lasting at most {time_text(asked.horizon)}; "
            f"Kalman filter for {names}, {noise.words}; slowest time constants "
            f"{time_text(slowest[0])} of the regulator and {time_text(slowest[1])} of the filter, "
            f"sensitivity peak {found.peak:.2f}."
        ),
        notes=(*controller.notes, *note_on_slowing(found, "the regulator")),
        slowed=found.factor,
    )
