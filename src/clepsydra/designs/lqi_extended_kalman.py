"""LQI with an extended Kalman filter: states estimated by the process's own equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import FAMILY, lqi_law_of
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.design import Studied, design
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import ANTI_WINDUP
from clepsydra.designs.states.process_filter import (
    acting_model,
    extended_kalman,
    process_state_controller,
)
from clepsydra.designs.states.robust_lqi import StateLqi, check_lqi
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.process_equations import process_equations

NAME = "LQI with extended Kalman filter"


@design(
    "lqi_extended_kalman",
    "LQI with an extended Kalman filter",
    Studied(180, NAME),
    keys=(MEASUREMENTS, *DEVIATIONS, ANTI_WINDUP),
)
def design_lqi_extended_kalman(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control of states that an extended Kalman filter estimates.

    The regulator is that of `designs.lqi.design_lqi` for the operating point. The filter runs
    the equations of the process, so that its estimate holds away from the operating point too,
    and computes its gain as it goes. Its noise is that of `designs.kalman.process_noise`. At rest
    at the operating point it is the Kalman filter there; the regulator is slowed down by one
    factor until the sensitivity peak of that sampled loop is 2.

    Parameters
    ----------
    measurements, maximum_errors, maximum_moves, anti_windup
        As for `designs.lqi_kalman.design_lqi_kalman`.

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
    check_lqi(model, process.delayed, "its equations have")
    equations = process_equations(model)
    acting = acting_model(model, equations)
    deviations = acceptable_deviations(acting, maximum_errors, maximum_moves)
    by = extended_kalman(model, equations, measurements, deviations.horizon)
    measured = by.observer.measurements
    lqi = StateLqi(NAME, acting, deviations, measured, anti_windup, by.estimation)
    found = lqi.robust(model)
    law, (_, gains, asked) = lqi_law_of(by.observer, anti_windup), found.design
    numbers: Mapping[str, ArrayLike] = {
        "feedback": gains.feedback,
        "integral_gain": gains.integral,
        "tracking_time": asked.horizon,
    }
    controller = process_state_controller(NAME, FAMILY, law, by.observer, numbers, {}, by)
    how, where = f"; {by.words}", "at the operating point "
    return lqi.described(found, controller, how, where, of_filter=True)
