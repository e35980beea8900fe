"""The search over the whole cube: differential evolution, a generation a batch."""

from __future__ import annotations

import numpy as np

from clepsydra.studies.tuning.objective import ON_LIMIT
from clepsydra.studies.tuning.problem import TuningProblem

#: Members of the population for each parameter, and the fewest.
_MEMBERS, _FEWEST = 8, 16
#: The population has come together when its spread is this share of its mean; what is left
#: is the local search's, which is quicker near a minimum.
_CONVERGED = 1e-2


def search_globally(problem: TuningProblem, *, generations: int, seed: int) -> None:
    """Look for the best candidate everywhere between the bounds; the problem keeps it.

    SciPy's differential evolution, best1bin, with the generation evaluated as one batch. A
    candidate that keeps all limits beats any that does not; of two that do not the one that
    passes its limits less is better. max|S| is found only of those that would win by what the
    simulation says, which is cheap beside it.

    Parameters
    ----------
    generations : int
        At most so many; fewer if the population comes together.

    References
    ----------
    R. Storn and K. Price, Differential evolution, Journal of Global Optimization 11, 1997,
    341-359, doi 10.1023/A:1008202821328. K. Deb, An efficient constraint handling method for
    genetic algorithms, Computer Methods in Applied Mechanics and Engineering 186, 2000, 311-338,
    doi 10.1016/S0045-7825(99)00389-8.
    """
    from scipy.optimize import differential_evolution
    from scipy.stats import qmc

    start = problem.space.start
    width = len(start)
    members = max(_FEWEST, _MEMBERS * width)
    generator = np.random.Generator(np.random.PCG64(seed))
    population = qmc.LatinHypercube(width, rng=generator).random(members)
    population[0] = start
    kept = np.full(members, np.inf)

    def standings(columns: np.ndarray) -> np.ndarray:
        """Return one number for each candidate, given as columns [p, members].

        Each member of a generation is compared with the one in its place before it.
        """
        nonlocal kept
        points = np.ascontiguousarray(columns.T)
        evaluated = problem.evaluate(points)
        found = _standing(evaluated.objective, evaluated.violation)
        for place in np.flatnonzero((found <= kept) & np.isfinite(evaluated.objective)):
            excess = _excess(problem, points[place])
            violation = max(float(evaluated.violation[place]), excess)
            found[place] = _standing(evaluated.objective[[place]], np.array([violation]))[0]
        kept = np.minimum(kept, found)
        return found

    differential_evolution(
        standings,
        bounds=[(0.0, 1.0)] * width,
        init=population,
        maxiter=generations,
        tol=_CONVERGED,
        rng=generator,
        polish=False,
        vectorized=True,
        updating="deferred",
    )


def _excess(problem: TuningProblem, point: np.ndarray) -> float:
    """Return how far max|S| is beyond its limit, as a share of 1/limit; 1 if unstable."""
    limit = problem.limits.maximum_sensitivity
    if not np.isfinite(limit):
        return 0.0
    return max(0.0, 1.0 - limit / problem.sensitivity(point))


def _standing(objective: np.ndarray, violation: np.ndarray) -> np.ndarray:
    """Return 0 to 1 for what keeps its limits, 1 to 2 for what does not, 3 for what broke off."""
    # Both maps keep the order, and only the order counts.
    within = np.where(np.isfinite(objective), objective, 0.0)
    beyond = np.where(np.isfinite(violation), violation, 0.0)
    good, bad = within / (1.0 + within), 1.0 + beyond / (1.0 + beyond)
    found = np.where(violation <= ON_LIMIT, good, bad)
    return np.where(np.isfinite(objective), found, 3.0)
