"""The search over the whole cube: differential evolution, a generation a batch."""

from __future__ import annotations

import numpy as np

from clepsydra.studies.tuning.problem import TuningProblem
from clepsydra.studies.tuning.standing import standings

#: Members of the population for each parameter, and the fewest.
_MEMBERS, _FEWEST = 8, 16
#: The population has come together when its spread is this share of its mean; what is left
#: is the local search's, which is quicker near a minimum.
_CONVERGED = 1e-2


def search_globally(problem: TuningProblem, *, generations: int, seed: int) -> None:
    """Look for the best candidate everywhere between the bounds; the problem keeps it.

    SciPy's differential evolution, best1bin, with the generation evaluated as one batch, and
    compared by `standing.standings`.

    Parameters
    ----------
    generations : int
        At most so many; fewer if the population comes together.

    References
    ----------
    R. Storn and K. Price, Differential evolution, Journal of Global Optimization 11, 1997,
    341-359, doi 10.1023/A:1008202821328.
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

    def compared(columns: np.ndarray) -> np.ndarray:
        """Return one number for each candidate, given as columns [p, members].

        Each member of a generation is compared with the one in its place before it.
        """
        nonlocal kept
        found = standings(problem, np.ascontiguousarray(columns.T), kept)
        kept = np.minimum(kept, found)
        return found

    differential_evolution(
        compared,
        bounds=[(0.0, 1.0)] * width,
        init=population,
        maxiter=generations,
        tol=_CONVERGED,
        rng=generator,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
