"""Tuning by simulation: the parameters of any step law, on the process's own equations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.objective import Limits, Objective
from clepsydra.studies.tuning.parameters import LawSpace, TunedParameter
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search import GENERATIONS, Progress, search


def tune(
    controller: Controller,
    model: LinearModel,
    scenario: Scenario | Sequence[Scenario],
    parameters: Sequence[TunedParameter],
    objective: Objective,
    *,
    limits: Limits | None = None,
    generations: int = GENERATIONS,
    seed: int = 1,
    front: Sequence[float] = (),
    progress: Callable[[Progress], None] | None = None,
    state_file: str | Path | None = None,
) -> TuningResult:
    """Find the parameter values whose simulated loop scores best and keeps some limits.

    First differential evolution looks everywhere between the bounds, then sequential quadratic
    programming goes from the best to the minimum near it. Candidates are simulated in batches
    on the engine; max|S| is that of the sampled loop, exact. The same seed gives the same result.

    Parameters
    ----------
    controller : Controller
        Of any family; its values are the start.
    model : LinearModel
        Of the process at the operating point where the scenario begins, with every measurement
        that the controller reads.
    scenario : Scenario or sequence of Scenario
        Over several the scores add up, the overshoot is the largest.
    parameters : sequence of TunedParameter
    objective : Objective
        `objective.minimax` or `objective.weighted_sum`.
    limits : Limits, optional
        None if omitted. A tank that runs empty or over, a pump that runs dry and a trip are never
        let pass, unless they happen at the start as well.
    generations : int
        Of the global search, at most; 0 for the local search alone.
    seed : int
        Of the global search.
    front : sequence of float
        Bounds of max|S| at which the Pareto front is refined.
    progress : callable, optional
        Takes a `Progress` after each batch.
    state_file : str or Path, optional
        Where everything computed is kept, now and then and at the end or an interruption
        (control-C), which returns the best so far. Called again with the same arguments it
        goes on, and ends as it would have without the break.

    Raises
    ------
    InputError
        A bound, a name, a limit or the start cannot be used, or the state file is of another
        problem.
    NotApplicable
        No candidate keeps the limits.

    Examples
    --------
    Two gains and two integral times of the quadruple tank, for the IAE of both levels:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.studies.tuning.objective import minimax
    >>> from clepsydra.studies.tuning.parameters import around
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> start = cl.design.simc(plant)
    >>> found = tune(start, plant.linear, default_scenario(plant.linear),
    ...              around(start, ["level_1.proportional_gain", "level_1.integral_time"], 3.0),
    ...              minimax("iae[level_1]", "iae[level_2]"), limits=Limits(2.0), generations=1)
    >>> found.objective < 1.0, found.maximum_sensitivity < 2.00001
    (True, True)
    """
    require_type(controller, Controller, "controller", "a Controller", "design one, or make one")
    parameters = sequence_of(
        parameters, TunedParameter, "tuning, parameters", "a list of TunedParameter",
        "make them, as by around(controller, [names])",
    )  # fmt: skip
    return search(
        LawSpace(controller, tuple(parameters)),
        model,
        scenario,
        objective,
        limits=limits,
        generations=generations,
        seed=seed,
        front=front,
        progress=progress,
        state_file=state_file,
    )
