"""A way for each pipe through a grid: short, with few bends, and few crossings with others."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

from clepsydra.report.drawing.bodies import Point

_BEND, _CROSSING = 3.0, 7.0
#: What a way costs that has to run through something, where no other way is left.
_THROUGH = 200.0
_WAYS = ((1, 0), (-1, 0), (0, 1), (0, -1))

Ends = Sequence[tuple[Point, Point, float]]


class GridRouter:
    """A grid with obstacles and the pipes that were laid in it.

    Pipes may cross at right angles. They never lie on each other, and none bends on another.

    Parameters
    ----------
    width, height : int

    Examples
    --------
    >>> router = GridRouter(10, 5)
    >>> router.find([((0, 2), (1, 0), 0.0)], [((9, 2), (-1, 0), 0.0)])
    [(0, 2), (9, 2)]
    >>> router.block((4, 1, 4, 3))
    >>> len(router.find([((0, 2), (1, 0), 0.0)], [((9, 2), (-1, 0), 0.0)]))  # around it
    5
    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.blocked: set[Point] = set()
        self.dear: dict[Point, float] = {}
        self.level: set[Point] = set()
        self.upright: set[Point] = set()

    def block(self, area: tuple[int, int, int, int]) -> None:
        """Let no pipe through an area."""
        left, top, right, bottom = area
        self.blocked |= {(x, y) for x in range(left, right + 1) for y in range(top, bottom + 1)}

    def lay(self, points: Sequence[Point]) -> None:
        """Lay a pipe along corner points."""
        for (x1, y1), (x2, y2) in pairwise(points):
            for x in range(min(x1, x2), max(x1, x2) + 1):
                for y in range(min(y1, y2), max(y1, y2) + 1):
                    (self.level if y1 == y2 else self.upright).add((x, y))

    def find(self, starts: Ends, goals: Ends, *, through: bool = False) -> list[Point]:
        """Return the corner points of the best way from any start to any goal; empty for none.

        Parameters
        ----------
        starts, goals : sequence of (point, direction outward, cost)
        through : bool
            Run through obstacles and along other pipes where there is no other way.
        """
        ends: dict[Point, list[tuple[Point, float]]] = {}
        for point, way, cost in goals:
            ends.setdefault(point, []).append(((-way[0], -way[1]), cost))
        if not ends or not starts:
            return []
        nearest = _distance_to(ends)
        queue: list[tuple[float, float, Point, Point]] = []
        before: dict[tuple[Point, Point], tuple[Point, Point] | None] = {}
        best: dict[tuple[Point, Point], float] = {}
        for point, way, cost in starts:
            if self._open(point, way, through) is not None and cost < best.get((point, way), 1e9):
                best[point, way], before[point, way] = cost, None
                heapq.heappush(queue, (cost + nearest(point), cost, point, way))

        def note(state: tuple[Point, Point], total: float, rest: float) -> None:
            if total < best.get(state, 1e9):
                best[state], before[state] = total, (point, way)
                heapq.heappush(queue, (total + rest, total, *state))

        while queue:
            _, cost, point, way = heapq.heappop(queue)
            if way == (0, 0):
                return _corners(before, (point, way))
            if cost > best[point, way]:
                continue
            for arriving, extra in ends.get(point, ()):
                bend = way != arriving
                if through or point not in (self.upright if way[1] == 0 else self.level):
                    total = cost + extra + _BEND * bend
                    note((point, (0, 0)), total, 0.0)
            free = through or not (point in self.level and point in self.upright)
            crossing = point in self.level or point in self.upright
            for turn in _WAYS:
                if turn == (-way[0], -way[1]) or (
                    turn != way and (crossing or not free) and not through
                ):
                    continue
                there = (point[0] + turn[0], point[1] + turn[1])
                step = self._open(there, turn, through)
                if step is None:
                    continue
                total = cost + step + _BEND * (turn != way)
                note((there, turn), total, nearest(there))
        return []

    def _open(self, point: Point, way: Point, through: bool) -> float | None:
        """Return what a step to a point costs; None where it may not be made."""
        x, y = point
        if not (0 <= x < self.width and 0 <= y < self.height):
            return None
        along, other = (self.level, self.upright) if way[1] == 0 else (self.upright, self.level)
        if point in self.blocked or point in along:
            return _THROUGH if through else None
        return 1.0 + self.dear.get(point, 0.0) + (_CROSSING if point in other else 0.0)


def _distance_to(points: Iterable[Point]) -> Callable[[Point], float]:
    xs, ys = zip(*points, strict=True)
    left, right, top, bottom = min(xs), max(xs), min(ys), max(ys)

    def distance(point: Point) -> float:
        x, y = point
        return max(left - x, 0, x - right) + max(top - y, 0, y - bottom)

    return distance


def _corners(
    before: dict[tuple[Point, Point], tuple[Point, Point] | None], state: tuple[Point, Point]
) -> list[Point]:
    points: list[Point] = []
    here: tuple[Point, Point] | None = state
    while here is not None:
        points.append(here[0])
        here = before[here]
    return straightened(points[::-1])


def straightened(points: Sequence[Point]) -> list[Point]:
    """Return a way without the points that are no corners.

    Examples
    --------
    >>> straightened([(0, 0), (0, 1), (0, 1), (0, 2), (1, 2)])
    [(0, 0), (0, 2), (1, 2)]
    """
    kept: list[Point] = []
    for point in points:
        if kept and point == kept[-1]:
            continue
        if len(kept) > 1 and (
            kept[-2][0] == kept[-1][0] == point[0] or kept[-2][1] == kept[-1][1] == point[1]
        ):
            kept[-1] = point
        else:
            kept.append(point)
    return kept
