"""The peak of the sensitivity of a loop, and whether the loop is stable."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.frequency_peak import SensitivityPeak, frequencies_of, highest_point
from clepsydra.linear.poles import origin_radius, rightmost_first
from clepsydra.linear.response import evaluate_transfer


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
    least 2 asin(1/(2 M)); 1.4 to 2 is customary. See `largest_gain`.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, q], [q, n], [q, q]
        The loop transfer function L(s) = C (s I - A)⁻¹ B + D, broken at the output whose
        sensitivity is asked for: G K at the process output, K G at its input.

    Returns
    -------
    SensitivityPeak
        Accurate to about nine digits.

    Examples
    --------
    L = 1/(s (s + 1)):

    >>> A, B = np.array([[0.0, 1.0], [0.0, -1.0]]), np.array([[0.0], [1.0]])
    >>> peak = maximum_sensitivity(A, B, np.array([[1.0, 0.0]]), np.zeros((1, 1)))
    >>> round(peak.peak, 6), round(peak.frequency, 4)
    (1.46789, 1.1688)
    """
    if not is_stable(A, B, C, D):
        return SensitivityPeak(float("inf"), float("nan"))
    inverse = np.linalg.inv(np.eye(len(D)) + D)
    # S is itself a state space: ẋ = (A - B V C) x + B V r, e = -V C x + V r with V = (I + D)⁻¹.
    return largest_gain(A - B @ inverse @ C, B @ inverse, -inverse @ C, inverse)


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
