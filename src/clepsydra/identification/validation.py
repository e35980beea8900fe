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


def fit_percent(output: np.ndarray, simulated: np.ndarray, other: np.ndarray | float) -> float:
    """Return how much better a simulation is than a constant, or than another simulation [%].

    100 for no error, 0 for one that is no better than the other, and below that for a worse
    one; minus infinity where the simulation ran away, not a number where the output never left
    the other.

    Examples
    --------
    >>> fit_percent(np.array([1.0, 3.0]), np.array([1.0, 2.0]), 1.0)
    50.0
    """
    if not np.all(np.isfinite(simulated)):
        return -math.inf
    size = float(np.linalg.norm(output - other))
    error = float(np.linalg.norm(output - simulated))
    if size <= _STILL * float(np.linalg.norm(output)):
        return math.nan
    return 100.0 * (1.0 - error / size)


def fits(output: np.ndarray, simulated: np.ndarray, count: int) -> tuple[float, float]:
    """Return the fit to the first samples and to those held back, beside the mean of the first."""
    rest = float(np.mean(output[:count]))
    seen = fit_percent(output[:count], simulated[:count], rest)
    return seen, fit_percent(output[count:], simulated[count:], rest)
