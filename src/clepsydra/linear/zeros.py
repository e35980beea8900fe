"""Transmission zeros of a linear model, and whether it is minimum phase."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from clepsydra.linear.linear_model import LinearModel, refuse_delays
from clepsydra.linear.minimal_realisation import (
    RANK_TOLERANCE,
    ScaledSystem,
    minimal_realisation,
    scaled_system,
)
from clepsydra.linear.poles import origin_radius, rightmost_first

_System = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def zeros(model: LinearModel) -> np.ndarray:
    """Return the finite transmission zeros from the inputs to the outputs, rightmost first.

    States that the inputs do not move or the outputs do not show are taken out first, so their
    modes are not mistaken for zeros. The staircase reduction of Emami-Naeini and Van Dooren
    then takes out the zeros at infinity; the eigenvalues of what remains are the zeros. It
    serves square and non-square models and any rank of C B.

    Returns
    -------
    ndarray [z], complex
        [rad/s]

    Raises
    ------
    InputError
        The model has dead time: it may have infinitely many zeros.

    References
    ----------
    A. Emami-Naeini and P. Van Dooren, Computation of zeros of linear multivariable systems,
    Automatica 18(4), 1982, 415-430, doi 10.1016/0005-1098(82)90070-X.

    Examples
    --------
    (s + 3) / ((s + 1) (s + 2)):

    >>> A, B = np.array([[0.0, 1.0], [-2.0, -3.0]]), np.array([[0.0], [1.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.array([[3.0, 1.0]]), np.zeros((1, 1)),
    ...                     ("a", "b"), ("u",), (), ("y",))
    >>> zeros(model).round(9).real
    array([-3.])
    """
    from scipy.linalg import eigvals

    scaled, (A, B, C, D) = reduced_system(model)
    if not len(A):
        return np.zeros(0, complex)
    # In a basis [N R] whose N spans the null space of [C D], the pencil of the zeros is what
    # stands in N: the outputs are zero there.
    null = _null_space(np.hstack([C, D]))
    left = np.hstack([A, B]) @ null
    right = null[: len(A)]
    return rightmost_first(scaled.rate * eigvals(left, right))


def normal_rank(model: LinearModel) -> int:
    """Return the rank of G(s) for almost every s.

    If it is below the number of outputs, these cannot be set independently.
    """
    return len(reduced_system(model)[1][3])


def minimum_phase(model: LinearModel) -> bool:
    """Tell whether the model can be inverted by a stable system.

    True when every transmission zero has a negative real part and the outputs can be set
    independently. A zero at the origin counts against it (no steady input then moves some
    combination of the outputs); a pole there, an integrating tank, does not.
    """
    if normal_rank(model) < min(len(model.outputs), len(model.inputs)):
        return False
    return bool(np.all(zeros(model).real < -origin_radius(model.A)))


def bandwidth_limit(zero: complex) -> float:
    """Return how fast a loop can be that meets a zero in the right half-plane [rad/s].

    z/2 of a real zero, |z|/4 of a complex pair nearer to the real than to the imaginary axis, and
    |z|/2.8 of one nearer to the imaginary axis (Skogestad and Postlethwaite, Multivariable
    Feedback Control, 2nd ed., chapter 5; the last is cautious).

    Parameters
    ----------
    zero : complex
        [rad/s]

    Examples
    --------
    >>> bandwidth_limit(0.5), bandwidth_limit(4.0 + 3.0j)
    (0.25, 1.25)
    """
    if zero.imag == 0.0:
        return float(zero.real) / 2.0
    return float(abs(zero)) / (4.0 if zero.real > abs(zero.imag) else 2.8)


@lru_cache(maxsize=16)
def reduced_system(model: LinearModel) -> tuple[ScaledSystem, _System]:
    """Return a minimal scaled realisation, and what it is with an invertible D.

    Both have the same finite zeros, and the size of that D is the normal rank. An analysis asks for
    them of one model several times.
    """
    refuse_delays(model.delays, "zeros")
    scaled = scaled_system(*minimal_realisation(model.A, model.B, model.C, model.D))
    A, B, C, D = _rows_reduced(scaled.A, scaled.B, scaled.C, scaled.D)
    A, B, C, D = _rows_reduced(A.T, C.T, B.T, D.T)
    return scaled, (A.T, C.T, B.T, D.T)


def _rows_reduced(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> _System:
    """Return a system with the same finite zeros whose D has full row rank.

    Where D leaves a combination of outputs untouched by the inputs, y = C̃ x = 0 fixes some
    states to zero; their derivatives become the next outputs that must be zero.
    """
    size = max(float(np.linalg.norm(np.block([[A, B], [C, D]]))), np.finfo(float).tiny)
    while True:
        rotation, rank = _row_compression(D, size)
        D, C = rotation.T @ D, rotation.T @ C
        direct, untouched = C[:rank], C[rank:]
        D = D[:rank]
        if not len(untouched):
            return A, B, direct, D
        basis, fixed = _row_compression(untouched.T, size)
        if fixed == 0:  # these outputs are zero whatever happens
            return A, B, direct, D
        # Columns of the basis: first the states that are fixed to zero, then the free ones.
        A, B, direct = basis.T @ A @ basis, basis.T @ B, direct @ basis
        C = np.vstack([direct[:, fixed:], A[:fixed, fixed:]])
        D = np.vstack([D, B[:fixed]])
        A, B = A[fixed:, fixed:], B[fixed:]


def _row_compression(matrix: np.ndarray, size: float) -> tuple[np.ndarray, int]:
    """Return an orthogonal Q, and the rank r, so that all but the first r rows of Qᵀ M vanish."""
    if not matrix.size:
        return np.eye(len(matrix)), 0
    rotation, sizes, _ = np.linalg.svd(matrix)
    return rotation, int(np.sum(sizes > RANK_TOLERANCE * size))


def _null_space(matrix: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the null space of a matrix of full row rank."""
    rows, columns = matrix.shape
    if not rows:
        return np.eye(columns)
    return np.asarray(np.linalg.svd(matrix)[2][rows:].T)
