"""What acts on each other in a circle: the strongly connected components of a graph."""

from __future__ import annotations

import numpy as np


def circles(acts: np.ndarray) -> list[np.ndarray]:
    """Return the places that act on each other, directly or by others, in groups.

    What is in no circle is a group of its own. Each group is in order, and they are in the order
    of their first.

    Parameters
    ----------
    acts : ndarray [n, n] of bool
        Whether one place acts on another; [to, from] or [from, to] makes no difference.

    References
    ----------
    R. Tarjan, Depth-first search and linear graph algorithms, SIAM Journal on Computing 1(2),
    1972, 146-160, doi 10.1137/0201010.

    Examples
    --------
    >>> circle = np.array([[0, 0, 1], [1, 0, 0], [1, 0, 0]], bool)
    >>> [group.tolist() for group in circles(circle)]
    [[0, 2], [1]]
    """
    following = [np.flatnonzero(row).tolist() for row in acts]
    # When a place was reached, and the earliest place still open that it leads back to.
    reached: dict[int, int] = {}
    earliest: dict[int, int] = {}
    still_open: list[int] = []
    groups: list[list[int]] = []
    closed: set[int] = set()
    for start in range(len(following)):
        way = [] if start in reached else [start]
        while way:
            place = way[-1]
            if place not in reached:
                reached[place] = earliest[place] = len(reached)
                still_open.append(place)
            new = next((other for other in following[place] if other not in reached), None)
            if new is not None:
                way.append(new)
                continue
            way.pop()
            for other in following[place]:
                if other not in closed:
                    earliest[place] = min(earliest[place], earliest[other])
            if earliest[place] == reached[place]:
                first = still_open.index(place)
                groups.append(sorted(still_open[first:]))
                closed |= set(groups[-1])
                del still_open[first:]
    return [np.array(group) for group in sorted(groups)]
