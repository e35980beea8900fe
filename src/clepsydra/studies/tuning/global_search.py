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


def search_globally(
    problem: TuningProblem, *, generations: int, seed: int, also: np.ndarray | None = None
) -> None:
    """Look for the best candidate everywhere between the bounds; the problem keeps it.

    SciPy's differential evolution, best1bin, with the generation evaluated as one batch, and
    compared by `standing.standings`.

    Parameters
    ----------
    generations : int
        At most so many; fewer if the population comes together.
    also : ndarray [p], optional
        A point that is among the first, beside the start.

    References
    ----------
    R. Storn and K. Price, Differential evolution, Journal of Global Optimization 11, 1997,
    341-359, doi 10.1023/A:1008202821328.
    """
    from scipy.optimize import differential_evolution

    start = problem.space.start
    width = len(start)
    members = max(_FEWEST, _MEMBERS * width)
    generator = np.random.Generator(np.random.PCG64(seed))
    population = latin_hypercube(generator, members, width)
    population[0] = start
    if also is not None:
        population[1] = also
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


def latin_hypercube(generator: np.random.Generator, points: int, width: int) -> np.ndarray:
    """Return points [n, p] of the unit cube, one in each n-th part of every side.

    The bits of `scipy.stats.qmc.LatinHypercube`, whose import takes a quarter of a second.

    Examples
    --------
    >>> found = latin_hypercube(np.random.Generator(np.random.PCG64(1)), 4, 2)
    >>> np.sort(np.floor(4 * found), axis=0).T
    array([[0., 1., 2., 3.],
           [0., 1., 2., 3.]])
    """
    (generator,) = generator.spawn(1)
    within = generator.uniform(size=(points, width))
    parts = np.tile(np.arange(1, points + 1), (width, 1))
    for side in parts:
        generator.shuffle(side)
    return np.asarray((parts.T - within) / points)
