"""LQI whose weights are tuned by simulation."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.batch import BatchEvaluation
from clepsydra.studies.tuning.design_space import DesignSpace
from clepsydra.studies.tuning.lqi_weights import LqiWeights, WeightedDesign
from clepsydra.studies.tuning.objective import Limits, Objective, minimax
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search import GENERATIONS, Progress, scenarios_of, search
from clepsydra.studies.tuning.weighted_designs import lqi_by_bryson, lqi_of_weights

#: How far a weight may move from where it starts, up and down.
FACTOR = 1e3
#: Without other limits an input may move so many times as much as at the start.
_WEAR = 2.0
#: A lowest weight this near counts as reached, a share of it.
_BINDS = 1e-2


def tuned_lqi(
    model: LinearModel,
    scenario: Scenario | Sequence[Scenario],
    *,
    weights: QuadraticWeights | None = None,
    parameters: Sequence[TunedParameter] | None = None,
    objective: Objective | None = None,
    limits: Limits | None = None,
    anti_windup: AntiWindup = "back_calculation",
    generations: int = GENERATIONS,
    seed: int = 1,
    front: Sequence[float] = (),
    progress: Callable[[Progress], None] | None = None,
    state_file: str | Path | None = None,
) -> TuningResult:
    """Tune the weights of LQI; its gains follow from them by the Riccati equation.

    Only ratios of weights count, so that one of them, that of the first integral, is kept.
    With cheaper inputs every index of the error alone gets smaller, without end: a limit of
    max|S|, of the total variation or the bound of an input's weight ends it, and the notes say
    where it was that bound.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point, from its inputs to the outputs with setpoints.
    scenario : Scenario or sequence of Scenario
        As for `clepsydra.studies.tuning.tune.tune`.
    weights : QuadraticWeights, optional
        The start; Bryson's weights if omitted. A weight of zero stays zero.
    parameters : sequence of TunedParameter, optional
        Weights with their bounds [1 / SI unit²], by names as "states.tank_1.level",
        "inputs.pump_1" and "integrals.level_1"; the others stay as they start. If omitted, each
        but the first integral's may become a thousand times as large or as small.
    objective : Objective, optional
        The largest IAE of the outputs, each relative to the start, if omitted.
    limits : Limits, optional
        If omitted, max|S| at most 2 and total variations of twice those of the start.
    anti_windup : {"back_calculation", "conditional_integration", "none"}
    generations, seed, front, progress, state_file
        As for `tune`.

    Returns
    -------
    TuningResult
        Its `tuned` are the weights found.

    Raises
    ------
    NotApplicable
        LQI does not apply to the process, or no weights keep the limits.
    InputError
        A weight is unknown or zero, its bounds are wrong, or as `tune`.

    References
    ----------
    M. Kolankowski and R. Piotrowski, Design of Three Control Algorithms for an Averaging Tank
    with Variable Filling, 2022, equations (99) to (101).

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> model = cl.load("three-tanks").linear
    >>> found = tuned_lqi(model, default_scenario(model), generations=1)
    >>> found.objective < 0.9, list(found.tuned)
    (True, ['states.tank_3.level', 'inputs.feed'])
    """
    model_remedy = "take that of an analysis, or make it with linearise"
    require_type(model, LinearModel, "model", "a LinearModel", model_remedy)
    start = (
        lqi_by_bryson(model, anti_windup=anti_windup)
        if weights is None
        else lqi_of_weights(model, weights, anti_windup=anti_windup)
    )
    return tuned_weights(
        start,
        scenario,
        parameters=parameters,
        objective=objective,
        limits=limits,
        generations=generations,
        seed=seed,
        front=front,
        progress=progress,
        state_file=state_file,
    )


def tuned_weights(
    start: WeightedDesign,
    scenario: Scenario | Sequence[Scenario],
    *,
    parameters: Sequence[TunedParameter] | None = None,
    objective: Objective | None = None,
    limits: Limits | None = None,
    generations: int = GENERATIONS,
    seed: int = 1,
    front: Sequence[float] = (),
    progress: Callable[[Progress], None] | None = None,
    state_file: str | Path | None = None,
) -> TuningResult:
    """Tune the weights of a design that was made before; all as for `tuned_lqi`.

    Examples
    --------
    See `tuned_lqi`.
    """
    space = weight_space(start, parameters)
    whole = linearise(operating_point_of(start.model))
    if limits is None:
        limits = Limits(
            SENSITIVITY_LIMIT, total_variation=usual_wear(start.controller, whole, scenario)
        )
    if objective is None:
        objective = minimax(*(f"iae[{name}]" for name in start.controller.setpoints))
    found = search(
        space,
        whole,
        scenario,
        objective,
        limits=limits,
        generations=generations,
        seed=seed,
        front=front,
        progress=progress,
        state_file=state_file,
    )
    notes = (*found.controller.notes, *_notes(space, found))
    return dataclasses.replace(found, controller=dataclasses.replace(found.controller, notes=notes))


def weight_space(
    start: WeightedDesign, parameters: Sequence[TunedParameter] | None = None
) -> DesignSpace:
    """Return the space of some weights of a design, or of all but the first integral's.

    Raises
    ------
    InputError
        A weight is unknown, its bounds are not above zero, or the start lies outside of them.

    Examples
    --------
    >>> import clepsydra as cl
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
    parameters = sequence_of(
        parameters, TunedParameter, "tuning, parameters", "a list of TunedParameter",
        "make them, as by weights_around(weights)",
    )  # fmt: skip
    for parameter in parameters:
        if not parameter.low > 0.0:
            raise InputError(
                f"tuning, {parameter.name}", parameter.low, "a lowest weight above 0",
                "raise the low bound",
            )  # fmt: skip
    return DesignSpace(start.controller, tuple(parameters), design)


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


def usual_wear(
    controller: Controller, model: LinearModel, scenario: Scenario | Sequence[Scenario]
) -> dict[str, float]:
    """Return twice the total variation that a controller makes of each input in a scenario.

    An input that does not move at all has no limit.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> model = cl.load("three-tanks").linear
    >>> list(usual_wear(design_lqi(model), model, default_scenario(model)))
    ['feed']
    """
    names = [f"total_variation[{name}]" for name in controller.manipulated]
    found = BatchEvaluation(controller, model, scenarios_of(scenario), names).run({})
    moved = (
        (name, float(found.scores[score][0]))
        for name, score in zip(controller.manipulated, names, strict=True)
    )
    return {name: _WEAR * value for name, value in moved if value > 0.0}


def _notes(space: DesignSpace, found: TuningResult) -> tuple[str, ...]:
    """Return what is to be known of the weights that were found."""
    notes = []
    numbers = space.design.numbers
    kept = [f"{name} = {value:.4g}" for name, value in numbers.items() if name not in found.tuned]
    if kept:
        why = ", since only ratios of weights count" if len(kept) == 1 else ""
        notes.append(f"Kept as it was: weight of {', '.join(kept)}{why}.")
    cheapest = [
        p.name
        for p in space.parameters
        if p.name.startswith("inputs.") and found.tuned[p.name] <= p.low * (1.0 + _BINDS)
    ]
    if cheapest:
        notes.append(
            f"The lowest weight allowed of {' and '.join(cheapest)} chose how fast it moves, not "
            "the objective, which cheaper moves lower further: limit the total variation."
        )
    return tuple(notes)
