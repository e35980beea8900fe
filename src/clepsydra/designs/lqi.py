"""LQI with weights by Bryson's rule."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.design import Studied, design
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import ANTI_WINDUP, LqiGains
from clepsydra.designs.states.measured_states import measurements_of_states, without_idle_states
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.designs.states.robust_lqi import StateLqi, check_lqi, tracking_times
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.linear.linear_model import LinearModel

NAME = "LQI, Bryson"


@design(
    "lqi",
    "LQI from measured states, by Bryson's rule",
    Studied(160, NAME),
    keys=(*DEVIATIONS, ANTI_WINDUP),
    method="LQI",
)
def design_lqi(
    model: LinearModel,
    *,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> Controller:
    """Design LQI control with weights by Bryson's rule.

    The horizon T for which a largest error may last is a third of the slowest time constant
    of the model (a tank that integrates has none and is passed over), or 1/z of its slowest
    zero z in the right half-plane where that is longer: no controller removes an error sooner.
    Of a tank that only integrates it is the time in which the largest moves make the largest
    error. The gains are optimal for the process held over each sampling period
    (`designs.states.linear_quadratic`), however long that is. Where the sensitivity peak of the
    loop is above 2, moves are made smaller and the horizon longer by one factor until it is 2.

    Parameters
    ----------
    maximum_errors : mapping, optional
        Output name to its largest acceptable error [measurement unit]; default a tenth of the
        range.
    maximum_moves : mapping, optional
        Input name to its largest acceptable deviation from the operating point [input unit];
        default the distance to the nearer limit.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
        With conditional integration it is input-constrained LQI.

    Returns
    -------
    Controller
        All states' measurements in the order of the states; states that act on no output are
        left out.

    Raises
    ------
    NotApplicable
        The process has dead time, a state is not measured, there are no stabilising gains, or
        one is outside of what a controller takes.
    InputError
        The model has no operating point, a mapping names an unknown signal, a deviation is
        not above zero, or the anti-windup is unknown.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = design_lqi(cl.load("quadruple-tank").linear)
    >>> round(controller.values["pump_1.integral_gain.level_1"], 3)
    0.093
    """
    return weighed_lqi(model, maximum_errors, maximum_moves, anti_windup).controller


class WeighedLqi(NamedTuple):
    """An LQI controller, and the weights that made it.

    Parameters
    ----------
    model : LinearModel
        Whose states and inputs are weighed.
    weights : QuadraticWeights
        With those of the integrals.
    horizon : float
        T, about how long a response takes [s].
    tracking_times : callable
        (feedback [m, measurements], gains) → one for each input [s].
    """

    controller: Controller
    model: LinearModel
    weights: QuadraticWeights
    horizon: float
    tracking_times: Callable[[np.ndarray, LqiGains], list[float]]


def weighed_lqi(
    model: LinearModel,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> WeighedLqi:
    """Return the controller of `design_lqi` with its weights, from where others may be tuned.

    Parameters
    ----------
    model, maximum_errors, maximum_moves, anti_windup
        As for `design_lqi`.

    Raises
    ------
    NotApplicable, InputError
        As `design_lqi`.

    Examples
    --------
    A tenth of the range of 0 to 10 V is an acceptable error, so that the output weighs 1/V²:

    >>> import clepsydra as cl
    >>> found = weighed_lqi(cl.load("quadruple-tank").linear)
    >>> found.weights.states.diagonal()  # C is 50 V/m
    array([2500., 2500.,    0.,    0.])
    """
    period = check_sampling_period(model)
    check_lqi(model, model.delays)
    model = without_idle_states(model)
    measurements = measurements_of_states(model)
    deviations = acceptable_deviations(model, maximum_errors, maximum_moves)
    lqi = StateLqi(NAME, model, deviations, measurements, anti_windup)
    if math.isinf(sensitivity_peak(lqi.slower(1.0).controller, model)):
        raise NotApplicable(
            "the sampled loop with its gains is unstable: they cannot be computed well enough "
            f"at a sampling period of {period:g} s"
        )
    found = lqi.robust(model)
    controller, _, asked = found.design

    def times(feedback: np.ndarray, gains: LqiGains) -> list[float]:
        read = controller.measurements
        return tracking_times(model, read, feedback, gains.integral, asked.horizon)

    described, weights = lqi.described(found, controller), asked.weights(model)
    return WeighedLqi(described, model, weights, asked.horizon, times)
