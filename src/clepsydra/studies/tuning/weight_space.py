"""The space of the weights of LQI: the gains follow from them by the Riccati equation.

M. Kolankowski and R. Piotrowski, Design of Three Control Algorithms for an Averaging Tank with
Variable Filling, 2022, equations (99) to (101).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.batch import BatchEvaluation
from clepsydra.studies.tuning.design_space import DesignSpace
from clepsydra.studies.tuning.lqi_weights import LqiWeights, WeightedDesign
from clepsydra.studies.tuning.parameters import TunedParameter

#: How far a weight may move from where it starts, up and down.
FACTOR = 1e3
#: Without other limits an input may move so many times as much as at the start.
_WEAR = 2.0


def weight_space(
    start: WeightedDesign, parameters: Sequence[TunedParameter] | None = None
) -> DesignSpace:
    """Return the space of some weights of a design, or of all but the first integral's.

    A weight is named "states.tank_1.level", "inputs.pump_1" or "integrals.level_1", its bounds are
    in 1 / SI unit²; each may become a thousand times as large or as small where none are given.

    Raises
    ------
    InputError
        A weight is unknown, its bounds are not above zero, or the start lies outside of them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.tuning.weighted_designs import lqi_by_bryson
    >>> space = weight_space(lqi_by_bryson(cl.load("three-tanks").linear))
    >>> [parameter.name for parameter in space.parameters]
    ['states.tank_3.level', 'inputs.feed']
    """
    design = LqiWeights(start)
    if parameters is None:
        kept = f"integrals.{start.model.outputs[0]}"
        parameters = weights_around(
            {name: value for name, value in design.numbers.items() if name != kept}
        )
    space = DesignSpace(start.controller, parameters, design)
    for parameter in parameters:
        if not parameter.low > 0.0:
            raise InputError(
                f"tuning, {parameter.name}", parameter.low, "a lowest weight above 0",
                "raise the low bound",
            )  # fmt: skip
    return space


def weights_around(
    weights: Mapping[str, float], factor: float = FACTOR
) -> tuple[TunedParameter, ...]:
    """Return weights that may move by a factor up and down, in logarithmic steps.

    Raises
    ------
    InputError
        A weight is not above zero, or the factor is not above 1.

    Examples
    --------
    >>> (weight,) = weights_around({"inputs.pump_1": 0.5}, 10.0)
    >>> weight.low, weight.high
    (0.05, 5.0)
    """
    if not is_finite_number(factor) or not factor > 1.0:
        raise InputError("tuning, factor", factor, "a number above 1", "1000 is customary")
    for name, value in weights.items():
        if not is_finite_number(value) or not value > 0.0:
            raise InputError(
                f"tuning, {name}", value, "a weight above 0", "give it one, or leave it out"
            )
    return tuple(
        TunedParameter(name, value / factor, value * factor) for name, value in weights.items()
    )


def usual_wear(controller: Controller, model: LinearModel, scenario: Scenario) -> dict[str, float]:
    """Return twice the total variation that a controller makes of each input in a scenario.

    An input that does not move at all has no limit.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> model = cl.load("three-tanks").linear
    >>> list(usual_wear(design_lqi(model), model, default_scenario(model)))
    ['feed']
    """
    names = [f"total_variation[{name}]" for name in controller.manipulated]
    found = BatchEvaluation(controller, model, [scenario], names).run({})
    moved = (
        (name, float(found.scores[score][0]))
        for name, score in zip(controller.manipulated, names, strict=True)
    )
    return {name: _WEAR * value for name, value in moved if value > 0.0}
