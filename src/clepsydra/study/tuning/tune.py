"""Tuning by simulation: the parameters of any step law, on the process's own equations."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.design.applicability import NotApplicable
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.running_scores import split_score
from clepsydra.loop.scenario import Scenario
from clepsydra.study.tuning.global_search import search_globally
from clepsydra.study.tuning.objective import Limits, Objective
from clepsydra.study.tuning.parameters import SearchSpace, TunedParameter
from clepsydra.study.tuning.pareto import ParetoFront, pareto_front
from clepsydra.study.tuning.problem import TuningProblem
from clepsydra.study.tuning.refinement import refine
from clepsydra.study.tuning.resting_states import resting_states
from clepsydra.study.tuning.result import TuningResult

METHOD = "tuning by simulation"
#: Generations of the global search, if nothing else is asked for.
GENERATIONS = 40
#: A limit this near counts as one that binds, a share of it.
_BINDS = 1e-3
#: Local searches from where the last one ended, at most.
_LOCAL_SEARCHES = 3
#: A local search that brings less than this share is the last.
_WORTH_ANOTHER = 1e-6


class Progress(NamedTuple):
    """How far a tuning has come.

    Parameters
    ----------
    stage : str
        "global search", "local search" or "Pareto front".
    evaluations : int
        Different candidates so far.
    objective : float
        The best so far that keeps all limits; infinite while there is none.

    Examples
    --------
    >>> Progress("global search", 64, 0.8).evaluations
    64
    """

    stage: str
    evaluations: int
    objective: float


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
    state_file: Path | None = None,
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
        None if omitted. A tank that runs empty or over, where it does not at the start, is never
        let pass.
    generations : int
        Of the global search, at most; 0 for the local search alone.
    seed : int
        Of the global search.
    front : sequence of float
        Bounds of max|S| at which the Pareto front is refined.
    progress : callable, optional
        Takes a `Progress` after each batch.
    state_file : Path, optional
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

    >>> from clepsydra.design.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.study.tuning.objective import minimax
    >>> from clepsydra.study.tuning.parameters import around
    >>> analysis = analyse(load_process("quadruple-tank-nonminimum-phase"))
    >>> start = design_simc(analysis.model, analysis.pairing)
    >>> found = tune(start, analysis.model, default_scenario(analysis.model),
    ...              around(start, ["proportional_gain_1", "integral_time_1"], 3.0),
    ...              minimax("iae[level_1]", "iae[level_2]"), limits=Limits(2.0), generations=5)
    >>> found.objective < 1.0, found.maximum_sensitivity < 2.00001
    (True, True)
    """
    require_type(controller, Controller, "controller", "a Controller", "design one, or make one")
    scenarios = [scenario] if isinstance(scenario, Scenario) else list(scenario)
    _check_whole("generations", generations)
    _check_whole("seed", seed)
    space = SearchSpace(controller, tuple(parameters))
    problem = TuningProblem(space, model, scenarios, objective, limits or Limits())
    if state_file is not None:
        problem.memory.load(state_file)
    stages = _Stages(problem, progress, state_file)
    interrupted = False
    try:
        problem.begin()
        if generations:
            stages.name = "global search"
            search_globally(problem, generations=generations, seed=seed)
        stages.name = "local search"
        _refine_until_still(problem)
        stages.name = "Pareto front"
        found_front = pareto_front(problem, front)
    except KeyboardInterrupt:
        interrupted = True
        if problem.best is None:
            raise
        found_front = pareto_front(problem, ())
    finally:
        if state_file is not None:
            problem.memory.save(state_file)
    if problem.best is None:
        raise NotApplicable(METHOD, _why_none(problem))
    return _result(problem, found_front, seed, interrupted)


def _refine_until_still(problem: TuningProblem) -> None:
    """Repeat the local search while it helps: from a kink it may have to start again."""
    limit = problem.limits.maximum_sensitivity
    point = problem.best.point if problem.best else problem.space.start
    for _ in range(_LOCAL_SEARCHES):
        before = problem.best.objective if problem.best else np.inf
        refine(problem, point, limit)
        if problem.best is None or problem.best.objective >= before * (1.0 - _WORTH_ANOTHER):
            return
        point = problem.best.point


