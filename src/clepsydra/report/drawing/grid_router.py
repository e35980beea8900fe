"""A way for each pipe through a grid: short, with few bends, and few crossings with others."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from clepsydra.report.drawing.bodies import Pin, Point

_BEND, _CROSSING = 3.0, 7.0
#: Of ways that cost the same, one that bends near its ends and that runs higher up is better.
_EARLY, _LOWER = 0.1, 1e-3
#: What a way costs that has to run through something, where no other way is left.
_THROUGH = 200.0


class GridRouter:
    """A grid with obstacles and the pipes that were laid in it.

    Pipes may cross at right angles. They never lie on each other, and none bends on another. The
    best way is the shortest path in a graph with two nodes a point, one for level pipes and one
    for upright ones, joined where a pipe may bend.
    """

    def __init__(self, width: int, height: int) -> None:
        self.blocked = np.zeros((width, height), bool)
        self.dear = np.zeros((width, height))
        #: Where pipes lie that are level, and that are upright.
        self.laid = np.zeros((2, width, height), bool)

    def block(self, area: tuple[int, int, int, int]) -> None:
        """Let no pipe through an area."""
        left, top, right, bottom = area
        self.blocked[left : right + 1, top : bottom + 1] = True

    def lay(self, points: Sequence[Point]) -> None:
        """Lay a pipe along corner points."""
        for one, other in pairwise(points):
            (x1, x2), (y1, y2) = (sorted(ends) for ends in zip(one, other, strict=True))
            self.laid[int(x1 == x2), x1 : x2 + 1, y1 : y2 + 1] = True

    def find(
        self, starts: Sequence[Pin], goals: Sequence[Pin], *, through: bool = False
    ) -> list[Point]:
        """Return the corner points of the best way from any start to any goal; empty for none.

        Parameters
        ----------
        through : bool
            Run through obstacles and along other pipes where there is no other way.
        """
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import dijkstra

        barred = self.blocked | self.laid
        for x, y in (point for pin in (*starts, *goals) for point in pin.lead[:-1]):
            barred[:, x, y] = True
        cost = 1.0 + self.dear + _CROSSING * self.laid[::-1]
        cost += _LOWER * np.arange(cost.shape[-1])
        cost = np.where(barred, cost + _THROUGH if through else np.inf, cost)
        level, upright = node = np.arange(cost.size).reshape(cost.shape)
        start, goal = cost.size, cost.size + 1
        free = ~self.laid.any(axis=0) | through
        pairs = [(level[:-1], level[1:]), (upright[:, :-1], upright[:, 1:])]
        edges = [(one, two, cost.ravel()[two]) for pair in pairs for one, two in (pair, pair[::-1])]
        bends = level[free], upright[free]
        edges += [(one, two, np.full(one.shape, _BEND)) for one, two in (bends, bends[::-1])]
        for place, pins in ((start, starts), (goal, goals)):
            for pin in pins:
                own = int(pin.way[0] == 0)
                for axis, bend in ((own, 0.0), (1 - own, _BEND - _EARLY)):
                    there = (axis, *pin.end)
                    barred_there = np.isinf(cost[there]) or self.laid[:, *pin.end].any()
                    weight = np.inf if barred_there and not through else 1.0 + pin.cost + bend
                    ends = (node[there], goal) if place == goal else (start, node[there])
                    edges.append((*ends, weight))
        ones, twos, weights = (
            np.concatenate([np.ravel(part) for part in parts]) for parts in zip(*edges, strict=True)
        )
        known = np.isfinite(weights)
        graph = csr_array((weights[known], (ones[known], twos[known])), shape=(goal + 1, goal + 1))
        _, before = dijkstra(graph, indices=start, return_predecessors=True)
        points, here = [], before[goal]
        while here >= 0 and here != start:
            _, x, y = np.unravel_index(here, cost.shape)
            points.append((int(x), int(y)))
            here = before[here]
        return straightened(points[::-1])


def straightened(points: Sequence[Point]) -> list[Point]:
    """Return points without those where a line runs straight on.

    Examples
    --------
    >>> straightened([(0, 0), (1, 0), (1, 0), (3, 0), (3, 2)])
    [(0, 0), (3, 0), (3, 2)]
    """
    kept: list[Point] = []
    for point in points:
        if kept and point == kept[-1]:
            continue
        if len(kept) > 1 and any(kept[-2][k] == kept[-1][k] == point[k] for k in (0, 1)):
            kept[-1] = point
        else:
            kept.append(point)
    return kept
