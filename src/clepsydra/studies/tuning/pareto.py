"""Score against robustness: what each further margin costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.studies.tuning.objective import ON_LIMIT
from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.refinement import refine

#: What is more robust by less than this share, and scores worse, is left out.
_APART = 1e-3


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """Candidates that no other beats in both objective and max|S|, most robust first.

    Parameters
    ----------
    sensitivity : ndarray [points]
        max|S| [1], rising.
    objective : ndarray [points]
        Falling.
    values : dict
        Tuned number to its values [points], a parameter of the law in the law's unit.
    """

    sensitivity: np.ndarray
    objective: np.ndarray
    values: dict[str, np.ndarray]


def pareto_front(problem: TuningProblem, bounds: Sequence[float]) -> ParetoFront:
    """Return the front of everything that was evaluated, refined at some bounds of max|S|.

    At each the objective is minimised once more, from the best candidate below it.
    """
    for bound in sorted(bounds):
        points, _, sensitivity = _not_beaten(problem)
        if len(points):
            below = np.flatnonzero(sensitivity <= bound)
            # Best first: of those below the bound the best, or else the most robust there is.
            refine(problem, points[below[0] if len(below) else -1], bound)
    points, objective, sensitivity = (found[::-1] for found in _not_beaten(problem))
    numbers = problem.space.numbers_at(points)
    return ParetoFront(
        sensitivity, objective, {p.name: numbers[p.name] for p in problem.space.parameters}
    )


def _not_beaten(problem: TuningProblem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points [n, p], objective [n] and max|S| [n] of the front, best objective first.

    Only candidates that keep all other limits count. What is unstable has an infinite max|S| and
    never gets in, since nothing is below infinity but what is stable.
    """
    points = np.array(list(problem.proper.values()))
    found = problem.evaluate(points)
    kept = (found.violation <= ON_LIMIT) & np.isfinite(found.objective)
    kept[kept] = np.all(problem.loops.rooms(points[kept], problem.front_limit) >= -ON_LIMIT, axis=1)
    points, objective = points[kept], found.objective[kept]
    best_first = np.argsort(objective, kind="stable")
    points, objective = points[best_first], objective[best_first]
    sensitivities = problem.loops.falling_sensitivities(points)
    front: list[int] = []
    least = np.inf
    for place, sensitivity in enumerate(sensitivities.tolist()):
        if sensitivity < (1.0 - _APART) * least:
            front.append(place)
            least = sensitivity
    return points[front], objective[front], sensitivities[front]
