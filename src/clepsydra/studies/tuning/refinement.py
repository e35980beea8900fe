"""The search near a good candidate: sequential quadratic programming on batches."""

from __future__ import annotations

from contextlib import suppress
from typing import NamedTuple

import numpy as np

from clepsydra.studies.tuning.problem import TuningProblem

#: Step of the differences, a share of the way between the bounds. Scores are smooth down to
#: rounding, about 1e-13 of their value.
_DIFFERENCE = 1e-6
#: Points that a local search may take: twice what one without kinks needs.
_POINTS = 40
_ACCURACY = 1e-6
#: What a point without a finite score counts as, a multiple of where the search began.
_WALL = 1e3


class _Local(NamedTuple):
    """Parts, margins and the room to max|S| at a point, and their slopes."""

    parts: np.ndarray
    part_slopes: np.ndarray
    margins: np.ndarray
    margin_slopes: np.ndarray


class _Enough(Exception):
    """The points of a local search are used up."""


def refine(problem: TuningProblem, point: np.ndarray, sensitivity_limit: float) -> None:
    """Go from a point [p] to a minimum near it; the problem keeps what is best.

    The largest of several scores has a kink where two are equal, so that its bound t is made
    a variable: t is minimised with every part at most t (epigraph form), and likewise for a
    sum. SciPy's SLSQP does it; a point and its differences are one batch.

    Parameters
    ----------
    point : ndarray [p]
    sensitivity_limit : float
        Largest max|S|, which may differ from that of the problem; infinite for none.

    References
    ----------
    D. Kraft, A software package for sequential quadratic programming, DFVLR-FB 88-28, 1988.
    """
    from scipy.optimize import minimize

    around = _Neighbourhood(problem, sensitivity_limit)
    first = around.at(point)
    if not np.all(np.isfinite(first.parts)):
        return
    minimax = problem.objective.kind == "minimax"
    height = float(np.max(first.parts) if minimax else np.sum(first.parts))
    scale = height or 1.0

    def room(x: np.ndarray) -> np.ndarray:
        here = around.at(x[:-1])
        parts = here.parts / scale
        return np.append(x[-1] - (parts if minimax else np.sum(parts)), here.margins)

    def slopes_of_room(x: np.ndarray) -> np.ndarray:
        here = around.at(x[:-1])
        parts = here.part_slopes / scale
        parts = parts if minimax else np.sum(parts, axis=0, keepdims=True)
        bound = np.append(np.ones(len(parts)), np.zeros(len(here.margins)))
        return np.column_stack([np.vstack([-parts, here.margin_slopes]), bound])

    up = np.append(np.zeros(len(point)), 1.0)
    with suppress(_Enough):
        minimize(
            lambda x: x[-1],
            np.append(point, height / scale),
            jac=lambda x: up,
            bounds=[(0.0, 1.0)] * len(point) + [(None, None)],
            constraints={"type": "ineq", "fun": room, "jac": slopes_of_room},
            method="SLSQP",
            options={"maxiter": _POINTS, "ftol": _ACCURACY},
        )


class _Neighbourhood:
    """Values and slopes at the points that the programming asks for, each evaluated once."""

    def __init__(self, problem: TuningProblem, sensitivity_limit: float) -> None:
        self._problem, self._limit = problem, sensitivity_limit
        self._known: dict[bytes, _Local] = {}

    def at(self, point: np.ndarray) -> _Local:
        point = np.clip(point, 0.0, 1.0)
        key = point.tobytes()
        if key not in self._known:
            if len(self._known) == _POINTS:
                raise _Enough
            self._known[key] = self._evaluated(point)
        return self._known[key]

    def _evaluated(self, point: np.ndarray) -> _Local:
        # At the upper bound the difference is taken downward.
        steps = np.where(point + _DIFFERENCE <= 1.0, _DIFFERENCE, -_DIFFERENCE)
        points = np.vstack([point, point + np.diag(steps)])
        found = self._problem.evaluate(points, proper=1)
        margins = np.hstack([found.margins, self._problem.loops.rooms(points, self._limit)])
        self._problem.consider(points[:1], found)
        parts = found.parts
        broken = ~np.all(np.isfinite(parts), axis=1)
        if broken[0]:
            # A line search turns back from a wall.
            begun = next(iter(self._known.values()), None)
            wall = _WALL * float(np.max(begun.parts)) if begun else np.inf
            count, room, width = parts.shape[1], margins.shape[1], len(point)
            flat = np.zeros((count, width)), np.zeros((room, width))
            return _Local(np.full(count, wall), flat[0], -np.ones(room), flat[1])
        # Into where there is nothing, no slope is told.
        parts = np.where(broken[:, None], parts[0], parts)
        margins = np.where(broken[:, None], margins[0], margins)
        return _Local(
            parts[0],
            ((parts[1:] - parts[0]) / steps[:, None]).T,
            margins[0],
            ((margins[1:] - margins[0]) / steps[:, None]).T,
        )
