"""A linear model held over a sample, and symmetric matrices by their entries, as expressions."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.program.routines.held_model import SHARES, TERMS

#: The largest norm of the argument of the power series.
LARGEST_ARGUMENT = 0.25


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


def held_matrix(A: ca.SX, time: ca.SX, doublings: int) -> ca.SX:
    """Return Φ = e^(A t), by its power series over a time halved so often that it converges.

    Only products and sums, so that a controller can compute it; zeros of A cost nothing.

    `A`: [n, n]; `time` [s]; `doublings`: see `doublings_for`.

    Examples
    --------
    >>> round(float(ca.evalf(held_matrix(ca.SX(-0.5), ca.SX(2), 3))), 9)
    0.367879441
    """
    step = ca.sparsify(A) * (time * 0.5**doublings)
    term = held = ca.SX.eye(A.shape[0])
    for share in SHARES[:TERMS]:
        term = step @ term * share
        held = held + term
    for _ in range(doublings):
        held = held @ held
    return held


def upper_triangle(matrix: ca.SX) -> list[ca.SX]:
    """Return the entries on and above the diagonal, row by row."""
    n = matrix.shape[0]
    return [matrix[i, j] for i in range(n) for j in range(i, n)]


def from_upper_triangle(entries: Sequence[ca.SX], size: int) -> ca.SX:
    """Return the symmetric matrix with these entries on and above its diagonal."""
    return ca.tril2symm(ca.SX(ca.Sparsity.lower(size), ca.vertcat(*entries)))
