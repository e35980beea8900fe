"""The peak of the sensitivity of a loop, and whether the loop is stable."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.poles import origin_radius, rightmost_first
from clepsydra.linear.response import evaluate_transfer

_ACCURACY = 1e-9
_ITERATIONS = 60


class SensitivityPeak(NamedTuple):
    """The largest singular value of S over frequency, and where it stands.

    Parameters
    ----------
    peak : float
        max over ω of σ_max(S(jω)) [1]; infinite when the closed loop is unstable.
    frequency : float
        [rad/s]; infinite where S only approaches its peak with rising frequency, not a number
        when the closed loop is unstable.

    Examples
    --------
    >>> SensitivityPeak(peak=1.6, frequency=0.03).peak
    1.6
    """

    peak: float
    frequency: float


def closed_loop_poles(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Return the poles of the loop closed by negative unity feedback, rightmost first.

    They are the eigenvalues of A - B (I + D)⁻¹ C.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, q], [q, n], [q, q]
        The loop transfer function L(s) = C (s I - A)⁻¹ B + D.

    Returns
    -------
    ndarray [n], complex
        [rad/s]

    Raises
    ------
    numpy.linalg.LinAlgError
        I + D is singular: the loop is not well posed.

    Examples
    --------
    L = 3/s has its closed-loop pole at -3:

    >>> one = np.eye(1)
    >>> closed_loop_poles(0.0 * one, 3.0 * one, one, 0.0 * one).real
    array([-3.])
    """
    return rightmost_first(np.linalg.eigvals(A - B @ np.linalg.solve(np.eye(len(D)) + D, C)))


def is_stable(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> bool:
    """Tell whether the loop closed by negative unity feedback is asymptotically stable.

    Every state of L counts, so an unstable or integrating mode that cancels inside the loop
    makes it unstable, as it does in a plant. A loop that is not well posed is not stable.

    Parameters
    ----------
    A, B, C, D : ndarray
        As for `closed_loop_poles`.

    Examples
    --------
    >>> one = np.eye(1)
    >>> is_stable(0.0 * one, 3.0 * one, one, 0.0 * one), is_stable(one, one, 0.5 * one, 0.0 * one)
    (True, False)
    """
    well_posed = np.linalg.cond(np.eye(len(D)) + D) < 1e14
    if not well_posed:
        return False
    closed = A - B @ np.linalg.solve(np.eye(len(D)) + D, C)
    return bool(np.all(closed_loop_poles(A, B, C, D).real < -origin_radius(closed)))


def maximum_sensitivity(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray
) -> SensitivityPeak:
    """Return the peak over frequency of σ_max of S = (I + L)⁻¹.

    A value M keeps, for one loop, a gain margin of at least M/(M - 1) and a phase margin of at
    least 2 asin(1/(2 M)); 1.4 to 2 is customary. The peak is found by Bruinsma and Steinbuch's
    iteration on the imaginary eigenvalues of a Hamiltonian matrix, which cannot miss a narrow
    resonance, started from the closed-loop poles.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, q], [q, n], [q, q]
        The loop transfer function L(s) = C (s I - A)⁻¹ B + D, broken at the output whose
        sensitivity is asked for: G K at the process output, K G at its input.

    Returns
    -------
    SensitivityPeak
        Accurate to about nine digits.

    References
    ----------
    N. A. Bruinsma and M. Steinbuch, A fast algorithm to compute the H∞-norm of a transfer
    function matrix, Systems & Control Letters 14(4), 1990, 287-293,
    doi 10.1016/0167-6911(90)90049-Z.

    Examples
    --------
    L = 1/(s (s + 1)):

    >>> A, B = np.array([[0.0, 1.0], [0.0, -1.0]]), np.array([[0.0], [1.0]])
    >>> peak = maximum_sensitivity(A, B, np.array([[1.0, 0.0]]), np.zeros((1, 1)))
    >>> round(peak.peak, 6), round(peak.frequency, 6)
    (1.46789, 1.168771)
    """
    if not is_stable(A, B, C, D):
        return SensitivityPeak(float("inf"), float("nan"))
    inverse = np.linalg.inv(np.eye(len(D)) + D)
    # S is itself a state space: ẋ = (A - B V C) x + B V r, e = -V C x + V r with V = (I + D)⁻¹.
    return largest_gain(A - B @ inverse @ C, B @ inverse, -inverse @ C, inverse)


def largest_gain(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> SensitivityPeak:
    """Return the H∞ norm of a stable transfer function and the frequency of its peak.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
        All eigenvalues of A in the left half-plane.

    Examples
    --------
    A resonance with damping ratio 0.1 has its peak at 1/(2 ζ √(1 - ζ²)):

    >>> A = np.array([[0.0, 1.0], [-1.0, -0.2]])
    >>> round(largest_gain(A, np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]]),
    ...                    np.zeros((1, 1))).peak, 6)
    5.025189
    """
    direct = float(np.linalg.norm(D, 2)) if D.size else 0.0
    best = SensitivityPeak(direct, float("inf"))
    if not len(A):
        return best
    best = max(best, _best_of(A, B, C, D, np.concatenate([[0.0], abs(np.linalg.eigvals(A))])))
    for _ in range(_ITERATIONS):
        if best.peak == 0.0:
            break
        crossings = _crossing_frequencies(A, B, C, D, best.peak * (1.0 + _ACCURACY))
        if not crossings.size:
            break
        found = _best_of(A, B, C, D, _candidates(crossings))
        improved = found.peak > best.peak * (1.0 + _ACCURACY)
        best = max(best, found)
        if not improved:
            break
    return best


def _candidates(crossings: np.ndarray) -> np.ndarray:
    """Return where the peak may be that exceeds a level between two of its crossings.

    Near the geometric middle, or where two crossings merge.
    """
    return np.concatenate([crossings, np.sqrt(crossings[:-1] * crossings[1:])])


def _best_of(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, frequencies: np.ndarray
) -> SensitivityPeak:
    responses = evaluate_transfer(A, B, C, D, 1j * frequencies)
    gains = np.linalg.norm(responses, 2, axis=(1, 2))
    place = int(np.argmax(gains))
    return SensitivityPeak(float(gains[place]), float(frequencies[place]))


def _crossing_frequencies(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, level: float
) -> np.ndarray:
    """Return the frequencies at which a singular value may equal the level, sorted.

    They are the imaginary eigenvalues of the Hamiltonian matrix of the level. The test for
    "imaginary" is generous: a false one only costs an evaluation.
    """
    R = level**2 * np.eye(D.shape[1]) - D.T @ D
    gain = np.linalg.solve(R, D.T @ C)
    inner = A + B @ gain
    hamiltonian = np.block(
        [
            [inner, B @ np.linalg.solve(R, B.T)],
            [-C.T @ (C + D @ gain), -inner.T],
        ]
    )
    roots = np.linalg.eigvals(hamiltonian)
    near_axis = np.abs(roots.real) <= 1e-4 * np.abs(roots)
    return np.unique(np.abs(roots.imag[near_axis]))
