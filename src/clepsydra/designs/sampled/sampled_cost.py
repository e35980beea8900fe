"""A quadratic cost over time, taken to the sampling instants without approximation."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class SampledCost(NamedTuple):
    """Held process x(k+1) = Φ x + Γ u and its cost Σ xᵀ Q x + 2 xᵀ N u + uᵀ R u.

    Parameters
    ----------
    held : ndarray [n, n]
        Φ
    moved : ndarray [n, m]
        Γ
    Q, N, R : ndarray [n, n], [n, m], [m, m]
    """

    held: np.ndarray
    moved: np.ndarray
    Q: np.ndarray
    N: np.ndarray
    R: np.ndarray


def sampled_cost(
    A: np.ndarray, B: np.ndarray, Q: np.ndarray, R: np.ndarray, period: float
) -> SampledCost:
    """Return what ∫ xᵀ Q x + uᵀ R u dt is for ẋ = A x + B u with u held over each period.

    The integral over a short time is read off one matrix exponential (Van Loan) and doubled
    until it spans the period: W(2h) = W(h) + Φ(h)ᵀ W(h) Φ(h), a sum of positive parts, where
    the exponential of the whole period would lose all digits once the process settles within
    it.

    Parameters
    ----------
    A, B, Q, R : ndarray [n, n], [n, m], [n, n], [m, m]
        Q and R symmetric and not negative.
    period : float
        [s]

    References
    ----------
    C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Transactions on
    Automatic Control 23(3), 1978, 395-404, doi 10.1109/TAC.1978.1101743.

    Examples
    --------
    An integrator, Q = 1 and R = 1, over 1 s: x(t) = x + t u, so that the integral of x² + u² is
    x² + x u + (1 + 1/3) u².

    >>> one = np.eye(1)
    >>> cost = sampled_cost(0.0 * one, one, one, one, 1.0)
    >>> [round(float(value[0, 0]), 9) for value in (cost.Q, cost.N, cost.R)]
    [1.0, 0.5, 1.333333333]
    """
    from scipy.linalg import expm

    n, m = B.shape
    size = n + m
    both = np.zeros((size, size))
    both[:n, :n], both[:n, n:] = A, B
    weight = np.zeros((size, size))
    weight[:n, :n], weight[n:, n:] = Q, R
    doublings = max(0, math.ceil(math.log2(max(float(np.linalg.norm(both, 1)) * period, 1.0))))
    short = period / 2.0**doublings
    block = np.block([[-both.T, weight], [np.zeros((size, size)), both]])
    # What is no number any more is refused where the cost is used.
    with np.errstate(over="ignore", invalid="ignore"):
        whole = expm(block * short)
        held = whole[size:, size:]
        integral = held.T @ whole[:size, size:]
        for _ in range(doublings):
            integral = integral + held.T @ integral @ held
            held = held @ held
    integral = 0.5 * (integral + integral.T)
    return SampledCost(
        held[:n, :n], held[:n, n:], integral[:n, :n], integral[:n, n:], integral[n:, n:]
    )
