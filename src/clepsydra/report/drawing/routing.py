"""Pipes and signals of the process drawing: each finds its way between what stands there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from clepsydra.report.drawing.bodies import UP, Pin, Point
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import FlowGraph
from clepsydra.report.drawing.frame import Labels
from clepsydra.report.drawing.placement import Placement

#: With more room and in another order each time; the last one runs through what is in the way.
_ATTEMPTS = 10
#: In this order they are laid, and each arches over those before it.
ORDER = ("pipe", "tap", "signal")

Kind = Literal["pipe", "signal", "tap"]


@dataclass(eq=False)
class Pipe:
    """A pipe or a signal line as its corner points, from source to end.

    Parameters
    ----------
    line : str
        The element that makes the liquid flow, or the junction that it comes from.
    source, end : str
        The elements between which it runs.
    points : list of (x, y)
        In lines of the grid.
    arrow : bool
        It ends in an arrow.
    kind : {"pipe", "signal", "tap"}
        A tap joins a transmitter to what it measures.
    """

    line: str
    source: str
    end: str
    points: list[Point]
    arrow: bool = False
    kind: Kind = "pipe"


@dataclass(eq=False)
class Routes:
    """A placement with its pipes.

    Parameters
    ----------
    placement : Placement
    pipes : list of Pipe
    basin_uses : list of (x, shelf, reservoir)
    """

    placement: Placement
    pipes: list[Pipe] = field(default_factory=list)
    basin_uses: list[tuple[int, int, str]] = field(default_factory=list)


def route(graph: FlowGraph, labels: Labels, functions: Sequence[ControlFunction] = ()) -> Routes:
    """Place all parts and find the way of every pipe, with more room where there is too little.

    Parameters
    ----------
    labels : dict
        Element to the lines written beside it.
    functions : sequence of ControlFunction
        Of the controller.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.report.drawing.flow_graph import flow_graph
    >>> len(route(flow_graph(load_process("quadruple-tank")), {}).pipes)
    22
    """
    urgent: list[tuple[str, str]] = []
    for attempt in range(_ATTEMPTS + 1):
        placement = Placement(graph, labels, functions, slack=3 * (attempt // 2))
        router = _Router(placement, through=attempt == _ATTEMPTS)
        stuck = router.lay_all(urgent)
        if stuck is None:
            break
        # What found no way among the others goes before them.
        urgent = [stuck, *urgent]
    _close_up(router.routes)
    return router.routes


@dataclass(frozen=True)
class _Way:
    """A pipe or a signal line that is to be laid between pins of two roles."""

    line: str
    source: str
    role: str
    end: str
    role_there: str
    kind: Kind = "pipe"

    @property
    def ends(self) -> tuple[str, str]:
        return (self.source, self.end)


class _Router:
    def __init__(self, placement: Placement, *, through: bool) -> None:
        self.placement, self.through = placement, through
        self.routes = Routes(placement)
        self.grid = GridRouter(placement.width + 4, placement.height + 2)
        for body in placement.bodies.values():
            for area in body.areas:
                self.grid.block(area)
            for pin in body.pins:
                self.grid.dear[pin.end] = 4.0
        self.grid.dear[:, placement.basin_rows] = 8.0

    def _use(self, x: int, shelf: int, reservoir: str) -> None:
        """Keep the place below where a pipe reaches a reservoir for its name."""
        self.routes.basin_uses.append((x, shelf, reservoir))
        row = self.placement.basin_rows[shelf]
        self.grid.block((x - 2, row + 1, x + 2, row + 3))

    def lay_all(self, urgent: Sequence[tuple[str, str]]) -> tuple[str, str] | None:
        """Lay every pipe, some before others; return source and end of one that found no way."""
        placement = self.placement
        targets = {link.name: link.targets for link in placement.graph.links}
        for name, points in placement.fixed:
            self.grid.lay(points)
            arrow = placement.bodies[name].symbol == "stub" or not targets[name]
            self.routes.pipes.append(Pipe(name, name, name, points, arrow))
        ways = sorted(
            self._ways(),
            key=lambda way: (way.ends not in urgent, ORDER.index(way.kind), self._length(way)),
        )
        return next((way.ends for way in ways if not self._lay(way) and not self.through), None)

    def _ways(self) -> Iterator[_Way]:
        placement, graph = self.placement, self.placement.graph
        fixed = {name for name, _ in placement.fixed}
        for link in graph.links:
            name = link.name
            if placement.bodies[name].symbol == "stub":
                continue
            for source in link.sources:
                if name not in fixed or source not in graph.vessels:
                    yield _Way(name, source, "side", name, "in")
            for target in link.targets:
                yield _Way(name, name, "out", target, "side" if link.submerged else "in")
        for junction in graph.junctions:
            for _, target in junction.branches:
                yield _Way(junction.name, junction.name, "out", target, "in")
        for of, to in placement.signals:
            yield _Way(of, of, "signal", to, "signal", "signal")
        tapped: dict[str, str] = {}
        for instrument in graph.instruments:
            if instrument.seat in placement.bodies:
                # Meters of one flow share its tap.
                seat = tapped.get(instrument.seat, instrument.seat)
                yield _Way(seat, seat, "tap", instrument.name, "tap", "tap")
                if instrument.seat not in graph.vessels:
                    tapped[instrument.seat] = instrument.name

    def _length(self, way: _Way) -> float:
        """Return about how long a pipe will be; feeds of junctions come first."""
        bodies = self.placement.bodies
        one, other = bodies.get(way.source), bodies.get(way.end)
        if one is None or other is None:
            known = one or other
            row = self.placement.basin_rows[self.placement.shelf_of(way.line)]
            return 0.0 if known is None else abs(known.y - row)
        into = other.symbol in ("splitter", "header", "delay")
        return abs(one.x - other.x) + abs(one.y - other.y) - (1000.0 if into else 0.0)

    def _lay(self, way: _Way) -> bool:
        shelf = self.placement.shelf_of(way.line)
        starts, goals = (
            self._pins(way.source, way.role, shelf),
            self._pins(way.end, way.role_there, shelf),
        )
        points = self.grid.find(starts, goals, through=self.through)
        if not points:
            return False
        first, last = (
            next(pin for pin in pins if pin.end == point)
            for pins, point in ((starts, points[0]), (goals, points[-1]))
        )
        for pin, name in ((first, way.source), (last, way.end)):
            pin.used = True
            if name not in self.placement.bodies:
                self._use(pin.end[0], shelf, name)
        points = straightened([*first.inward[::-1], *points, *last.inward])
        self.grid.lay(points)
        goal = self.placement.bodies.get(way.end)
        into = goal is None or (goal.symbol == "tank" and way.role_there == "in")
        arrow = into or way.kind == "signal"
        self.routes.pipes.append(Pipe(way.line, *way.ends, points, arrow, way.kind))
        return True

    def _pins(self, name: str, role: str, shelf: int) -> list[Pin]:
        """Return where a line may end at a body, or at the surface of a reservoir."""
        body = self.placement.bodies.get(name)
        if body is not None:
            return body.free(role) or (body.taken(role) if self.through else [])
        row, uses = self.placement.basin_rows[shelf], self.routes.basin_uses
        # Reservoirs beside each other need room for their names.
        room = {n: 1 if n == name else 3 + (len(n) + len(name)) * 9 // 32 for _, _, n in uses}
        return [
            Pin([(x, row - 1)], UP, role)
            for x in range(3, self.placement.width - 2)
            if all(abs(x - at) > room[n] for at, there, n in uses if there == shelf)
        ]


def _close_up(routes: Routes) -> None:
    """Take out lines of the grid that nothing needs, so that the drawing is no larger than that."""
    placement = routes.placement
    areas = [area for body in placement.bodies.values() for area in body.areas]
    columns = {x for left, _, right, _ in areas for x in range(left, right + 1)}
    rows = {y for _, top, _, bottom in areas for y in range(top, bottom + 1)}
    for shelf in {shelf for _, shelf, _ in routes.basin_uses}:
        row = placement.basin_rows[shelf]
        rows |= set(range(row - 1, row + 4))
    for x, _, _ in routes.basin_uses:
        columns |= set(range(x - 2, x + 3))
    for pipe in routes.pipes:
        columns |= {x for x, _ in pipe.points}
        rows |= {y for _, y in pipe.points}
    across = _renumbered(columns, placement.width + 6)
    down = _renumbered(rows, placement.height + 6)
    for body in placement.bodies.values():
        body.renumber(across.__getitem__, down.__getitem__)
    for pipe in routes.pipes:
        pipe.points = [(across[x], down[y]) for x, y in pipe.points]
    routes.basin_uses = [(across[x], shelf, name) for x, shelf, name in routes.basin_uses]
    placement.basin_rows = [down[row] for row in placement.basin_rows]
    placement.width = across[max(columns)] + 2
    placement.height = down[max(rows)] + 1


def _renumbered(used: set[int], end: int) -> dict[int, int]:
    """Number lines anew: of neighbouring lines that nothing needs, one stays."""
    numbers, number, empty = {}, 0, True
    for line in range(min(used) - 8, end):
        if line in used:
            number, empty = number + 1, False
        elif not empty:
            number, empty = number + 1, True
        numbers[line] = number
    return numbers


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
