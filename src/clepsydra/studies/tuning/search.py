"""A search in any space: everywhere first, then near the best, then along the front."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.tuning.global_search import search_globally
from clepsydra.studies.tuning.objective import Limits, Objective
from clepsydra.studies.tuning.outcome import outcome, why_none
from clepsydra.studies.tuning.pareto import pareto_front
from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.refinement import refine
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search_space import SearchSpace

METHOD = "tuning by simulation"
#: Generations of the global search, if nothing else is asked for.
GENERATIONS = 40
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


def search(
    space: SearchSpace,
    model: LinearModel,
    scenario: Scenario | Sequence[Scenario],
    objective: Objective,
    *,
    limits: Limits | None = None,
    generations: int = GENERATIONS,
    seed: int = 1,
    front: Sequence[float] = (),
    progress: Callable[[Progress], None] | None = None,
    state_file: str | Path | None = None,
) -> TuningResult:
    """Find the best point of a space; see `clepsydra.studies.tuning.tune.tune`.

    Parameters
    ----------
    space : SearchSpace
        Where to look, and how a controller follows.
    model, scenario, objective, limits, generations, seed, front, progress, state_file
        As for `tune`.

    Raises
    ------
    InputError, NotApplicable
        As `tune`.

    Examples
    --------
    See `clepsydra.studies.tuning.tune.tune`.
    """
    model_remedy = "take that of an analysis, or make it with linearise"
    require_type(model, LinearModel, "model", "a LinearModel", model_remedy)
    scenarios = scenarios_of(scenario)
    objective_remedy = 'make one, as by minimax("iae[level]") or weighted_sum({"iae[level]": 1.0})'
    require_type(objective, Objective, "tuning, objective", "an Objective", objective_remedy)
    require_type(
        limits, (Limits, type(None)), "tuning, limits", "Limits, or None",
        "write as in Limits(maximum_sensitivity=2.0)",
    )  # fmt: skip
    front = _checked_front(front)
    require_type(
        state_file, (Path, str, type(None)), "tuning, state_file", "the path of a file, or None",
        "give it as Path or text",
    )  # fmt: skip
    state_file = None if state_file is None else Path(state_file)
    _check_whole("generations", generations)
    _check_whole("seed", seed)
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
        raise NotApplicable(METHOD, why_none(problem))
    return outcome(problem, found_front, seed, interrupted)


def scenarios_of(scenario: Scenario | Sequence[Scenario]) -> tuple[Scenario, ...]:
    """Return the scenarios of a tuning, one or a list of them.

    Raises
    ------
    InputError
        It is neither.

    Examples
    --------
    >>> scenarios_of([])
    ()
    """
    return sequence_of(
        [scenario] if isinstance(scenario, Scenario) else scenario,
        Scenario, "tuning, scenario", "a Scenario, or a list of them",
        "make one, as by default_scenario(model)",
    )  # fmt: skip


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


def _checked_front(front: object) -> tuple[float, ...]:
    if isinstance(front, (list, tuple, np.ndarray)) and all(map(is_finite_number, front)):
        return tuple(front)
    shown = front if is_finite_number(front) or isinstance(front, str) else "no list of numbers"
    raise InputError(
        "tuning, front", shown, "a list of bounds of max|S|", "write as in [1.4, 1.7, 2.0]"
    )


def _check_whole(name: str, value: object) -> None:
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < 0:  # type: ignore[operator]
        raise InputError(f"tuning, {name}", value, "a whole number from 0", "choose another")
