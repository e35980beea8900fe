"""Rows and columns of a table paired so that the sum of the entries is the smallest."""

from __future__ import annotations

import math

import numpy as np


def cheapest_assignment(cost: np.ndarray) -> list[tuple[int, int]]:
    """Return the (row, column) of each pair, in the order of the rows; all of the fewer are paired.

    The tables are small, and this is there at once, where an optimiser takes a tenth of a second
    to load.

    Parameters
    ----------
    cost : ndarray [n, m]
        Finite.

    References
    ----------
    D. F. Crouse, On implementing 2D rectangular assignment algorithms, IEEE Transactions on
    Aerospace and Electronic Systems 52(4), 2016, 1679-1696, doi 10.1109/TAES.2016.140952.

    Examples
    --------
    >>> cheapest_assignment(np.array([[4.0, 1.0, 3.0], [2.0, 0.0, 5.0]]))
    [(0, 1), (1, 0)]
    """
    rows, columns = cost.shape
    if columns < rows:
        return sorted((row, column) for column, row in cheapest_assignment(cost.T))
    paired = _Pairs(cost.tolist(), columns)
    for row in range(rows):
        paired.add(row)
    return sorted(paired.column_of.items())


class _Pairs:
    """The cheapest pairs of the rows so far, and the prices of rows and columns that prove it."""

    def __init__(self, cost: list[list[float]], columns: int) -> None:
        self.cost = cost
        self.row_price, self.column_price = [0.0] * len(cost), [0.0] * columns
        self.column_of: dict[int, int] = {}
        self.row_of: dict[int, int] = {}

    def add(self, new: int) -> None:
        """Pair a further row, and others anew, along the shortest path to a free column."""
        shortest = [math.inf] * len(self.column_price)
        before: dict[int, int] = {}
        left = list(reversed(range(len(shortest))))
        row, length, passed = new, 0.0, []
        while True:
            nearest, place = math.inf, -1
            for at, column in enumerate(left):
                further = length + self.cost[row][column]
                further = further - self.row_price[row] - self.column_price[column]
                if further < shortest[column]:
                    shortest[column], before[column] = further, row
                free = column not in self.row_of
                if shortest[column] < nearest or (free and shortest[column] == nearest):
                    nearest, place = shortest[column], at
            length, found = nearest, left[place]
            left[place] = left[-1]
            left.pop()
            passed.append(found)
            if found not in self.row_of:
                break
            row = self.row_of[found]
        self.row_price[new] += length
        for column in passed[:-1]:
            self.row_price[self.row_of[column]] += length - shortest[column]
        for column in passed:
            self.column_price[column] -= length - shortest[column]
        column = found
        while True:
            row = before[column]
            self.row_of[column] = row
            self.column_of[row], column = column, self.column_of.get(row, column)
            if row == new:
                return
