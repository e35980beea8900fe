"""Groups that act on each other in a circle are the strongly connected components of SciPy."""

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from clepsydra.linear.circles import circles


@pytest.mark.parametrize("count", range(9))
@pytest.mark.parametrize("share", [0.05, 0.15, 0.3, 0.6])
def test_the_groups_are_those_of_scipy(count, share) -> None:
    random = np.random.default_rng(count)
    for _ in range(50):
        acts = random.random((count, count)) < share
        number, group = connected_components(acts, connection="strong") if count else (0, [])
        wanted = sorted(np.flatnonzero(group == each).tolist() for each in range(number))
        assert [each.tolist() for each in circles(acts)] == wanted


def test_a_long_circle_is_one_group_and_a_long_chain_many() -> None:
    chain = np.eye(3000, k=-1, dtype=bool)
    assert len(circles(chain)) == 3000
    chain[0, -1] = True
    assert len(circles(chain)) == 1
