"""The tuning that a study makes of a PID controller, where nothing else is asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.objective import Limits, Objective, minimax
from clepsydra.studies.tuning.parameters import TunedParameter, around
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search import GENERATIONS, METHOD, Progress
from clepsydra.studies.tuning.tune import tune

#: How far gains and integral times may move from where they start, up and down.
_FACTOR = 10.0
_TUNED = ("proportional_gain", "integral_time", "integral_gain")


def tuned_pid(
    controller: Controller,
    model: LinearModel,
    scenario: Scenario,
    *,
    objective: Objective | None = None,
    limits: Limits | None = None,
    generations: int = GENERATIONS,
    seed: int = 1,
    front: Sequence[float] = (),
    progress: Callable[[Progress], None] | None = None,
    state_file: str | Path | None = None,
) -> TuningResult:
    """Tune the gains and integral times of a multiloop PI or PID controller.

    Each may become ten times as large or as small.

    Parameters
    ----------
    controller : Controller
        Designed by a rule.
    objective : Objective, optional
        The largest IAE of the controlled variables, each relative to the start, if omitted.
    limits : Limits, optional
        max|S| at most 2 if omitted.
    model, scenario, generations, seed, front, progress, state_file
        As for `clepsydra.studies.tuning.tune.tune`.

    Raises
    ------
    NotApplicable
        The law has neither proportional gain nor integral time, or nothing keeps max|S| at 2.
    InputError
        As `tune`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("three-tanks")
    >>> scenario = default_scenario(plant.linear)
    >>> found = tuned_pid(cl.design.simc(plant), plant.linear, scenario, generations=5)
    >>> found.objective < 0.9, found.maximum_sensitivity < 2.00001
    (True, True)
    """
    require_type(controller, Controller, "controller", "a Controller", "design one, or make one")
    if objective is None:
        objective = minimax(*(f"iae[{name}]" for name in dict.fromkeys(controller.setpoints)))
    return tune(
        controller,
        model,
        scenario,
        gains_and_times(controller),
        objective,
        limits=Limits(SENSITIVITY_LIMIT) if limits is None else limits,
        generations=generations,
        seed=seed,
        front=front,
        progress=progress,
        state_file=state_file,
    )


def gains_and_times(controller: Controller) -> tuple[TunedParameter, ...]:
    """Return gains and integral times of a law, each within a factor of ten.

    Raises
    ------
    NotApplicable
        It has neither.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [p.name for p in gains_and_times(cl.design.simc(cl.load("three-tanks")))]
    ['level_3.proportional_gain', 'level_3.integral_time']
    """
    names = [
        parameter.name
        for parameter in controller.law.parameters
        if parameter.part in _TUNED and controller.values[parameter.name] != 0.0
    ]
    if not names:
        raise NotApplicable(METHOD, f"{controller.name} has no gain and no integral time to tune")
    return around(controller, names, _FACTOR)
