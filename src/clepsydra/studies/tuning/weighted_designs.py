"""LQI designs whose weights can be tuned, each with the weights that it starts from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.designs.lqi import weighed_lqi
from clepsydra.designs.lqi_by_weights import design_lqi_by_weights
from clepsydra.designs.states.bryson_rule import acceptable_deviations
from clepsydra.designs.states.linear_quadratic import LqiGains, slowest_time_constant
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.designs.states.robust_lqi import tracking_times
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.studies.tuning.lqi_weights import WeightedDesign


def lqi_by_bryson(
    model: LinearModel,
    *,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
) -> WeightedDesign:
    """Return LQI by Bryson's rule with its weights; all as for `designs.lqi.design_lqi`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> lqi_by_bryson(cl.load("quadruple-tank").linear).controller.name
    'LQI, Bryson'
    """
    found = weighed_lqi(model, maximum_errors, maximum_moves, anti_windup)
    times = partial(_as_pi, found.model, found.controller.measurements, found.horizon)
    return WeightedDesign(found.controller, found.model, found.weights, found.horizon, times)


def lqi_of_weights(
    model: LinearModel,
    weights: QuadraticWeights,
    *,
    anti_windup: AntiWindup = "back_calculation",
) -> WeightedDesign:
    """Return LQI by given weights; all as for `designs.lqi_by_weights.design_lqi_by_weights`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.quadratic_weights import diagonal_weights
    >>> model = cl.load("three-tanks").linear
    >>> weights = diagonal_weights(model, {"tank_3.level": 1.0}, {"feed": 1e6}, {"level_3": 1e-5})
    >>> lqi_of_weights(model, weights).controller.name
    'LQI, weights'
    """
    controller = design_lqi_by_weights(model, weights, anti_windup=anti_windup)
    horizon = acceptable_deviations(model, None, None).horizon
    period = operating_point_of(model).process.sampling_period
    times = partial(_slowest, period, len(model.inputs))
    return WeightedDesign(controller, model, weights, horizon, times)


def _as_pi(
    model: LinearModel,
    measurements: tuple[str, ...],
    horizon: float,
    feedback: np.ndarray,
    gains: LqiGains,
) -> list[float]:
    return tracking_times(model, measurements, feedback, gains.integral, horizon)


def _slowest(period: float, inputs: int, feedback: np.ndarray, gains: LqiGains) -> list[float]:
    return [max(slowest_time_constant(gains.eigenvalues, period), period)] * inputs


#: By the names of the designs in a study file; arguments as those of the designs.
WEIGHTED_DESIGNS: dict[str, Callable[..., WeightedDesign]] = {
    "lqi": lqi_by_bryson,
    "lqi_by_weights": lqi_of_weights,
}
