"""Scaling of a state space, and the part of it that its inputs move and its outputs show."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

# A coupling weaker than this share of the (scaled) system counts as none.
RANK_TOLERANCE = 1e-10
_SWEEPS = 20


class ScaledSystem(NamedTuple):
    """A state space with entries near one, its time in units of 1/rate.

    G(s) = diag(output_sizes) [C (s/rate I - A)⁻¹ B + D] diag(input_sizes), so the poles and
    zeros of the original are `rate` [rad/s] times those of this one.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    rate: float
    input_sizes: np.ndarray
    output_sizes: np.ndarray


def scaled_system(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> ScaledSystem:
    """Scale states, inputs, outputs and time, so that units do not decide about ranks.

    Every factor is a power of two, so no entry is rounded. Poles, zeros and ranks stay.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
    """
    A, B, C, D = (np.array(matrix, float) for matrix in (A, B, C, D))
    rate = _speed(A)
    A, B = A / rate, B / rate
    input_sizes, output_sizes = np.ones(B.shape[1]), np.ones(len(C))
    for _ in range(_SWEEPS):
        changed = False
        for state in range(len(A)):
            others = np.arange(len(A)) != state
            driven = math.hypot(*A[state, others], *B[state])
            shown = math.hypot(*A[others, state], *C[:, state])
            if driven == 0.0 or shown == 0.0:
                continue
            factor = float(_power_of_two(np.sqrt(driven / shown)))
            changed |= factor != 1.0
            A[:, state] *= factor
            C[:, state] *= factor
            A[state] /= factor
            B[state] /= factor
        inputs = _power_of_two(np.linalg.norm(np.vstack([B, D]), axis=0))
        B, D = B / inputs, D / inputs
        outputs = _power_of_two(np.linalg.norm(np.hstack([C, D]), axis=1))
        C, D = C / outputs[:, None], D / outputs[:, None]
        input_sizes, output_sizes = input_sizes * inputs, output_sizes * outputs
        faster = _speed(A)
        rate, A, B = rate * faster, A / faster, B / faster
        changed |= bool(faster != 1.0 or np.any(inputs != 1.0) or np.any(outputs != 1.0))
        if not changed:
            break
    return ScaledSystem(A, B, C, D, rate, input_sizes, output_sizes)


def minimal_realisation(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return a state space of the same transfer function without idle states.

    States that the inputs do not move are left out, then those that the outputs do not show:
    first those to which nothing leads, or from which, so that their units do not matter, then
    what is out of reach by orthogonal changes of basis of the scaled system. The states that
    remain are mixed and have no names.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]

    Returns
    -------
    A, B, C, D : ndarray [r, r], [r, m], [q, r], [q, m]
        r ≤ n.

    References
    ----------
    P. Van Dooren, The generalized eigenstructure problem in linear system theory, IEEE
    Transactions on Automatic Control 26(1), 1981, 111-129.

    Examples
    --------
    Of two tanks side by side only the one with the pump and the sensor remains:

    >>> A, B = np.diag([-0.5, -0.25]), np.array([[2.0], [0.0]])
    >>> minimal_realisation(A, B, np.array([[1.0, 1.0]]), np.zeros((1, 1)))[0]
    array([[-0.5]])
    """
    A, B, C = (np.asarray(matrix, float) for matrix in (A, B, C))
    kept = np.flatnonzero(_led_to(A, B) & _led_to(A.T, C.T))
    scaled = scaled_system(A[np.ix_(kept, kept)], B[kept], C[:, kept], D)
    moved = reachable_basis(scaled.A, scaled.B)
    a, b, c = moved.T @ scaled.A @ moved, moved.T @ scaled.B, scaled.C @ moved
    shown = reachable_basis(a.T, c.T)
    a, b, c = shown.T @ a @ shown, shown.T @ b, c @ shown
    rate = scaled.rate
    return rate * a, rate * b * scaled.input_sizes, scaled.output_sizes[:, None] * c, np.array(D)


def reachable_basis(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of all states that the inputs can reach, [B, AB, A²B, …].

    Parameters
    ----------
    A, B : ndarray [n, n], [n, m]
        Scaled, so that a small number means a weak coupling.

    Returns
    -------
    ndarray [n, r]
    """
    if not len(A):
        return np.zeros((0, 0))
    basis = np.zeros((len(A), 0))
    fresh, size = B, max(float(np.linalg.norm(B, 2)), np.finfo(float).tiny) if B.size else 1.0
    while fresh.shape[1] and basis.shape[1] < len(A):
        for _ in range(2):  # the second pass removes what rounding left of the first
            fresh = fresh - basis @ (basis.T @ fresh)
        directions, sizes, _ = np.linalg.svd(fresh, full_matrices=False)
        fresh = directions[:, sizes > RANK_TOLERANCE * size]
        basis = np.hstack([basis, fresh])
        fresh, size = A @ fresh, float(np.linalg.norm(A, 2))
    return basis


def _led_to(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return which states some input acts on, at once or by way of others."""
    acts, found = A != 0.0, np.any(B != 0.0, axis=1)
    fresh = found
    while np.any(fresh):
        fresh = np.any(acts[:, fresh], axis=1) & ~found
        found = found | fresh
    return found


def _speed(A: np.ndarray) -> float:
    """Return the size of A as a power of two, one where it is zero."""
    return float(_power_of_two(float(np.linalg.norm(A, 2)))) if A.any() else 1.0


def _power_of_two(sizes: np.ndarray | float) -> np.ndarray:
    """Return the nearest power of two of each size, one for zero."""
    sizes = np.asarray(sizes, float)
    return np.asarray(np.exp2(np.round(np.log2(np.where(sizes > 0.0, sizes, 1.0)))))
