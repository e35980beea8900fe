"""Pipes and signals of the process drawing: each finds its way between what stands there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate, pairwise

import numpy as np

from clepsydra.report.drawing.bodies import UP, Pin, Pipe, Point
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import FlowGraph
from clepsydra.report.drawing.frame import Labels
from clepsydra.report.drawing.placement import Placement

#: With more room and in another order each time; the last one runs through what is in the way.
_ATTEMPTS = 10
#: In this order they are laid, and each arches over those before it.
ORDER = ("pipe", "tap", "signal")


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
        routes = Routes(placement, through=attempt == _ATTEMPTS)
        stuck = routes.lay_all(urgent)
        if stuck is None:
            break
        # What found no way among the others goes before them.
        urgent = [(stuck.source, stuck.end), *urgent]
    routes.close_up()
    return routes


class Routes:
    """A placement with its pipes.

    Parameters
    ----------
    placement : Placement
    through : bool
        Pipes may run through what is in their way.

    Attributes
    ----------
    pipes : list of Pipe
    basin_uses : list of (x, shelf, reservoir)
    """

    def __init__(self, placement: Placement, *, through: bool) -> None:
        self.placement, self.through = placement, through
        self.pipes: list[Pipe] = []
        self.basin_uses: list[tuple[int, int, str]] = []
        self.grid = GridRouter(placement.width + 4, placement.height + 2)
        for body in placement.bodies.values():
            for area in body.areas:
                self.grid.block(area)
            for pin in body.pins:
                self.grid.dear[pin.end] = 4.0
        self.grid.dear[:, placement.basin_rows] = 8.0

    def lay_all(self, urgent: Sequence[tuple[str, str]]) -> Pipe | None:
        """Lay every pipe, some before others; return one that found no way."""
        for pipe in self.placement.fixed:
            self.grid.lay(pipe.points)
            self.pipes.append(pipe)
        pipes = sorted(
            self._to_lay(),
            key=lambda pipe: (
                (pipe.source, pipe.end) not in urgent, ORDER.index(pipe.kind), self._length(pipe)
            ),
        )  # fmt: skip
        return next((pipe for pipe in pipes if not self._lay(pipe) and not self.through), None)

    def _to_lay(self) -> Iterator[Pipe]:
        placement, graph = self.placement, self.placement.graph
        fixed = {pipe.line for pipe in placement.fixed}
        for link in (*graph.links, *graph.junctions):
            name = link.name
            if placement.bodies[name].symbol == "stub":
                continue
            for source in link.sources:
                if name not in fixed or source not in graph.vessels:
                    yield Pipe(name, source, name, ("side", "in"))
            for target in link.targets:
                yield Pipe(name, name, target, ("out", "side" if link.submerged else "in"))
        for of, to in placement.signals:
            yield Pipe(of, of, to, ("signal", "signal"), "signal")
        tapped: dict[str, str] = {}
        for instrument in graph.instruments:
            if instrument.seat in placement.bodies:
                # Meters of one flow share its tap.
                seat = tapped.get(instrument.seat, instrument.seat)
                yield Pipe(seat, seat, instrument.name, ("tap", "tap"), "tap")
                if instrument.seat not in graph.vessels:
                    tapped[instrument.seat] = instrument.name

    def _length(self, pipe: Pipe) -> float:
        """Return about how long a pipe will be; feeds of junctions come first."""
        bodies = self.placement.bodies
        one, other = bodies.get(pipe.source), bodies.get(pipe.end)
        if one is None or other is None:
            known = one or other
            row = self.placement.basin_rows[self.placement.shelf_of(pipe.line)]
            return 0.0 if known is None else abs(known.y - row)
        into = other.symbol in ("splitter", "header", "delay")
        return abs(one.x - other.x) + abs(one.y - other.y) - (1000.0 if into else 0.0)

    def _lay(self, pipe: Pipe) -> bool:
        placement, names = self.placement, (pipe.source, pipe.end)
        shelf = placement.shelf_of(pipe.line)
        pins = [self._pins(*end, shelf) for end in zip(names, pipe.roles, strict=True)]
        way = self.grid.find(*pins, through=self.through)
        if not way:
            return False
        ends = [
            next(pin for pin in free if pin.end == point)
            for free, point in zip(pins, (way[0], way[-1]), strict=True)
        ]
        for pin, name in zip(ends, names, strict=True):
            pin.used = True
            if name not in placement.bodies:
                # The place below it is kept for its name.
                x, row = pin.end[0], placement.basin_rows[shelf]
                self.basin_uses.append((x, shelf, name))
                self.grid.block((x - 2, row + 1, x + 2, row + 3))
        pipe.points = straightened([*ends[0].inward[::-1], *way, *ends[1].inward])
        self.grid.lay(pipe.points)
        goal = placement.bodies.get(pipe.end)
        into = goal is None or (goal.symbol == "tank" and pipe.roles[1] == "in")
        pipe.arrow = into or pipe.kind == "signal"
        self.pipes.append(pipe)
        return True

    def _pins(self, name: str, role: str, shelf: int) -> list[Pin]:
        """Return where a line may end at a body, or at the surface of a reservoir."""
        body = self.placement.bodies.get(name)
        if body is not None:
            return body.free(role, taken=self.through)
        row, uses = self.placement.basin_rows[shelf], self.basin_uses
        # Reservoirs beside each other need room for their names.
        room = {n: 1 if n == name else 3 + (len(n) + len(name)) * 9 // 32 for _, _, n in uses}
        return [
            Pin([(x, row - 1)], UP, role)
            for x in range(3, self.placement.width - 2)
            if all(abs(x - at) > room[n] for at, there, n in uses if there == shelf)
        ]

    def close_up(self) -> None:
        """Take out lines of the grid that nothing needs, so that nothing is further apart."""
        placement, rows = self.placement, self.placement.basin_rows
        needed = [area for body in placement.bodies.values() for area in body.areas]
        needed += [(x - 2, rows[k] - 1, x + 2, rows[k] + 3) for x, k, _ in self.basin_uses]
        needed += [(*point, *point) for pipe in self.pipes for point in pipe.points]
        across, down = (
            _renumbered({line for area in needed for line in range(area[k], area[k + 2] + 1)}, end)
            for k, end in ((0, placement.width + 6), (1, placement.height + 6))
        )
        for body in placement.bodies.values():
            body.renumber(across.__getitem__, down.__getitem__)
        for pipe in self.pipes:
            pipe.points = [(across[x], down[y]) for x, y in pipe.points]
        self.basin_uses = [(across[x], shelf, name) for x, shelf, name in self.basin_uses]
        placement.basin_rows = [down[row] for row in rows]
        placement.width, placement.height = max(across.values()) + 1, max(down.values())


def _renumbered(used: set[int], end: int) -> dict[int, int]:
    """Number lines anew: of neighbouring lines that nothing needs, one stays."""
    lines = range(min(used) - 8, end)
    kept = [line in used or line - 1 in used for line in lines]
    return dict(zip(lines, accumulate(kept), strict=True))


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

        pins = (*starts, *goals)
        barred = self.blocked | self.laid
        for x, y in (point for pin in pins for point in pin.lead[:-1]):
            barred[:, x, y] = True
        free = np.asarray(~barred.any(axis=0) | through)
        cost = 1.0 + self.dear + _CROSSING * self.laid[::-1]
        cost += _LOWER * np.arange(cost.shape[-1])
        cost = np.where(barred, cost + _THROUGH if through else np.inf, cost)
        bend = np.where(free, _BEND, np.inf)
        for pin in pins:
            bend[pin.end] -= _EARLY
        level, upright = node = np.arange(cost.size).reshape(cost.shape)
        start, goal = cost.size, cost.size + 1
        pairs = (level[:-1], level[1:]), (upright[:, :-1], upright[:, 1:])
        edges = [(*pair, sum(cost.ravel()[each] for each in pair) / 2) for pair in pairs]
        edges.append((level, upright, bend))
        for place, own in ((start, starts), (goal, goals)):
            edges += [
                (node[(int(pin.way[0] == 0), *pin.end)], place, 1.0 + pin.cost)
                for pin in own
                if free[pin.end]
            ]
        ones, twos, weights = (
            np.concatenate([np.ravel(part) for part in parts]) for parts in zip(*edges, strict=True)
        )
        known = np.isfinite(weights)
        graph = csr_array((weights[known], (ones[known], twos[known])), shape=(goal + 1, goal + 1))
        _, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
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
