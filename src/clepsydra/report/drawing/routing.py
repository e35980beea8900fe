"""Pipes and signals of the process drawing: each finds its way between what stands there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from clepsydra.report.drawing.bodies import UP, Body, Pin, Point
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import FlowGraph
from clepsydra.report.drawing.frame import Labels
from clepsydra.report.drawing.grid_router import GridRouter, straightened
from clepsydra.report.drawing.placement import Placement, place

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

    Examples
    --------
    >>> Pipe("outlet_3", "outlet_3", "tank_1", [(0, 0), (0, 4)]).points[-1]
    (0, 4)
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

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.report.drawing.flow_graph import flow_graph
    >>> routes = route(flow_graph(load_process("quadruple-tank")), {})
    >>> sorted({use[2] for use in routes.basin_uses})
    ['basin']
    """

    placement: Placement
    pipes: list[Pipe] = field(default_factory=list)
    basin_uses: list[tuple[int, int, str]] = field(default_factory=list)


def route(graph: FlowGraph, labels: Labels, functions: Sequence[ControlFunction] = ()) -> Routes:
    """Place all parts and find the way of every pipe, with more room where there is too little.

    Parameters
    ----------
    graph : FlowGraph
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
        placement = place(graph, labels, functions, slack=3 * (attempt // 2))
        router = _Router(placement, through=attempt == _ATTEMPTS)
        stuck = router.lay_all(urgent)
        if stuck is None:
            break
        # What found no way among the others goes before them.
        urgent = [stuck, *urgent]
    _close_up(router.routes)
    return router.routes


@dataclass(eq=False)
class _Way:
    """A pipe to be laid; an end is a body with the role of its pins, or a reservoir."""

    line: str
    source: str
    end: str
    start: tuple[Body, str] | str
    goal: tuple[Body, str] | str
    shelf: int
    kind: Kind = "pipe"


class _Router:
    def __init__(self, placement: Placement, *, through: bool) -> None:
        self.placement, self.through = placement, through
        self.routes = Routes(placement, basin_uses=list(placement.draws))
        self.grid = GridRouter(placement.width + 4, placement.height + 2)
        for body in placement.bodies.values():
            for area in body.areas:
                self.grid.block(area)
            for pin in body.pins:
                self.grid.dear[pin.end] = 4.0
        for shelf, row in enumerate(placement.basin_rows):
            for x, there, _ in placement.draws:
                if there == shelf:
                    self.grid.block((x - 2, row + 1, x + 2, row + 3))
            for x in range(self.grid.width):
                self.grid.dear[x, row] = 8.0

    def lay_all(self, urgent: Sequence[tuple[str, str]]) -> tuple[str, str] | None:
        """Lay every pipe, some before others; return source and end of one that found no way."""
        for name, points in self.placement.fixed:
            self.grid.lay(points)
            line = name.removesuffix("<")
            body = self.placement.bodies[line]
            ends = body.symbol == "stub" or (not self._link_targets(line) and len(points) == 2)
            self.routes.pipes.append(Pipe(line, line, line, points, arrow=ends))
        ways = self._ways()
        ways.sort(
            key=lambda way: (
                (way.source, way.end) not in urgent,
                ORDER.index(way.kind),
                self._length(way),
            )
        )
        return next(((way.source, way.end) for way in ways if not self._lay(way)), None)

    def _link_targets(self, name: str) -> tuple[str, ...]:
        return next(
            (link.targets for link in self.placement.graph.links if link.name == name), ("",)
        )

    def _ways(self) -> list[_Way]:
        placement, graph = self.placement, self.placement.graph
        joined = {
            (line, other.name)
            for line, points in placement.fixed
            for other in placement.bodies.values()
            if (other.x, other.y) == points[-1]
        }
        ways = []
        for link in graph.links:
            body = placement.bodies[link.name]
            if body.symbol == "stub":
                continue
            fallen = any(
                name == link.name and points[0][1] < points[1][1]
                for name, points in placement.fixed
            )
            shelf = placement.shelf_of(link.name)
            for source in link.sources:
                if source in graph.reservoirs:
                    if (body.x, shelf, source) not in placement.draws:
                        ways.append(_Way(link.name, source, link.name, source, (body, "in"), shelf))
                elif not (fallen and source in graph.vessels):
                    role = "side"
                    ways.append(
                        _Way(
                            link.name,
                            source,
                            link.name,
                            (placement.bodies[source], role),
                            (body, "in"),
                            shelf,
                        )
                    )
            for target in link.targets:
                if (link.name, target) not in joined:
                    ways.append(self._toward(link.name, link.name, target, body, link.submerged))
        for junction in graph.junctions:
            body = placement.bodies[junction.name]
            for _, target in junction.branches:
                ways.append(self._toward(junction.name, junction.name, target, body, False))
        for of, to in placement.signals:
            ways.append(self._between("signal", of, to))
        tapped: dict[str, str] = {}
        for instrument in graph.instruments:
            if instrument.seat in placement.bodies:
                # Meters of one flow share its tap.
                seat = tapped.get(instrument.seat, instrument.seat)
                ways.append(self._between("tap", seat, instrument.name))
                if instrument.seat not in graph.vessels:
                    tapped[instrument.seat] = instrument.name
        return ways

    def _between(self, kind: Kind, of: str, to: str) -> _Way:
        one, other = (self.placement.bodies[name] for name in (of, to))
        return _Way(of, of, to, (one, kind), (other, kind), self.placement.shelf_of(of), kind)

    def _toward(self, line: str, source: str, target: str, body: Body, submerged: bool) -> _Way:
        shelf = self.placement.shelf_of(source)
        if target in self.placement.graph.reservoirs:
            return _Way(line, source, target, (body, "out"), target, shelf)
        role = "side" if submerged else "in"
        return _Way(
            line, source, target, (body, "out"), (self.placement.bodies[target], role), shelf
        )

    def _length(self, way: _Way) -> float:
        """Return about how long a pipe will be; feeds of junctions come first."""

        def middle(end: tuple[Body, str] | str) -> Point | None:
            return None if isinstance(end, str) else (end[0].x, end[0].y)

        one, other = middle(way.start), middle(way.goal)
        row = self.placement.basin_rows[way.shelf]
        one = one or (other[0] if other else 0, row)
        other = other or (one[0], row)
        into = not isinstance(way.goal, str) and way.goal[0].symbol in (
            "splitter",
            "header",
            "delay",
        )
        return abs(one[0] - other[0]) + abs(one[1] - other[1]) - (1000.0 if into else 0.0)

    def _lay(self, way: _Way) -> bool:
        starts, goals = self._ends(way.start, way), self._ends(way.goal, way)
        points = self.grid.find([e[0] for e in starts], [e[0] for e in goals], through=self.through)
        if not points:
            return False
        first = self._inner(starts, points[0], way.start)
        last = self._inner(goals, points[-1], way.goal)
        points = straightened([*first[::-1], *points, *last])
        self.grid.lay(points)
        for end, point in ((way.start, points[0]), (way.goal, points[-1])):
            if isinstance(end, str):
                self.routes.basin_uses.append((point[0], way.shelf, end))
                row = self.placement.basin_rows[way.shelf]
                self.grid.block((point[0] - 2, row + 1, point[0] + 2, row + 3))
        vessel = (
            not isinstance(way.goal, str)
            and way.goal == (way.goal[0], "in")
            and way.goal[0].symbol == "tank"
        )
        arrow = isinstance(way.goal, str) or vessel
        arrow = arrow or way.kind == "signal"
        pipe = Pipe(way.line, way.source, way.end, points, arrow, way.kind)
        self.routes.pipes.append(pipe)
        return True

    def _ends(
        self, end: tuple[Body, str] | str, way: _Way
    ) -> list[tuple[tuple[Point, Point, float], Pin | None]]:
        if not isinstance(end, str):
            body, role = end
            pins = body.free(role) or (body.taken(role) if self.through else [])
            return [((pin.end, pin.way, pin.cost), pin) for pin in pins]
        row = self.placement.basin_rows[way.shelf]
        found: list[tuple[tuple[Point, Point, float], Pin | None]] = []
        for x in range(3, self.placement.width - 2):
            near = [
                (abs(x - use), name)
                for use, shelf, name in self.routes.basin_uses
                if shelf == way.shelf
            ]
            room = lambda name: 3 + (len(name) + len(end)) * 9 // 32  # noqa: E731
            if all(
                distance > 1 and (name == end or distance > room(name)) for distance, name in near
            ):
                found.append((((x, row), UP, 0.0), None))
        return found

    def _inner(
        self,
        ends: Iterable[tuple[tuple[Point, Point, float], Pin | None]],
        point: Point,
        end: tuple[Body, str] | str,
    ) -> list[Point]:
        """Return the points from the free end of the pin inward, and take the pin."""
        pin = next((pin for (place, _, _), pin in ends if place == point), None)
        if pin is None or isinstance(end, str):
            return []
        pin.used = True
        dx, dy = pin.way
        x, y = pin.lead[0]
        return [*pin.lead[::-1], (x - dx, y - dy)]


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
        body.x, body.y = across[body.x], down[body.y]
        body.areas = [(across[a], down[b], across[c], down[d]) for a, b, c, d in body.areas]
        for pin in body.pins:
            pin.lead = [(across[x], down[y]) for x, y in pin.lead]
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
