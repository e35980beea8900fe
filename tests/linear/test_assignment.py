"""Pairs of a table are those of SciPy's optimiser, also which of several that are equally good."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from clepsydra.linear.assignment import cheapest_assignment


def by_scipy(cost: np.ndarray) -> list[tuple[int, int]]:
    return [
        (int(row), int(column)) for row, column in zip(*linear_sum_assignment(cost), strict=True)
    ]


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (3, 3), (3, 7), (7, 3), (8, 8)])
def test_the_pairs_are_those_of_scipy(shape) -> None:
    random = np.random.default_rng(1)
    for _ in range(200):
        for cost in (random.normal(size=shape), random.integers(-2, 3, shape).astype(float)):
            assert cheapest_assignment(cost) == by_scipy(cost)


def test_equal_entries_pair_each_with_its_own() -> None:
    assert cheapest_assignment(np.ones((4, 4))) == [(place, place) for place in range(4)]


def test_an_empty_table_has_no_pairs() -> None:
    assert cheapest_assignment(np.zeros((0, 3))) == cheapest_assignment(np.zeros((3, 0))) == []
