"""The largest gain of a stable system over all frequencies."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.frequency_peak import SensitivityPeak, frequencies_of, highest_point
from clepsydra.linear.response import evaluate_transfer


def largest_gain(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> SensitivityPeak:
    """Return the H∞ norm of a stable transfer function and the frequency of its peak.

    It is the highest of the gains at rest, at infinity, and at every maximum seen from the
    frequencies that the poles call for. The level sets of Boyd and Balakrishnan would need no
    such frequencies, but rounding in the eigenvalues of their Hamiltonian matrix hides peaks
    where speeds span many decades.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
        All eigenvalues of A in the left half-plane.

    Returns
    -------
    SensitivityPeak
        Accurate to about nine digits.

    Examples
    --------
    A resonance with damping ratio 0.1 has its peak at 1/(2 ζ √(1 - ζ²)):

    >>> A = np.array([[0.0, 1.0], [-1.0, -0.2]])
    >>> round(largest_gain(A, np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]]),
    ...                    np.zeros((1, 1))).peak, 6)
    5.025189
    """
    direct = float(np.linalg.norm(D, 2)) if D.size else 0.0
    at_infinity = SensitivityPeak(direct, float("inf"))
    if not len(A):
        return at_infinity

    def gains(frequencies: np.ndarray) -> np.ndarray:
        responses = evaluate_transfer(A, B, C, D, 1j * frequencies)
        # The root of the largest eigenvalue of GᴴG is as exact as an SVD and takes half its time.
        squares = np.linalg.eigvalsh(responses.conj().swapaxes(1, 2) @ responses)[:, -1]
        return np.sqrt(np.maximum(squares, 0.0))

    at_rest = SensitivityPeak(float(np.linalg.norm(D - C @ np.linalg.solve(A, B), 2)), 0.0)
    between = SensitivityPeak(*highest_point(gains, frequencies_of(np.linalg.eigvals(A))))
    return max(at_infinity, at_rest, between, key=lambda peak: peak.peak)
