"""A linear model held over a sample, its cost, and a Riccati step, as expressions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca

from clepsydra.controllers.blocks.validity import all_of

#: Terms of the power series; its argument has a norm of at most 1/4 (`doublings_for`).
TERMS = 8
LARGEST_ARGUMENT = 0.25


class SampledExpressions(NamedTuple):
    """x(k+1) = Φ x + Γ u and the cost of a sample, zᵀ W z of z = [x; u].

    Parameters
    ----------
    held, moved : casadi.SX [n, n], [n, m]
        Φ and Γ.
    cost : casadi.SX [n + m, n + m]
        W
    """

    held: ca.SX
    moved: ca.SX
    cost: ca.SX


def doublings_for(norm: float) -> int:
    """Return how often a step is halved so that the power series has an argument of 1/4.

    `norm`: ‖[A B]‖ Δt, in scaled units.

    Examples
    --------
    >>> doublings_for(0.2), doublings_for(0.3), doublings_for(4.0)
    (0, 1, 4)
    """
    count = 0
    while norm > LARGEST_ARGUMENT:
        norm, count = 0.5 * norm, count + 1
    return count


def sampled_expressions(
    A: ca.SX, B: ca.SX, weight: ca.SX | None, time: ca.SX, doublings: int
) -> SampledExpressions:
    """Return ẋ = A x + B u held over a time, and the integral of its cost zᵀ S z.

    e^(N h) and its integrated cost come from their power series over a time halved so often
    that they converge to rounding, and are doubled until they span the sample:
    W(2h) = W(h) + M(h)ᵀ W(h) M(h), M(2h) = M(h)². Only products and sums, so that a controller
    can compute it.

    `weight`: S [n + m, n + m], symmetric; None where no cost is asked for; `time` [s].

    References
    ----------
    C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Transactions on
    Automatic Control 23(3), 1978, 395-404, doi 10.1109/TAC.1978.1101743.

    Examples
    --------
    An integrator, Q = 1 and R = 1, over 1 s: x² + x u + (1 + 1/3) u².

    >>> found = sampled_expressions(ca.SX(0), ca.SX(1), ca.SX.eye(2), ca.SX(1), 2)
    >>> [round(value, 9) for value in ca.evalf(found.cost).nonzeros()]
    [1.0, 0.5, 0.5, 1.333333333]
    """
    n, m = B.shape
    size = n + m
    N = ca.vertcat(ca.horzcat(ca.sparsify(A), ca.sparsify(B)), ca.SX(m, size))
    short = time * 0.5**doublings
    step = N * short
    term = held = ca.SX.eye(size)
    for k in range(1, TERMS + 1):
        term = step @ term * (1.0 / k)
        held = held + term
    integral = ca.SX(size, size)
    if weight is not None:
        part = integral = ca.sparsify(weight) * short
        for k in range(1, TERMS + 1):
            half = step.T @ part * (1.0 / (k + 1))
            part = half + half.T
            integral = integral + part
    for _ in range(doublings):
        if weight is not None:
            integral = integral + held.T @ integral @ held
        held = held @ held
    return SampledExpressions(held[:n, :n], held[:n, n:], integral)


def upper_triangle(matrix: ca.SX) -> list[ca.SX]:
    """Return the entries on and above the diagonal, row by row."""
    n = matrix.shape[0]
    return [matrix[i, j] for i in range(n) for j in range(i, n)]


def from_upper_triangle(entries: Sequence[ca.SX], size: int) -> ca.SX:
    """Return the symmetric matrix with these entries on and above its diagonal."""
    return ca.tril2symm(ca.SX(ca.Sparsity.lower(size), ca.vertcat(*entries)))


class RiccatiStep(NamedTuple):
    """The gain that follows from a cost to go, the cost to go a sample earlier, and if it holds.

    Parameters
    ----------
    gain : casadi.SX [m, n]
        K of u = −K x.
    definite : casadi.SX
        Whether every pivot of R + Γᵀ P Γ is above zero.
    """

    gain: ca.SX
    cost: ca.SX
    definite: ca.SX


def riccati_step(held: ca.SX, moved: ca.SX, cost: ca.SX, to_go: ca.SX) -> RiccatiStep:
    """Return one step of the Riccati difference equation.

    K = (R + Γᵀ P Γ)⁻¹ (Γᵀ P Φ + Nᵀ) by a Cholesky factorisation without roots, L D Lᵀ, and

        P⁺ = (Φ − Γ K)ᵀ P (Φ − Γ K) + [I; −K]ᵀ W [I; −K],

    in which rounding cannot make P negative. A pivot that is not above zero is replaced by one,
    so that nothing is divided by zero; the step then does not hold.

    `held`, `moved`: Φ [n, n] and Γ [n, m]; `cost`: W = [Q N; Nᵀ R] [n + m, n + m]; `to_go`: P
    [n, n], symmetric.

    References
    ----------
    B. D. O. Anderson and J. B. Moore, Optimal Control: Linear Quadratic Methods,
    Prentice Hall 1990, chapters 2 and 4.

    Examples
    --------
    x⁺ = x + u with Q = R = 1 and no cost to go: K = 0 and P⁺ = 1.

    >>> one = ca.SX(1)
    >>> step = riccati_step(one, one, ca.SX.eye(2), ca.SX(0))
    >>> float(ca.evalf(step.gain)), float(ca.evalf(step.cost)), bool(ca.evalf(step.definite))
    (0.0, 1.0, True)
    """
    n, _m = moved.shape
    carried = to_go @ moved
    inner = cost[n:, n:] + moved.T @ carried
    right = carried.T @ held + cost[:n, n:].T
    gain, definite = _solved(inner, right)
    closed = held - moved @ gain
    both = ca.vertcat(ca.SX.eye(n), -gain)
    following = closed.T @ to_go @ closed + both.T @ cost @ both
    return RiccatiStep(gain, following, definite)


def _solved(matrix: ca.SX, right: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return S⁻¹ Y of a symmetric S by L D Lᵀ, and whether S is positive definite."""
    m, pivots, definite = matrix.shape[0], [], []
    # Below its diagonal the matrix becomes L, and the right side what is divided by D.
    matrix, rows = ca.SX(matrix), ca.vertsplit(right)
    for k in range(m):
        definite.append(matrix[k, k] > 0)
        pivots.append(ca.if_else(definite[k], matrix[k, k], 1))
        for i in range(k + 1, m):
            matrix[i, k] = matrix[i, k] / pivots[k]
            rows[i] = rows[i] - matrix[i, k] * rows[k]
            for j in range(k + 1, i + 1):
                matrix[i, j] = matrix[i, j] - matrix[i, k] * matrix[j, k] * pivots[k]
    rows = [row / pivot for row, pivot in zip(rows, pivots, strict=True)]
    for i in reversed(range(m)):
        for k in range(i + 1, m):
            rows[i] = rows[i] - matrix[k, i] * rows[k]
    return ca.vertcat(*rows), all_of(definite)
