"""Which of two candidates is better, where both may pass limits: one number for each."""

from __future__ import annotations

import numpy as np

from clepsydra.studies.tuning.objective import ON_LIMIT
from clepsydra.studies.tuning.problem import TuningProblem


def standings(
    problem: TuningProblem, points: np.ndarray, than: np.ndarray | None = None
) -> np.ndarray:
    """Return how candidates at points [n, p] stand [n], the smaller the better.

    A candidate that keeps all limits beats any that does not; of two that do not the one that
    passes its limits less is better. The limits of the linear loop are looked at only where a
    candidate would win by what the simulation says, which is cheap beside it.

    Parameters
    ----------
    than : ndarray [n], optional
        Standings that a candidate must reach to win; where it does not, it is left at that.

    References
    ----------
    K. Deb, An efficient constraint handling method for genetic algorithms, Computer Methods in
    Applied Mechanics and Engineering 186, 2000, 311-338, doi 10.1016/S0045-7825(99)00389-8.
    """
    evaluated = problem.evaluate(points)
    found = _standing(evaluated.objective, evaluated.violation)
    wins = np.isfinite(evaluated.objective)
    wins &= evaluated.violation <= ON_LIMIT if than is None else found <= than
    rooms = problem.loops.rooms(points[wins], problem.limits.maximum_sensitivity)
    violation = np.maximum(evaluated.violation[wins], np.max(-rooms, axis=1, initial=0.0))
    found[wins] = _standing(evaluated.objective[wins], violation)
    problem.consider(points, evaluated)  # last, since the loops of all that win are known now
    return found


def _standing(objective: np.ndarray, violation: np.ndarray) -> np.ndarray:
    """Return 0 to 1 for what keeps its limits, 1 to 2 for what does not, 3 for what broke off."""
    # Both maps keep the order, and only the order counts.
    within = np.where(np.isfinite(objective), objective, 0.0)
    good, bad = within / (1.0 + within), 2.0 - 1.0 / (1.0 + violation)
    found = np.where(violation <= ON_LIMIT, good, bad)
    return np.where(np.isfinite(objective), found, 3.0)
