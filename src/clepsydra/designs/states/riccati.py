"""The discrete algebraic Riccati equation, and the gain that follows from it."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np

from clepsydra.designs.applicability import NotApplicable

_REFINEMENTS = 2
#: 2⁶⁰ samples are for ever.
_DOUBLINGS = 60
#: A solution with a larger residual, as a share of its largest term, is none.
LARGEST_RESIDUAL = 1e-9


class Regulator(NamedTuple):
    """u(k) = −K x(k), the cost xᵀ P x to go, and the eigenvalues of the closed loop.

    Parameters
    ----------
    gain : ndarray [m, n]
    cost : ndarray [n, n]
    eigenvalues : ndarray [n], complex
    """

    gain: np.ndarray
    cost: np.ndarray
    eigenvalues: np.ndarray


def optimal_regulator(
    held: np.ndarray, moved: np.ndarray, Q: np.ndarray, N: np.ndarray, R: np.ndarray
) -> Regulator:
    """Return the regulator of x(k+1) = Φ x + Γ u that minimises Σ xᵀ Q x + 2 xᵀ N u + uᵀ R u.

    P solves Φᵀ P Φ − P − (Φᵀ P Γ + N)(R + Γᵀ P Γ)⁻¹(Γᵀ P Φ + Nᵀ) + Q = 0.

    Parameters
    ----------
    held, moved : ndarray [n, n], [n, m]
        Φ and Γ.
    Q, N, R : ndarray [n, n], [n, m], [m, m]

    Raises
    ------
    NotApplicable
        There is no stabilising solution, or it cannot be computed to nine digits.

    References
    ----------
    W. F. Arnold and A. J. Laub, Generalized eigenproblem algorithms and software for algebraic
    Riccati equations, Proceedings of the IEEE 72(12), 1984, 1746-1754,
    doi 10.1109/PROC.1984.13083.

    Examples
    --------
    x⁺ = x + u with Q = R = 1: P is the golden ratio, and K = P/(1 + P) = 1/P.

    >>> one = np.eye(1)
    >>> found = optimal_regulator(one, one, one, 0.0 * one, one)
    >>> round(float(found.cost[0, 0]), 6), round(float(found.gain[0, 0]), 6)
    (1.618034, 0.618034)
    """
    from scipy.linalg import LinAlgWarning, solve_discrete_are

    if not all(np.all(np.isfinite(matrix)) for matrix in (held, moved, Q, N, R)):
        raise NotApplicable("the cost of a sample is beyond what numbers can hold")
    try:
        # What SciPy warns of is found in the solution itself, whose residual is judged below.
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", LinAlgWarning)
            P = solve_discrete_are(held, moved, Q, R, s=N)
    except np.linalg.LinAlgError as error:
        raise NotApplicable(
            "the Riccati equation has no stabilising solution: a mode is out of reach"
        ) from error
    except ValueError:  # of a pair of matrices that cannot be reordered
        P = _doubled(held, moved, Q, N, R)
    P = _refined(held, moved, Q, N, R, P)
    if riccati_residual(held, moved, Q, N, R, P) > LARGEST_RESIDUAL:
        raise NotApplicable("the Riccati equation cannot be solved to nine digits")
    gain = np.linalg.solve(R + moved.T @ P @ moved, moved.T @ P @ held + N.T)
    eigenvalues = np.linalg.eigvals(held - moved @ gain)
    if not np.all(np.abs(eigenvalues) < 1.0):
        raise NotApplicable("the Riccati solution does not stabilise the model")
    return Regulator(gain, P, eigenvalues)


def _doubled(
    held: np.ndarray, moved: np.ndarray, Q: np.ndarray, N: np.ndarray, R: np.ndarray
) -> np.ndarray:
    """Return P as the cost of 1, 2, 4, 8 … samples, where eigenvalues are too alike to be sorted.

    A register of readings on their way has as many eigenvalues at zero as places, and rounding
    moves each of them far; doubling asks for none.

    References
    ----------
    B. D. O. Anderson, Second-order convergent algorithms for the steady-state Riccati equation,
    International Journal of Control 28(2), 1978, 295-306.
    """
    A, cost = held - moved @ np.linalg.solve(R, N.T), Q - N @ np.linalg.solve(R, N.T)
    reach = moved @ np.linalg.solve(R, moved.T)
    try:
        with np.errstate(all="ignore"):
            for _ in range(_DOUBLINGS):
                both = np.linalg.solve(np.eye(len(A)) + reach @ cost, np.hstack([A, reach]))
                moves, reached = both[:, : len(A)], both[:, len(A) :]
                added, reach = moves.T @ cost @ A, reach + A @ reached @ A.T
                A, cost = A @ moves, cost + (added + added.T) / 2.0
                largest = np.abs(cost).max()
                if np.isfinite(largest) and np.abs(added).max() <= np.finfo(float).eps * largest:
                    return cost
    except np.linalg.LinAlgError:
        pass  # told below
    raise NotApplicable("the Riccati equation is too ill-conditioned to be solved")


def _refined(
    held: np.ndarray, moved: np.ndarray, Q: np.ndarray, N: np.ndarray, R: np.ndarray, P: np.ndarray
) -> np.ndarray:
    """Return P after Newton's steps with a residual in higher precision.

    Two processors otherwise differ in the tenth digit of a gain. A step is that of Kleinman:
    Aᵀ δ A − δ is minus the residual, with A closed by the gain of P.
    """
    exact = [matrix.astype(np.longdouble) for matrix in (held, moved, Q, N, R)]
    for _ in range(_REFINEMENTS):
        gain = np.linalg.solve(R + moved.T @ P @ moved, moved.T @ P @ held + N.T)
        closed = held - moved @ gain
        if not np.all(np.abs(np.linalg.eigvals(closed)) < 1.0):
            return P
        A, B, weight, cross, effort = exact
        K, cost = gain.astype(np.longdouble), P.astype(np.longdouble)
        left = A - B @ K
        rest = left.T @ cost @ left - cost + weight - cross @ K - (cross @ K).T + K.T @ effort @ K
        P = (cost + _summed(closed, rest.astype(float))).astype(float)
        P = (P + P.T) / 2.0
    return P


def _summed(closed: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return the sum of (Aᵀ)ᵏ M Aᵏ over all k, twice as many terms in each step."""
    total, power = rest, closed
    while np.abs(power).max(initial=0.0) > np.finfo(float).eps:
        total = total + power.T @ total @ power
        power = power @ power
    return total


def riccati_residual(
    held: np.ndarray, moved: np.ndarray, Q: np.ndarray, N: np.ndarray, R: np.ndarray, P: np.ndarray
) -> float:
    """Return what is left of the Riccati equation, as a share of its largest number.

    Examples
    --------
    >>> one = np.eye(1)
    >>> P = (1.0 + np.sqrt(5.0)) / 2.0 * one
    >>> riccati_residual(one, one, one, 0.0 * one, one, P) < 1e-15
    True
    """
    cross = held.T @ P @ moved + N
    closed = cross @ np.linalg.solve(R + moved.T @ P @ moved, cross.T)
    terms = (held.T @ P @ held, -P, -closed, Q)
    largest = max(float(np.abs(term).max(initial=0.0)) for term in terms)
    return float(np.abs(sum(terms)).max(initial=0.0)) / max(largest, np.finfo(float).tiny)
