"""The largest gains of linear systems over frequency, and where they are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.highest_points import frequencies_of, highest_points
from clepsydra.linear.response import evaluate_transfer

#: So many numbers of A are looked at together.
_TOGETHER = 20_000


class SensitivityPeak(NamedTuple):
    """The largest singular value of S over frequency, and where it stands.

    Parameters
    ----------
    peak : float
        max over ω of σ_max(S(jω)) [1]; infinite when the closed loop is unstable.
    frequency : float
        [rad/s]; infinite where S only approaches its peak with rising frequency, not a number
        when the closed loop is unstable.
    """

    peak: float
    frequency: float


def largest_gain(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> SensitivityPeak:
    """Return the H∞ norm of a stable transfer function and the frequency of its peak.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
        All eigenvalues of A in the left half-plane.

    Returns
    -------
    SensitivityPeak
        Accurate to about nine digits, see `largest_gains`.

    Examples
    --------
    A resonance with damping ratio 0.1 has its peak at 1/(2 ζ √(1 - ζ²)):

    >>> A = np.array([[0.0, 1.0], [-1.0, -0.2]])
    >>> round(largest_gain(A, np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]]),
    ...                    np.zeros((1, 1))).peak, 6)
    5.025189
    """
    return largest_gains(A[None], B[None], C[None], D[None])[0]


def largest_gains(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray
) -> list[SensitivityPeak]:
    """Return the H∞ norms of k stable transfer functions; that of each is as if it were alone.

    A norm is the highest of the gains at rest, at infinity, and at every maximum seen from the
    frequencies that the poles call for. The level sets of Boyd and Balakrishnan would need no
    such frequencies, but rounding in the eigenvalues of their Hamiltonian matrix hides peaks
    where speeds span many decades.

    Parameters
    ----------
    A, B, C, D : ndarray [k, n, n], [k, n, m], [k, q, n], [k, q, m]
        All eigenvalues of each A in the left half-plane.

    Examples
    --------
    Lags of 1 and of 2 with a gain of 3:

    >>> ones = np.ones((2, 1, 1))
    >>> rates = np.array([[[-1.0]], [[-0.5]]])
    >>> [round(each.peak, 9) for each in largest_gains(rates, ones, -3.0 * rates, 0.0 * ones)]
    [3.0, 3.0]
    """
    states, half = A.shape[1], len(A) // 2
    if not len(A):
        return []
    if half and len(A) * states**2 > _TOGETHER:
        matrices = A, B, C, D
        first, second = (
            [each[part] for each in matrices] for part in (slice(half), slice(half, None))
        )
        return largest_gains(*first) + largest_gains(*second)
    if not states:
        return [SensitivityPeak(gain, float("inf")) for gain in _gains(D).tolist()]
    rest = D - C @ np.linalg.solve(A, B)
    at_infinity, at_rest = _gains(D), _gains(rest)

    def gains(frequencies: np.ndarray, of: np.ndarray) -> np.ndarray:
        return _gains(evaluate_transfer(A[of], B[of], C[of], D[of], 1j * frequencies))

    known = np.maximum(at_infinity, at_rest)
    peaks, frequencies = highest_points(gains, frequencies_of(np.linalg.eigvals(A)), known)
    ends = np.where(at_rest > at_infinity, 0.0, np.inf)
    places = np.where(np.isnan(frequencies), ends, frequencies)
    return [SensitivityPeak(*each) for each in zip(peaks.tolist(), places.tolist(), strict=True)]


def _gains(responses: np.ndarray) -> np.ndarray:
    """Return the largest singular values of matrices [..., q, m], each within a few units."""
    if not responses.size:
        return np.zeros(responses.shape[:-2])
    # The root of the largest eigenvalue of GᴴG is as exact as an SVD and takes half its time.
    turned = responses.conj().swapaxes(-1, -2)
    wide = responses.shape[-2] < responses.shape[-1]
    squares = responses @ turned if wide else turned @ responses
    first = squares[..., 0, 0].real
    if squares.shape[-1] == 1:
        largest = first
    elif squares.shape[-1] == 2:
        last = squares[..., 1, 1].real
        largest = (first + last) / 2.0 + np.hypot((first - last) / 2.0, np.abs(squares[..., 0, 1]))
    else:
        largest = np.linalg.eigvalsh(squares)[..., -1]
    return np.sqrt(np.maximum(largest, 0.0))
