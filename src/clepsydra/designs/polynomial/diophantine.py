"""Diophantine equations of polynomials, solved in rational numbers: the identity is exact."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from clepsydra.base.errors import InputError

#: Coefficients of 1, z^-1, z^-2, …
Polynomial = tuple[Fraction, ...]


def rational(polynomial: Sequence[float | Fraction]) -> Polynomial:
    """Return a polynomial in exact rational numbers; a float is one.

    Examples
    --------
    >>> rational([0.5, 2.0])
    (Fraction(1, 2), Fraction(2, 1))
    """
    return tuple(Fraction(value) for value in polynomial)


def product(first: Sequence[float | Fraction], second: Sequence[float | Fraction]) -> Polynomial:
    """Return the product of two polynomials, exact.

    Examples
    --------
    >>> [int(value) for value in product([1, -1], [1, 2])]
    [1, 1, -2]
    """
    one, two = (np.array(rational(each)) for each in (first, second))
    return tuple(np.convolve(one, two))


def solve_diophantine(
    A: Sequence[float | Fraction],
    B: Sequence[float | Fraction],
    C: Sequence[float | Fraction],
    *,
    degree_x: int,
    degree_y: int,
) -> tuple[Polynomial, Polynomial]:
    """Solve A X + B Y = C for polynomials X and Y in z^-1 of given degrees.

    Floats are taken as the rational numbers that they are, and Gauss's elimination in rational
    numbers makes the identity hold without any rounding, however near to one another the roots
    are.

    Parameters
    ----------
    A, B, C : sequence of float or Fraction
        Coefficients of 1, z^-1, z^-2, …
    degree_x, degree_y : int
        With as many unknowns as equations: (degree of the products) + 1.

    Raises
    ------
    InputError
        The equations leave X and Y open or contradict one another: A and B share a root, or a
        degree does not fit.

    References
    ----------
    V. Kučera, Automatica 29(6), 1993, 1361-1375.

    Examples
    --------
    (1 − z^-1) x0 + (1 + z^-1) y0 = 1:

    >>> X, Y = solve_diophantine([1, -1], [1, 1], [1], degree_x=0, degree_y=0)
    >>> X, Y
    ((Fraction(1, 2),), (Fraction(1, 2),))
    """
    a, b, c = rational(A), rational(B), rational(C)
    unknowns = degree_x + degree_y + 2
    rows = max(len(a) + degree_x, len(b) + degree_y, len(c))
    table = np.full((rows, unknowns + 1), Fraction(0))
    shifted = [(a, k) for k in range(degree_x + 1)] + [(b, k) for k in range(degree_y + 1)]
    for column, (polynomial, shift) in enumerate([*shifted, (c, 0)]):
        table[shift : shift + len(polynomial), column] = polynomial
    values = _solved(table, unknowns)
    if values is None:
        raise InputError(
            "Diophantine equation",
            f"A of degree {len(a) - 1}, B of degree {len(b) - 1}, degrees {degree_x} and "
            f"{degree_y} of the unknowns",
            "polynomials A and B without a common root, and degrees that fit",
            "cancel what A and B share",
        )
    return tuple(values[: degree_x + 1]), tuple(values[degree_x + 1 :])


def _solved(table: np.ndarray, unknowns: int) -> list[Fraction] | None:
    """Return the solution of a table [rows, unknowns + 1]; None where there is not just one."""
    for column in range(unknowns):
        pivots = np.flatnonzero(table[column:, column])
        if not len(pivots):
            return None
        pivot = column + pivots[0]
        table[[column, pivot]] = table[[pivot, column]]
        table[column] /= table[column, column]
        for row in np.flatnonzero(table[:, column]):
            if row != column:
                table[row] -= table[row, column] * table[column]
    return None if any(table[unknowns:, -1]) else list(table[:unknowns, -1])
