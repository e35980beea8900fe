"""How well a model tells what it has not seen."""

from __future__ import annotations

import math

import numpy as np

#: What moves by less than this share of its size stands still.
_STILL = 1e-9
#: Models whose fits differ by no more are as good as each other; then the simplest is taken.
EQUAL = 1.0
#: A model whose fit is below is hardly better than a constant, and chance alone may be as good.
USEFUL = 10.0
RANKING_RULE = (
    "Every model is fitted to the first two thirds of the record and simulated on through the "
    "last third from the inputs alone, without a single measured value of it. The fit is "
    "100 % − the error there in percent of the error of a constant, the mean of the first two "
    "thirds. Of the models within one point of the best, the one with the fewest parameters comes "
    "first; a model with a parameter that the record does not tell stands behind those without, "
    "and one with a fit below 10 % behind all."
)


def fit_percent(output: np.ndarray, simulated: np.ndarray, constant: float) -> float:
    """Return how much better a simulation is than a constant [%].

    100 for no error, 0 for one that is no better than the constant, and below that for a worse
    one; minus infinity where the simulation ran away, not a number where the output never left
    the constant.

    Parameters
    ----------
    output, simulated : ndarray [N]
    constant : float
        The mean of what was fitted, say.

    Examples
    --------
    >>> fit_percent(np.array([1.0, 3.0]), np.array([1.0, 2.0]), 1.0)
    50.0
    """
    if not np.all(np.isfinite(simulated)):
        return -math.inf
    size = float(np.linalg.norm(output - constant))
    error = float(np.linalg.norm(output - simulated))
    if size <= _STILL * float(np.linalg.norm(output)):
        return math.nan
    return 100.0 * (1.0 - error / size)
