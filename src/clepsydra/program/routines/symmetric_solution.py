"""The solution of linear equations with a symmetric matrix, by L D Lᵀ without square roots."""

from __future__ import annotations

import casadi as ca

from clepsydra.program.routine_library import Family, Written
from clepsydra.program.routine_writer import Elements, Loops
from clepsydra.program.routines.factors import factorise, substitute


def _written(n: int, sides: int) -> Written:
    def algorithm(loop: Loops, *arrays: Elements) -> None:
        matrix, right, solution, pivot, lower = arrays
        loop.note("The matrix is L D L', with ones on the diagonal of L.")
        factorise(loop, n, matrix, lower, pivot)
        loop.note("L from above, then D L' from below.")
        for side in loop("side", 0, sides):
            for i in loop("i", 0, n):
                solution[i, side] = right[i, side]
            substitute(loop, n, lower, pivot, solution, side)

    return Written(
        algorithm,
        {"matrix": (n, n), "right": (n, sides)},
        {"solution": (n, sides), "pivot": (n,)},
        {"lower": (n, n)},
    )


SYMMETRIC_SOLUTION = Family(
    "symmetric_solution",
    _written,
    "Solution of linear equations with a symmetric matrix, by L D L'.",
)


def symmetric_solution(matrix: ca.SX, right: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the solution of A X = B for a symmetric matrix, and the pivots of A = L D Lᵀ.

    The matrix is definite where every pivot is above zero. Only its lower triangle is read, and
    nothing is exchanged: an indefinite matrix may lose every digit, or divide by zero.

    Parameters
    ----------
    matrix : casadi.SX [n, n]
    right : casadi.SX [n, m]

    Returns
    -------
    solution, pivots : casadi.SX [n, m], [n]

    Examples
    --------
    >>> x, pivots = symmetric_solution(ca.SX([[4, 2], [2, 3]]), ca.SX([2, 5]))
    >>> ca.Function("f", [], [x, pivots])()
    {'o0': DM([-0.5, 2]), 'o1': DM([4, 2])}
    """
    n, sides = right.shape
    solution, pivots = SYMMETRIC_SOLUTION((n, sides), matrix, right)
    return solution, pivots
