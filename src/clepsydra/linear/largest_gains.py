"""The largest gains of many systems of one size, side by side."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.frequency_peak import frequencies_of, largest_gain
from clepsydra.linear.highest_points import highest_points

#: Larger systems are looked at one by one: their matrices, not the calls, take the time.
_LARGE = 30


def largest_gains(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Return the H∞ norms of stable transfer functions [k].

    Each is that of `clepsydra.linear.frequency_peak.largest_gain`. A search asks for hundreds,
    and together they need a few calls of numpy in place of some fifty each.

    Parameters
    ----------
    A, B, C, D : ndarray [k, n, n], [k, n, m], [k, q, n], [k, q, m]
        All eigenvalues of each A in the left half-plane.

    Examples
    --------
    Resonances with damping ratios of 0.1 and 0.2 have their peaks at 1/(2 ζ √(1 - ζ²)):

    >>> A = np.array([[[0.0, 1.0], [-1.0, -0.2]], [[0.0, 1.0], [-1.0, -0.4]]])
    >>> B, C = np.zeros((2, 2, 1)) + [[0.0], [1.0]], np.zeros((2, 1, 2)) + [1.0, 0.0]
    >>> largest_gains(A, B, C, np.zeros((2, 1, 1))).round(6)
    array([5.025189, 2.551552])
    """
    count, states = A.shape[:2]
    if count < 2 or not states or states > _LARGE:
        return np.array([largest_gain(*each).peak for each in zip(A, B, C, D, strict=True)])
    identity = np.eye(states)

    def gains(which: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
        pencils = (1j * frequencies)[:, None, None] * identity - A[which]
        responses = C[which] @ np.linalg.solve(pencils, B[which]) + D[which]
        squares = np.linalg.eigvalsh(responses.conj().swapaxes(1, 2) @ responses)[:, -1]
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    at_infinity = np.linalg.norm(D, 2, axis=(1, 2))
    at_rest = np.linalg.norm(D - C @ np.linalg.solve(A, B), 2, axis=(1, 2))
    grids = [frequencies_of(poles) for poles in np.linalg.eigvals(A)]
    between = [peak for peak, _ in highest_points(gains, grids)]
    return np.asarray(np.max([at_infinity, at_rest, between], axis=0))
