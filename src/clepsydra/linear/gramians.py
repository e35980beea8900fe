"""Gramians: how far inputs drive the states, and how much the outputs show of them."""

from __future__ import annotations

import numpy as np


def controllability_gramian(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return P = ∫ e^(At) B Bᵀ e^(Aᵀt) dt from zero to infinity, from A P + P Aᵀ + B Bᵀ = 0.

    Parameters
    ----------
    A, B : ndarray [n, n], [n, m]
        All eigenvalues of A in the left half-plane; see `stable_part`.

    Returns
    -------
    ndarray [n, n]
        Symmetric. xᵀ P⁻¹ x is the least ∫|u|² dt that leads from zero to the state x.

    Examples
    --------
    >>> controllability_gramian(np.array([[-0.5]]), np.array([[2.0]]))
    array([[4.]])
    """
    from scipy.linalg import solve_continuous_lyapunov

    gramian = solve_continuous_lyapunov(A, -B @ B.T) if len(A) else np.zeros((0, 0))
    return np.asarray((gramian + gramian.T) / 2.0)


def observability_gramian(A: np.ndarray, C: np.ndarray) -> np.ndarray:
    """Return Q = ∫ e^(Aᵀt) Cᵀ C e^(At) dt from zero to infinity.

    Parameters
    ----------
    A, C : ndarray [n, n], [q, n]
        All eigenvalues of A in the left half-plane; see `stable_part`.

    Returns
    -------
    ndarray [n, n]
        Symmetric. xᵀ Q x is ∫|y|² dt from the state x without inputs.

    Examples
    --------
    >>> observability_gramian(np.array([[-0.5]]), np.array([[2.0]]))
    array([[4.]])
    """
    return controllability_gramian(A.T, C.T)