class _Stages:
    """Tells the caller, and the state file, how far things have come."""

    def __init__(
        self,
        problem: TuningProblem,
        progress: Callable[[Progress], None] | None,
        state_file: Path | None,
    ) -> None:
        self.name = "start"
        self._problem, self._progress, self._file = problem, progress, state_file
        problem.on_progress = self

    def __call__(self) -> None:
        problem = self._problem
        if self._file is not None:
            problem.memory.save_now_and_then(self._file)
        if self._progress is not None:
            best = problem.best.objective if problem.best else np.inf
            self._progress(Progress(self.name, problem.evaluations, best))


def _check_whole(name: str, value: object) -> None:
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < 0:  # type: ignore[operator]
        raise InputError(f"tuning, {name}", value, "a whole number from 0", "choose another")


def _why_none(problem: TuningProblem) -> str:
    limits = problem.limits
    said = [f"max|S| at most {limits.maximum_sensitivity:g}"]
    said = said if np.isfinite(limits.maximum_sensitivity) else []
    said += [f"{_words(name)} at most {limit:g}" for name, limit in problem.limited.items()]
    return (
        f"none of {problem.evaluations} candidates keeps {' and '.join(said) or 'its tanks'}; "
        "widen the bounds or the limits"
    )


def _words(name: str) -> str:
    score, signal = split_score(name)
    return f"{score.replace('_', ' ')} of {signal}"


def _binding(problem: TuningProblem, point: np.ndarray, sensitivity: float) -> tuple[str, ...]:
    found = problem.evaluate(point[None, :])
    said = []
    if sensitivity >= problem.limits.maximum_sensitivity * (1.0 - _BINDS):
        said.append(f"max|S| at most {problem.limits.maximum_sensitivity:g}")
    for (name, limit), margin in zip(problem.limited.items(), found.margins[0], strict=True):
        if margin <= _BINDS:
            said.append(f"{_words(name)} at most {limit:g}")
    for parameter, share in zip(problem.space.parameters, point, strict=True):
        if share <= _BINDS:
            said.append(f"{parameter.name} at least {parameter.low:g}")
        elif share >= 1.0 - _BINDS:
            said.append(f"{parameter.name} at most {parameter.high:g}")
    return tuple(said)


def _result(
    problem: TuningProblem, front: ParetoFront, seed: int, interrupted: bool
) -> TuningResult:
    best = problem.best
    assert best is not None
    space = problem.space
    start = space.controller
    binding = _binding(problem, best.point, best.sensitivity)
    scores = problem.scores_at(best.point)
    start_objective = float(problem.start.objective[0])
    values = space.controller_values(best.point)
    tuned = {p.name: values[p.name] for p in space.parameters}
    said = ", ".join(f"{name} = {value:.4g}" for name, value in tuned.items())
    notes = [
        f"Objective: {problem.objective.words}: {best.objective:.4g}, at the start "
        f"{start_objective:.4g}.",
        f"On its limit: {'; '.join(binding)}." if binding else "No limit binds.",
        f"{problem.evaluations} candidates simulated, seed {seed}"
        + (", stopped before the end." if interrupted else "."),
    ]
    resting = resting_states(
        problem.batch.loop, {name: np.array([value]) for name, value in values.items()}
    )
    controller = dataclasses.replace(
        start,
        name=f"{start.name}, tuned",
        design=(
            f"Tuned by simulation from {start.name} for {problem.objective.words}: {said}; "
            f"sensitivity peak of all loops together {best.sensitivity:.2f}."
        ),
        values=values,
        initial_state={
            **start.initial_state,
            **{name: float(state[0]) for name, state in resting.items()},
        },
        notes=(*start.notes, *notes),
    )
    return TuningResult(
        controller=controller,
        objective=best.objective,
        start_objective=start_objective,
        scores=scores,
        start_scores=problem.start_scores,
        maximum_sensitivity=best.sensitivity,
        start_maximum_sensitivity=problem.sensitivity(space.start),
        binding=binding,
        evaluations=problem.evaluations,
        history=np.array(problem.history),
        front=front,
        seed=seed,
        interrupted=interrupted,
    )
