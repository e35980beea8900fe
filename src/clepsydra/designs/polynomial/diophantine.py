"""Diophantine equations of polynomials, solved in rational numbers: the identity is exact."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from clepsydra.base.errors import InputError

#: Coefficients of 1, z^-1, z^-2, …
Polynomial = tuple[Fraction, ...]


class Solution(NamedTuple):
    """X and Y of A X + B Y = C."""

    X: Polynomial
    Y: Polynomial


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
    one, two = rational(first), rational(second)
    total = [Fraction(0)] * (len(one) + len(two) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(two):
            total[i + j] += a * b
    return tuple(total)


def solve_diophantine(
    A: Sequence[float | Fraction],
    B: Sequence[float | Fraction],
    C: Sequence[float | Fraction],
    *,
    degree_x: int,
    degree_y: int,
) -> Solution:
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
    table = [[Fraction(0)] * (unknowns + 1) for _ in range(rows)]
    for column in range(degree_x + 1):
        for i, value in enumerate(a):
            table[i + column][column] += value
    for column in range(degree_y + 1):
        for i, value in enumerate(b):
            table[i + column][degree_x + 1 + column] += value
    for i, value in enumerate(c):
        table[i][-1] = value
    values = _solved(table, unknowns)
    if values is None:
        raise InputError(
            "Diophantine equation",
            f"A of degree {len(a) - 1}, B of degree {len(b) - 1}, degrees {degree_x} and "
            f"{degree_y} of the unknowns",
            "polynomials A and B without a common root, and degrees that fit",
            "cancel what A and B share",
        )
    return Solution(tuple(values[: degree_x + 1]), tuple(values[degree_x + 1 :]))


def _solved(table: list[list[Fraction]], unknowns: int) -> list[Fraction] | None:
    """Return the solution of a table [rows, unknowns + 1]; None where there is not just one."""
    done = 0
    for column in range(unknowns):
        pivot = next((row for row in range(done, len(table)) if table[row][column]), None)
        if pivot is None:
            return None
        table[done], table[pivot] = table[pivot], table[done]
        lead = table[done][column]
        table[done] = [value / lead for value in table[done]]
        for row in range(len(table)):
            factor = table[row][column]
            if row != done and factor:
                table[row] = [
                    value - factor * above
                    for value, above in zip(table[row], table[done], strict=True)
                ]
        done += 1
    if any(row[-1] for row in table[done:]):
        return None
    return [table[row][-1] for row in range(unknowns)]
