"""Tuning by simulation: a search everywhere first, then near the best, then along the front."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable
from clepsydra.studies.tuning.drawn_problem import DrawnProblem, search_over_draws
from clepsydra.studies.tuning.evolution_strategy import search_around
from clepsydra.studies.tuning.global_search import search_globally
from clepsydra.studies.tuning.objective import Goal
from clepsydra.studies.tuning.parameters import METHOD
from clepsydra.studies.tuning.pareto import pareto_front
from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.refinement import refine
from clepsydra.studies.tuning.result import TuningResult, outcome, why_none
from clepsydra.studies.tuning.search_space import SearchSpace

#: Generations of the global search, if nothing else is asked for: at most so many, and at least so
#: many where about so many samples of each candidate would be simulated in all.
GENERATIONS, _FEWEST, _SIMULATED = 40, 8, 400_000
#: Local searches from where the last one ended, at most.
_LOCAL_SEARCHES = 3
#: A local search that brings less than this share is the last.
_WORTH_ANOTHER = 1e-6


class Progress(NamedTuple):
    """How far a tuning has come.

    Parameters
    ----------
    stage : str
        "global search", "search around it", "local search", "search over drawn plants" or
        "Pareto front".
    evaluations : int
        Different candidates so far.
    objective : float
        The best so far that keeps all limits; infinite while there is none. That of the plant
        itself until the search over drawn plants.
    """

    stage: str
    evaluations: int
    objective: float


@dataclass(frozen=True, eq=False)
class Search:
    """How to look for the best candidate.

    Parameters
    ----------
    generations : int, optional
        Of the global search, at most; 0 for the local search alone. 40 if omitted, and fewer where
        the scenario is long.
    seed : int
        Of the global search: the same seed gives the same result.
    front : sequence of float
        Bounds of max|S|, above 1, at which the Pareto front is refined; not over drawn plants.
    progress : callable, optional
        Takes a `Progress` after each batch.
    state_file : str or Path, optional
        Where everything computed is kept, now and then and at the end or an interruption
        (control-C), which returns the best so far. The same tuning goes on from there, and ends
        as it would have without the break.
    afresh : bool
        Whether a state file of another problem is begun afresh, which the result says, and not
        refused.

    Raises
    ------
    InputError
        The seed or the state file cannot be used.
    """

    generations: int | None = None
    seed: int = 1
    front: Sequence[float] = ()
    progress: Callable[[Progress], None] | None = None
    state_file: str | Path | None = None
    afresh: bool = False

    def __post_init__(self) -> None:
        whole = isinstance(self.seed, (int, np.integer)) and not isinstance(self.seed, bool)
        if not whole or self.seed < 0:
            raise InputError("tuning, seed", self.seed, "a whole number from 0", "choose another")
        require_type(
            self.state_file, (Path, str, type(None)), "tuning, state_file",
            "the path of a file, or None", "give it as Path or text",
        )  # fmt: skip

    def generations_over(self, samples: int) -> int:
        """Return the generations of a search in a scenario of so many samples.

        Examples
        --------
        >>> Search().generations_over(4000), Search().generations_over(10**6)
        (40, 8)
        """
        if self.generations is not None:
            return self.generations
        return max(_FEWEST, min(GENERATIONS, round(_SIMULATED / samples)))


def tune(space: SearchSpace, goal: Goal, search: Search | None = None) -> TuningResult:
    """Find the point of a space whose simulated loop scores best and keeps some limits.

    First differential evolution looks everywhere between the bounds, then an evolution strategy
    around the best, and sequential quadratic programming goes to the minimum near it. Candidates
    are simulated in batches on the engine; max|S| is that of the sampled loop, exact.

    With draws that is only the beginning: from what is best for the plant itself the first two
    searches look on for the least quantile, without slopes, see `search_over_draws`.

    Parameters
    ----------
    space : SearchSpace
        Where to look, and how a controller follows.

    Raises
    ------
    InputError
        A score, a limit or the start cannot be used, or the state file is of another problem.
    NotApplicable
        No candidate keeps the limits.

    Examples
    --------
    Two gains and two integral times of the quadruple tank, for the IAE of both levels:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.studies.tuning.law_space import LawSpace
    >>> from clepsydra.studies.tuning.objective import Limits, minimax
    >>> from clepsydra.studies.tuning.parameters import around
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> start = cl.design.simc(plant)
    >>> names = ["level_1.proportional_gain", "level_1.integral_time"]
    >>> goal = Goal(plant.linear, default_scenario(plant.linear),
    ...             minimax("iae[level_1]", "iae[level_2]"), Limits(2.0))
    >>> found = tune(LawSpace(start, around(start, names, 3.0)), goal, Search(generations=1))
    >>> found.objective < 1.0, found.maximum_sensitivity < 2.00001
    (True, True)
    """
    search = search or Search()
    problem = (TuningProblem if goal.draws is None else DrawnProblem)(space, goal)
    file = None if search.state_file is None else Path(search.state_file)
    begun_afresh = file is not None and problem.memory.load(file, afresh=search.afresh)
    stage, interrupted = "start", False

    def tell() -> None:
        if file is not None:
            problem.memory.save_now_and_then(file)
        if search.progress is not None:
            best = problem.best.objective if problem.best else np.inf
            search.progress(Progress(stage, problem.evaluations, best))

    problem.on_progress = tell
    try:
        problem.begin()
        if generations := search.generations_over(goal.scenario.samples):
            stage = "global search"
            search_globally(problem, generations=generations, seed=search.seed)
            if problem.best is not None:
                stage = "search around it"
                search_around(problem, problem.best.point, seed=search.seed)
        stage = "local search"
        _refine_until_still(problem)
        if isinstance(problem, DrawnProblem) and problem.best is not None:
            stage = "search over drawn plants"
            search_over_draws(problem, generations=generations, seed=search.seed)
        stage = "Pareto front"
        front = pareto_front(problem, search.front if goal.draws is None else ())
    except KeyboardInterrupt:
        interrupted = True
        if isinstance(problem, DrawnProblem) and problem.best is not None:
            problem.take_draws()
        if problem.best is None:
            raise
        front = pareto_front(problem, ())
    finally:
        if file is not None:
            problem.memory.save(file)
    if problem.best is None:
        raise NotApplicable(why_none(problem), METHOD)
    found = outcome(problem, front, search.seed, interrupted)
    return replace(found, instead_of=file if begun_afresh else None)


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
