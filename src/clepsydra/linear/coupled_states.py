"""States that act on each other in a circle, in units in which their couplings compare."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.circles import circles


def balanced_groups(A: np.ndarray) -> list[np.ndarray]:
    """Return the parts of A [1/s] among states that act on each other in a circle, balanced.

    The eigenvalues of A are those of these parts: what acts one way only moves none of them,
    however large it is, and within a part the units of the states are chosen by powers of two so
    that rows and columns are alike. What is small beside these parts is slow; what is small
    beside A may be slow, or a concentration beside a level.

    Examples
    --------
    A tank of a pond's size that feeds a measuring cell of a few drops:

    >>> [part.tolist() for part in balanced_groups(np.array([[-0.02, 0.0], [4e9, -0.5]]))]
    [[[-0.02]], [[-0.5]]]
    """
    from scipy.linalg import matrix_balance

    A = np.asarray(A, float)
    parts = [A[np.ix_(places, places)] for places in circles(A != 0.0)]
    return [matrix_balance(part, permute=False)[0] if len(part) > 1 else part for part in parts]


def fastest_rate(A: np.ndarray) -> float:
    """Return how fast the fastest of these parts is, whatever the units of states [1/s].

    Examples
    --------
    >>> fastest_rate(np.array([[-0.02, 0.0], [4e9, -0.5]]))
    0.5
    """
    return max((float(np.linalg.norm(part, 2)) for part in balanced_groups(A)), default=0.0)
