"""Matrices of exact expressions, as arrays of objects."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from math import prod
from typing import Any

import numpy as np

from clepsydra.papers.rational_function import RationalFunction, exact


def matrix(rows: Any) -> np.ndarray:
    """Return a matrix of expressions and whole numbers.

    Examples
    --------
    >>> from clepsydra.papers.rational_function import symbols
    >>> a, b = symbols("a b")
    >>> matrix([[a, 0], [1, b]]) @ inverse(matrix([[a, 0], [1, b]]))
    array([[1, 0],
           [0, 1]], dtype=object)
    """
    return np.frompyfunc(exact, 1, 1)(np.array(rows, dtype=object))


def diagonal(entries: Sequence[Any]) -> np.ndarray:
    """Return the matrix with these entries on its diagonal."""
    return matrix(np.diag(np.array(entries, dtype=object)))


def identity(size: int) -> np.ndarray:
    """Return the identity matrix."""
    return diagonal([1] * size)


def with_values(of: np.ndarray, values: dict[str, Any]) -> np.ndarray:
    """Return a matrix with other expressions, or numbers, for some symbols."""
    return np.frompyfunc(lambda entry: entry.with_values(values), 1, 1)(of)


def jacobian(of: Iterable[RationalFunction], symbols: Iterable[RationalFunction]) -> np.ndarray:
    """Return the derivatives of expressions, a row each, by symbols."""
    return matrix([[each.derivative(str(symbol)) for symbol in symbols] for each in of])


def determinant(of: np.ndarray) -> RationalFunction:
    """Return a determinant as the sum of its permutations, in which nothing is divided."""
    places = range(len(of))
    total = exact(0)
    for order in itertools.permutations(places):
        swapped = sum(order[i] > order[j] for i, j in itertools.combinations(places, 2))
        total += (
            prod((of[i, j] for i, j in zip(places, order, strict=True)), start=exact(1))
            * (-1) ** swapped
        )
    return total


def inverse(of: np.ndarray) -> np.ndarray:
    """Return the inverse of a matrix by elimination."""
    size = len(of)
    rows = np.hstack([of, identity(size)])
    for column in range(size):
        pivot = next(row for row in range(column, size) if rows[row, column] != 0)
        rows[[column, pivot]] = rows[[pivot, column]]
        rows[column] = rows[column] / rows[column, column]
        for row in range(size):
            if row != column:
                rows[row] = rows[row] - rows[row, column] * rows[column]
    return rows[:, size:]
