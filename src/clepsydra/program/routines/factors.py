"""The factors L D Lᵀ of a symmetric matrix, and what is solved by them."""

from __future__ import annotations

import casadi as ca

from clepsydra.program.routine import Index
from clepsydra.program.routine_writer import Elements, Loops

#: A pivot in the place of one that is not above zero: what it divides becomes nothing.
_LARGE = 1e300


def factorise(
    loop: Loops,
    n: int,
    matrix: Elements,
    lower: Elements,
    pivot: Elements,
    *,
    definite: bool = False,
) -> None:
    """Write L below the diagonal of `lower`, and D into `pivot`.

    Only the lower triangle of the matrix is read. `definite`: a pivot that rounding has taken to
    zero or below leaves its unknown where it is.

    References
    ----------
    G. H. Golub, C. F. Van Loan, Matrix Computations, 4th edition, 2013, algorithm 4.1.2.
    """
    for k in loop("k", 0, n):
        pivot[k] = matrix[k, k]
        for j in loop("j", 0, k):
            pivot[k] = pivot[k] - lower[k, j] * lower[k, j] * pivot[j]
        if definite:
            pivot[k] = ca.if_else(pivot[k] > 0, pivot[k], _LARGE)
        for i in loop("i", k + 1, n):
            lower[i, k] = matrix[i, k]
            for j in loop("j", 0, k):
                lower[i, k] = lower[i, k] - lower[i, j] * lower[k, j] * pivot[j]
            lower[i, k] = lower[i, k] / pivot[k]


def substitute(
    loop: Loops, n: int, lower: Elements, pivot: Elements, solution: Elements, *column: int | Index
) -> None:
    """Let a right side become the solution, in its place: L from above, D Lᵀ from below."""
    for i in loop("i", 0, n):
        for j in loop("j", 0, i):
            solution[(i, *column)] = solution[(i, *column)] - lower[i, j] * solution[(j, *column)]
    for k in loop("k", 0, n):
        i = n - 1 - k
        solution[(i, *column)] = solution[(i, *column)] / pivot[i]
        for j in loop("j", i + 1, n):
            solution[(i, *column)] = solution[(i, *column)] - lower[j, i] * solution[(j, *column)]
