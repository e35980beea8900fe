"""Where each part of the process drawing stands.

Tanks stand in columns and rows; between the columns are gaps for what stands beside them:
instruments and controllers, pumps, splitters, delays. A gap is as wide as what stands in it side
by side.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

from clepsydra.report.drawing.bodies import (
    DOWN,
    TANK_HALF,
    TANK_ROWS,
    Body,
    Pipe,
    Point,
    delay_body,
    level_body,
    stub_body,
    upright_body,
)
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.control_placement import ControlPlacement
from clepsydra.report.drawing.flow_graph import FlowGraph, Link
from clepsydra.report.drawing.frame import Frame, Gap, Gaps, Labels


class Placement:
    """Everything that does not depend on the ways of pipes and signals.

    Parameters
    ----------
    graph : FlowGraph
    labels : mapping
        Element or function to the lines written beside it.
    functions : sequence of ControlFunction
        Of the controller.
    slack : int
        More room for pipes, where they did not find their way.

    Attributes
    ----------
    seats : dict
        Tank to its shelf, column and row.
    bodies : dict
        Element to its body; instruments by the name of their sensor, functions by their own.
    fixed : list of Pipe
        Pipes whose way follows from where things stand.
    signals : list of (from, to)
        Bodies that signal lines join.
    basin_rows : list of int
        Of each shelf, the line of the surface of its reservoirs.
    width, height : int
        In lines of the grid.
    """

    def __init__(
        self,
        graph: FlowGraph,
        labels: Labels,
        functions: Sequence[ControlFunction] = (),
        slack: int = 0,
    ) -> None:
        self.graph, self.frame = graph, Frame(graph, labels, slack)
        self.gaps = Gaps(self.frame, slack)
        self.seats, self.label = self.frame.seats, self.frame.label
        self.basin_rows, self.width, self.height = self.frame.basin_rows, 0, self.frame.height
        self.bodies: dict[str, Body] = {}
        self.fixed: list[Pipe] = []
        #: Junctions that stand neither below a tank nor above what feeds them.
        self.apart = [each for each in graph.junctions if not self.frame.falls_into(each)]
        self.left_and_right: dict[int, int] = {}
        #: What comes from outside straight into a tank, one for each.
        self.stubs: dict[str, Link] = {}
        for link in graph.links:
            if not link.sources and len(link.targets) == 1 and link.targets[0] in self.seats:
                self.stubs.setdefault(link.targets[0], link)
        control = ControlPlacement(self.frame, self.gaps, functions)
        self.signals = control.signals
        # Rows first, then what stands in the gaps, then the columns.
        for link in graph.links:
            if link not in (*self.stubs.values(), *self.frame.hanging):
                self._put_link(link)
        for junction in self.apart:
            self._put_junction(junction)
        for name in graph.loose:
            self._put_loose(name)
        control.put_instruments()
        control.put_functions()
        self._set_columns()

    def shelf_of(self, name: str) -> int:
        """Return the shelf at which a body stands."""
        return min(bisect_left(self.basin_rows, self.bodies[name].y), len(self.basin_rows) - 1)

    # What stands in gaps

    def _gap_outside(self, tank: str) -> tuple[Gap, int]:
        """Return the gap for what feeds a tank, and the side of it that is away from the tank."""
        seat = self.seats[tank]
        columns = self.frame.columns[seat.shelf]
        outward = -1 if seat.column <= (columns - 1) / 2 else 1
        if columns == 1:
            outward = -1 if self.left_and_right.get(seat.shelf, 0) % 2 == 0 else 1
            self.left_and_right[seat.shelf] = self.left_and_right.get(seat.shelf, 0) + 1
        return self.frame.beside(tank, outward), outward

    def _put_link(self, link: Link) -> None:
        held = [source for source in link.sources if source in self.seats]
        if link.submerged:
            self._put_level(link)
        elif held:
            self._put_beside(link, held[0])
        else:
            self._put_riser(link)

    def _put_level(self, link: Link) -> None:
        source, target = self.seats[link.sources[0]], self.seats[link.targets[0]]
        right = target.column > source.column if target.shelf == source.shelf else True
        gap = self.frame.beside(link.sources[0], 1 if right else -1)
        level = sum(i.gap == gap and i.bodies[0].across for i in self.gaps.items)
        y = self.frame.top(link.sources[0]) + TANK_ROWS - 1 + 4 * level
        body = level_body(link.name, link.symbol, y, self.label(link.name))
        self.gaps.add(gap, -1 if right else 1, body)

    def _put_beside(self, link: Link, tank: str) -> None:
        """Put what draws from a tank beside it, toward where the liquid goes."""
        seat = self.seats[tank]
        ends = [self.seats[end] for end in self.graph.ends(link) if end in self.seats]
        side = -self.frame.inner(tank)
        if ends and ends[0].shelf == seat.shelf and ends[0].column != seat.column:
            side = 1 if ends[0].column > seat.column else -1
        gap = self.frame.beside(tank, side)
        y = self.frame.top(tank) + TANK_ROWS - 1 + 4 * self.gaps.count(gap, link.symbol)
        body = upright_body(link.name, link.symbol, y, self.label(link.name), side, both=True)
        for pin in body.free("both"):
            if pin.way == DOWN and ends:
                # What goes to a tank comes in over its rim: up is the way.
                pin.cost = 8.0
        self.gaps.add(gap, -side, body)

    def _put_riser(self, link: Link) -> None:
        """Put what brings liquid from a reservoir or from outside below the tank that it feeds."""
        lowest = self.frame.lowest(self.graph.ends(link)) or self.graph.vessels[0]
        gap, outward = self._gap_outside(lowest)
        top, y = self.frame.top(lowest), self.frame.pump_rows[gap[0]]
        if not link.sources and not self.graph.junction(link.targets[0]):
            y = top + 2
        bodies = [upright_body(link.name, link.symbol, y, self.label(link.name), outward)]
        junction = self.graph.junction(link.targets[0]) if len(link.targets) == 1 else None
        if junction in self.apart and junction.symbol == "splitter":
            splitter = self.frame.splitter(junction, 0, top - 2, outward)
            if splitter.symbol == "splitter":
                self.apart.remove(junction)
                bodies.append(splitter)
        self.gaps.add(gap, -outward, *bodies, top=top - 2)

    def _put_junction(self, junction: Link) -> None:
        feeding = self.graph.feeding(junction)
        sources = [source for link in feeding for source in link.sources]
        lowest = self.frame.lowest(self.graph.ends(junction)) or self.frame.lowest(sources)
        gap, outward = self._gap_outside(lowest or self.graph.vessels[0])
        y = self.frame.top(lowest or self.graph.vessels[0]) - 2
        if junction.symbol == "splitter":
            body = self.frame.splitter(junction, 0, y, outward)
        else:
            words = self.label(junction.name)
            body = delay_body(junction.name, y - 1, -outward, words, len(feeding))
        self.gaps.add(gap, -outward, body)

    def _put_loose(self, name: str) -> None:
        body = upright_body(name, "box", self.frame.pump_rows[0], self.label(name), -1)
        body.pins = [pin for pin in body.pins if pin.role not in ("in", "out", "both")]
        self.gaps.add((0, 0), 1, body)

    # Columns

    def _set_columns(self) -> None:
        for shelf, columns in self.frame.columns.items():
            x = 2
            for gap in range(columns + 1):
                x = self.gaps.fill((shelf, gap), x)
                if gap == columns:
                    break
                for tank, seat in self.seats.items():
                    if (seat.shelf, seat.column) == (shelf, gap):
                        self._settle(self.frame.standing[tank], x + TANK_HALF)
                x += 2 * TANK_HALF
            self.width = max(self.width, x + 2)
        self.bodies.update(self.gaps.bodies)
        for tank, link in self.stubs.items():
            self._put_stub(tank, link)

    def _settle(self, standing: list[Body], x: int) -> None:
        """Move a tank with what hangs below to its column, and join the two."""
        floor = standing[0].y + TANK_ROWS
        for body in standing:
            body.move(x)
            self.bodies[body.name] = body
            if body.symbol not in ("tank", "splitter"):
                ends = not body.free("out")
                self._fix(body, (body.x, floor), (body.x, body.y + ends), arrow=ends)

    def _fix(self, body: Body, *points: Point, arrow: bool) -> None:
        name = body.name
        self.fixed.append(Pipe(name, name, name, points=list(points), arrow=arrow))

    def _put_stub(self, tank: str, link: Link) -> None:
        body, side = self.bodies[tank], self.frame.inner(tank)
        # On the side where no pump stands, a little away from the wall.
        x = body.x + side * (TANK_HALF - 2)
        pin = next(pin for pin in body.pins if pin.end == (x, body.y - 1))
        pin.used = True
        # Instruments that make room for pipes at the floor reach higher up.
        y = body.y - (6 if self.frame.low(tank) else 3)
        stub = stub_body(link.name, x, y, self.label(link.name), side, body.y - 1)
        self.bodies[link.name] = stub
        self._fix(stub, (x, y), (x, body.y), arrow=True)
