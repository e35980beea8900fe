"""A tuning problem over drawn plants: the limits of the plant itself, the quantile of many."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.designs.designed_values import designed_values
from clepsydra.studies.tuning.drawn_candidates import DrawnCandidates, DrawnRuns
from clepsydra.studies.tuning.evolution_strategy import search_around
from clepsydra.studies.tuning.global_search import search_globally
from clepsydra.studies.tuning.objective import ON_LIMIT, Goal
from clepsydra.studies.tuning.over_draws import OverDraws, TunedOverDraws
from clepsydra.studies.tuning.problem import BestSoFar, Evaluation, TuningProblem
from clepsydra.studies.tuning.search_space import SearchSpace

#: Generations of the search everywhere over drawn plants, at most: that of the plant itself has
#: been everywhere, and what it found is among the first.
_GENERATIONS = 8


class DrawnProblem(TuningProblem):
    """A problem of which, from `take_draws` on, a quantile over drawn plants is the objective.

    All candidates meet the same plants, so that it is a function of the candidate alone. A plant
    on which a candidate fails counts as worse than any score. Only candidates that keep all
    limits on the plant itself are tried on the others: for the rest nothing hangs on it.

    Parameters
    ----------
    goal : Goal
        With draws.

    Raises
    ------
    InputError
        As `TuningProblem` or `DrawnCandidates`.
    """

    def __init__(self, space: SearchSpace, goal: Goal) -> None:
        super().__init__(space, goal)
        assert goal.draws is not None
        self.draws, self._duration = goal.draws, goal.scenario.duration
        self.of_plant_alone: BestSoFar | None = None
        self._candidates = DrawnCandidates(space.controller, goal)
        self._taken = False

    def take_draws(self) -> None:
        """Go over from the objective of the plant itself to that over the draws, once.

        The start and what was best for the plant itself are tried first.
        """
        if self._taken:
            return
        alone = self.best
        points = np.array([self.space.start, *([] if alone is None else [alone.point])])
        # Only when it is done: whoever interrupts it gets the best so far by doing it again.
        found = self._over_draws(points, super().evaluate(points))
        self._taken, self.of_plant_alone, self.best = True, alone, None
        self.front_limit = self.limits.maximum_sensitivity
        self.history, self.proper = [], {point.tobytes(): point for point in points}
        self.consider(points, found)

    def evaluate(self, points: np.ndarray, proper: int | None = None) -> Evaluation:
        """Return what simulation says of candidates [n, p]; see `TuningProblem.evaluate`.

        The last margin is the room to the number of plants on which a candidate may fail, a share
        of all. Where that is passed the objective is that of the plant itself, as it is where
        another limit is passed: of such candidates only limits are compared.
        """
        found = super().evaluate(points, proper)
        if not self._taken:
            return found
        found = self._over_draws(points, found)
        self.on_progress()
        return found

    def _over_draws(self, points: np.ndarray, found: Evaluation) -> Evaluation:
        sound = np.isfinite(found.objective) & (found.violation <= ON_LIMIT)
        rooms = self.loops.rooms(points[sound], self.limits.maximum_sensitivity)
        sound[sound] = np.all(rooms >= -ON_LIMIT, axis=1)
        objective, room = found.objective.copy(), np.zeros(len(points))
        quantiles, failed = self._drawn(points[sound]).T
        room[sound] = (self.draws.bearable - failed) / self.draws.able
        objective[sound] = np.where(np.isfinite(quantiles), quantiles, objective[sound])
        return Evaluation(objective, found.parts, np.column_stack([found.margins, room]))

    @property
    def words(self) -> str:
        """What is minimised, as a phrase."""
        return f"{self.draws.words} of {self.objective.words}"

    def came_to(self, values: Mapping[str, float]) -> TunedOverDraws:
        """Return what a tuning to these values, of all parameters of the law, came to."""
        alone, draws = self.of_plant_alone, self.draws
        return TunedOverDraws(
            draws.quantile,
            draws.able,
            draws.left_out,
            draws.plants.seed,
            self.over(values),
            self.over(self.space.controller.values),
            None if alone is None else self.over(self._as_it_runs(alone.point)),
            draws.plants.point.process,
            self._duration,
        )

    @property
    def why_none(self) -> str:
        """What no candidate does, as a phrase, and what the start does; empty if none was tried."""
        draws = self.draws
        words = f"works on {draws.place} of {draws.able} drawn plants"
        if not self.memory.drawn:
            return ""
        most = draws.able - int(min(failed for _, failed in self.memory.drawn.values()))
        failures = self.over(self.space.controller.values).failures
        happened = [f"{what} on {count}" for what, count in failures.items()]
        said = f" (the best of them on {most}"
        return words + said + (f"; at the start {', '.join(happened)})" if happened else ")")

    def _as_it_runs(self, point: np.ndarray) -> dict[str, float]:
        """Return all values of the law at a point, rounded as those of a controller are."""
        space = self.space
        return designed_values(
            space.controller.law,
            space.controller_values(point),
            self.draws.plants.point,
        )

    def over(self, values: Mapping[str, float]) -> OverDraws:
        """Return what the controller with all its values comes to over the draws."""
        runs = self._candidates.run({name: np.array([each]) for name, each in values.items()})
        (objective,), (failed,) = self._quantiles(runs)
        place, failing = self.draws.place - 1, runs.failed[0]
        scores = {
            name: float(np.sort(np.where(failing, np.inf, rows[0]))[place])
            for name, rows in runs.scores.items()
        }
        counts = {what.value: int(np.sum(truths)) for what, truths in runs.failures.items()}
        failures = {what: count for what, count in counts.items() if count}
        return OverDraws(float(objective), scores, int(failed), failures)

    def _drawn(self, points: np.ndarray) -> np.ndarray:
        """Return the quantile and on how many plants it fails, of candidates [n, 2]."""
        known = self.memory.drawn
        keys = [point.tobytes() for point in points]
        new = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
        if new:
            runs = self._candidates.run(self.space.values_at(np.array(list(new.values()))))
            rows = np.column_stack(self._quantiles(runs))
            known.update(zip(new, rows.tolist(), strict=True))
        return np.reshape([known[key] for key in keys], (-1, 2))

    def _quantiles(self, runs: DrawnRuns) -> tuple[np.ndarray, np.ndarray]:
        """Return the quantile of the objective, and on how many plants candidates fail [n]."""
        flat = {name: rows.ravel() for name, rows in runs.scores.items()}
        value = self.objective.value(self.objective.parts(flat, self.start_scores))
        value = np.where(np.isfinite(value), value, np.inf).reshape(runs.failed.shape)
        failed = runs.failed | np.isinf(value)
        ordered = np.sort(np.where(failed, np.inf, value), axis=1)
        return ordered[:, self.draws.place - 1], np.count_nonzero(failed, axis=1)


def search_over_draws(problem: DrawnProblem, *, generations: int, seed: int) -> None:
    """Look for the best candidate over the draws; the problem keeps it.

    First everywhere, from what is best for the plant itself, then around the best. Neither takes
    slopes: a quantile is the score of one plant after another, with a kink wherever two change
    places, and at a minimum two or more usually do.

    Parameters
    ----------
    generations : int
        Of the search everywhere, at most; 0 for that around the best alone.
    """
    problem.take_draws()
    alone = problem.of_plant_alone
    if generations:
        also = None if alone is None else alone.point
        search_globally(problem, generations=min(generations, _GENERATIONS), seed=seed, also=also)
    if problem.best is not None:
        search_around(problem, problem.best.point, seed=seed)
