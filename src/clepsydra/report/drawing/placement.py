"""Where each part of the process drawing stands.

Tanks stand in columns and rows; between the columns are gaps for what stands beside them:
instruments, pumps, splitters, delays. A gap is as wide as what stands in it side by side.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.report.drawing.bodies import (
    DOWN,
    TANK_HALF,
    TANK_ROWS,
    Body,
    Pin,
    Point,
    delay_body,
    falling_body,
    instrument_body,
    level_body,
    splitter_body,
    tank_body,
    upright_body,
)
from clepsydra.report.drawing.flow_graph import FlowGraph, Instrument, Junction, Link
from clepsydra.report.drawing.stacking import Seat, stack

Labels = dict[str, tuple[str, ...]]


@dataclass(eq=False)
class _Item:
    """What stands in a gap and is moved as one; `side` is the wall that it keeps close to."""

    gap: tuple[int, int]
    side: int
    bodies: list[Body]
    rows: tuple[int, int]
    distance: int = 2

    @property
    def reach(self) -> tuple[int, int]:
        """How far it reaches to the left and to the right of its middle."""
        areas = [area for body in self.bodies for area in body.areas]
        pins = [pin.end[0] for body in self.bodies for pin in body.pins]
        left, right = min(area[0] for area in areas), max(area[2] for area in areas)
        return -min([left, *pins]), max([right, *pins])


@dataclass(eq=False)
class Placement:
    """Everything that does not depend on the ways of the pipes.

    Parameters
    ----------
    graph : FlowGraph
    seats : dict
        Tank to its shelf, column and row.
    bodies : dict
        Element to its body; instruments by the name of their sensor.
    stubs : dict
        Flow from outside straight into a tank to the point where its arrow begins.
    fixed : list of (link or junction, points)
        Pipes whose way follows from where things stand: source, from, points.
    basin_rows : list of int
        Of each shelf, the line of the surface of its reservoirs.
    draws : list of (x, shelf, reservoir)
        Where a pump stands in a reservoir.
    width, height : int
        In lines of the grid.

    Examples
    --------
    >>> fall = Link("outlet", "orifice", ("tank",), ("basin",), by_weight=True)
    >>> lift = Link("pump", "pump", ("basin",), ("tank",))
    >>> placement = place(FlowGraph(("tank",), ("basin",), (fall, lift), (), ()), {})
    >>> placement.bodies["pump"].x < placement.bodies["tank"].x
    True
    """

    graph: FlowGraph
    seats: dict[str, Seat]
    bodies: dict[str, Body] = field(default_factory=dict)
    stubs: dict[str, Point] = field(default_factory=dict)
    fixed: list[tuple[str, list[Point]]] = field(default_factory=list)
    basin_rows: list[int] = field(default_factory=list)
    draws: list[tuple[int, int, str]] = field(default_factory=list)
    width: int = 0
    height: int = 0

    def shelf_of(self, name: str) -> int:
        """Return the shelf at which a body stands."""
        y = self.bodies[name].y
        return next(
            (shelf for shelf, row in enumerate(self.basin_rows) if y <= row),
            len(self.basin_rows) - 1,
        )


def place(
    graph: FlowGraph, labels: Labels, controlled: frozenset[str] = frozenset(), slack: int = 0
) -> Placement:
    """Place everything that has a place of its own.

    Parameters
    ----------
    graph : FlowGraph
    labels : dict
        Element to the lines written beside it; of an instrument the reading.
    controlled : frozenset of str
        Sensors with a controller.
    slack : int
        More room for pipes, where they did not find their way.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.report.drawing.flow_graph import flow_graph
    >>> bodies = place(flow_graph(load_process("quadruple-tank")), {}).bodies
    >>> bodies["tank_1"].x == bodies["tank_3"].x, bodies["tank_3"].y < bodies["tank_1"].y
    (True, True)
    """
    return _Placer(graph, labels, controlled, slack).placed()


class _Placer:
    def __init__(
        self, graph: FlowGraph, labels: Labels, controlled: frozenset[str], slack: int
    ) -> None:
        self.graph, self.labels = graph, labels
        self.controlled, self.slack = controlled, slack
        self.placement = Placement(graph, stack(graph))
        self.seats = self.placement.seats
        self.columns = {
            shelf: 1 + max(seat.column for seat in self.seats.values() if seat.shelf == shelf)
            for shelf in {seat.shelf for seat in self.seats.values()}
        }
        self.tops: dict[tuple[int, int], int] = {}
        self.pump_rows: list[int] = []
        self.items: list[_Item] = []
        self.followed: set[str] = set()
        self.left_and_right: dict[int, int] = {}
        self.below: dict[str, list[Link]] = {}
        self.hanging: dict[str, list[Body]] = {}
        self.stubs: dict[str, Link] = {}

    def placed(self) -> Placement:
        """Place rows first, then what stands in the gaps, then the columns."""
        self._sort_links()
        self._set_rows()
        for instrument in self.graph.instruments:
            if instrument.seat in self.seats:
                self._seat_instrument(instrument)
        for link in self.graph.links:
            placed = [
                *self.stubs.values(),
                *(own for links in self.below.values() for own in links),
            ]
            if link not in placed:
                self._put_link(link)
        for junction in self.graph.junctions:
            if junction.name not in self.followed and not self._falls_into(junction):
                self._put_junction(junction)
        for name in self.graph.loose:
            self._put_loose(name)
        for instrument in self.graph.instruments:
            if instrument.seat not in self.seats:
                self._put_instrument(instrument)
        self._set_columns()
        return self.placement

    # Which side, which gap

    def _label(self, name: str) -> tuple[str, ...]:
        return self.labels.get(name, (name,))

    def inner(self, tank: str) -> int:
        """Return the side of a tank on which its instruments stand."""
        seat = self.seats[tank]
        return 1 if seat.column <= (self.columns[seat.shelf] - 1) / 2 else -1

    def _low(self, tank: str) -> bool:
        """Tell whether pipes meet the walls of a tank near its floor."""
        return any(
            tank in (*link.sources, *(link.targets if link.submerged else ()))
            for link in self.graph.links
            if link.submerged or link not in self.below.get(tank, ())
        )

    def _sort_links(self) -> None:
        """Find what stands below a tank, at most two for each, and what falls in from above."""
        for link in self.graph.links:
            ends = not link.targets and link.symbol == "flow"
            if len(link.sources) == 1 and link.sources[0] in self.seats and not link.submerged:
                own = self.below.setdefault(link.sources[0], [])
                if (link.by_weight or ends) and len(own) < 2:
                    own.append(link)
            if not link.sources and len(link.targets) == 1 and link.targets[0] in self.seats:
                self.stubs.setdefault(link.targets[0], link)

    def _falls_into(self, junction: Junction) -> Link | None:
        """Return the first link below a tank that feeds a splitter."""
        if junction.symbol != "splitter" or self._feeds(junction) + len(junction.branches) > 4:
            return None
        for links in self.below.values():
            for link in links:
                if junction.name in link.targets:
                    return link
        return None

    # Rows

    def _set_rows(self) -> None:
        y = 1
        for shelf in sorted(self.columns):
            own = [tank for tank, seat in self.seats.items() if seat.shelf == shelf]
            for row in range(1 + max(self.seats[tank].row for tank in own)):
                tanks = [tank for tank in own if self.seats[tank].row == row]
                y += 9 + self.slack
                for tank in tanks:
                    self.tops[shelf, row] = y
                    self.placement.bodies[tank] = tank_body(tank, 0, y)
                    self._build_below(tank)
                links = [link for tank in tanks for link in self.below.get(tank, ())]
                y += TANK_ROWS + 4 + self.slack
                if any(
                    link.symbol != "orifice" or len(self._label(link.name)) > 1 for link in links
                ):
                    y += 3
                if any(self.graph.junction(t) for link in links for t in link.targets):
                    y += 5
            metered = {i.seat for i in self.graph.instruments if i.seat not in self.seats}
            self.pump_rows.append(y + 3)
            y += 6 + (2 if metered else 0)
            self.placement.basin_rows.append(y)
            y += 5
        self.placement.height = y

    # What stands in gaps

    def _add(
        self,
        gap: tuple[int, int],
        side: int,
        *bodies: Body,
        distance: int = 2,
        top: int | None = None,
    ) -> None:
        """Put bodies into a gap; from `top` on nothing stands above them."""
        areas = [area for body in bodies for area in body.areas]
        ends = [pin.end[1] for body in bodies for pin in body.pins]
        rows = (
            min([*(area[1] for area in areas), *ends]),
            max([*(area[3] for area in areas), *ends]),
        )
        rows = (rows[0] if top is None else min(rows[0], top), rows[1])
        self.items.append(_Item(gap, side, list(bodies), rows, distance))
        for body in bodies:
            self.placement.bodies[body.name] = body

    def _seat_instrument(self, instrument: Instrument) -> None:
        tank = instrument.seat
        seat, top = self.seats[tank], self.tops[self.seats[tank].shelf, self.seats[tank].row]
        earlier = [
            other
            for other in self.graph.instruments
            if other.seat == tank and other.number < instrument.number
        ]
        side = self.inner(tank) * (1 if len(earlier) % 2 == 0 else -1)
        reading = self._label(instrument.name)[-1]
        y = top + (1 if self._low(tank) else 4)
        body = instrument_body(instrument.name, y, reading, instrument.name in self.controlled)
        gap = seat.column + (1 if side > 0 else 0)
        self._add((seat.shelf, gap), -side, body, distance=0)

    def _gap_beside(self, tank: str) -> tuple[tuple[int, int], int]:
        """Return the gap for what feeds a tank, and the side of it that is away from the tank."""
        seat = self.seats[tank]
        columns = self.columns[seat.shelf]
        outward = -1 if seat.column <= (columns - 1) / 2 else 1
        if columns == 1:
            outward = -1 if self.left_and_right.get(seat.shelf, 0) % 2 == 0 else 1
            self.left_and_right[seat.shelf] = self.left_and_right.get(seat.shelf, 0) + 1
        return (seat.shelf, seat.column + (0 if outward < 0 else 1)), outward

    def _lowest(self, names: list[str]) -> str | None:
        tanks = [name for name in names if name in self.seats]
        return max(
            tanks, key=lambda tank: (self.seats[tank].shelf, self.seats[tank].row), default=None
        )

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
        gap = (source.shelf, source.column + (1 if right else 0))
        level = len([item for item in self.items if item.gap == gap and item.bodies[0].across])
        y = self.tops[source.shelf, source.row] + TANK_ROWS - 1 + 4 * level
        body = level_body(link.name, link.symbol, y, self._label(link.name))
        self._add(gap, -1 if right else 1, body)

    def _put_beside(self, link: Link, tank: str) -> None:
        """Put what draws from a tank beside it, toward where the liquid goes."""
        seat = self.seats[tank]
        ends = [self.seats[end] for end in self.graph.ends(link) if end in self.seats]
        side = -self.inner(tank)
        if ends and ends[0].shelf == seat.shelf and ends[0].column != seat.column:
            side = 1 if ends[0].column > seat.column else -1
        gap = (seat.shelf, seat.column + (1 if side > 0 else 0))
        level = len(
            [
                item
                for item in self.items
                if item.gap == gap and item.bodies[0].symbol == link.symbol
            ]
        )
        y = self.tops[seat.shelf, seat.row] + TANK_ROWS - 1 + 4 * level
        body = upright_body(link.name, link.symbol, y, self._label(link.name), side)
        for pin in body.pins:
            pin.role = "both"
            if pin.way == DOWN and ends:
                # What goes to a tank comes in over its rim: up is the way.
                pin.cost = 8.0
        self._add(gap, -side, body)

    def _put_riser(self, link: Link) -> None:
        """Put what brings liquid from a reservoir or from outside below the tank that it feeds."""
        lowest = self._lowest(self.graph.ends(link)) or self.graph.vessels[0]
        gap, outward = self._gap_beside(lowest)
        y = self.pump_rows[gap[0]]
        if not link.sources and not self.graph.junction(link.targets[0]):
            y = self.tops[gap[0], self.seats[lowest].row] + 2
        body = upright_body(link.name, link.symbol, y, self._label(link.name), outward)
        bodies = [body]
        junction = self.graph.junction(link.targets[0]) if len(link.targets) == 1 else None
        if (
            junction
            and junction.symbol == "splitter"
            and junction.name not in self.followed
            and not self._falls_into(junction)
        ):
            top = self.tops[gap[0], self.seats[lowest].row]
            splitter = self._splitter(junction, 0, top - 2, outward)
            if splitter.symbol == "splitter":
                self.followed.add(junction.name)
                bodies.append(splitter)
        self._add(gap, -outward, *bodies, top=self.tops[gap[0], self.seats[lowest].row] - 2)

    def _splitter(self, junction: Junction, x: int, y: int, side: int) -> Body:
        ports = self._feeds(junction) + len(junction.branches)
        return splitter_body(junction.name, x, y, ports, side)

    def _feeds(self, junction: Junction) -> int:
        """Return how many pipes lead into a junction."""
        from_links = [link for link in self.graph.links if junction.name in link.targets]
        branches = [name for other in self.graph.junctions for _, name in other.branches]
        return len(from_links) + branches.count(junction.name)

    def _put_junction(self, junction: Junction) -> None:
        lowest = self._lowest(self.graph.leaves(junction.name))
        if lowest is None:
            feeding = [
                s
                for link in self.graph.links
                if junction.name in link.targets
                for s in link.sources
            ]
            lowest = self._lowest(feeding) or self.graph.vessels[0]
        gap, outward = self._gap_beside(lowest)
        y = self.tops[gap[0], self.seats[lowest].row] - 2
        if junction.symbol == "splitter":
            body = self._splitter(junction, 0, y, outward)
        else:
            y -= 1
            words = self._label(junction.name)
            body = delay_body(junction.name, y, -outward, words, self._feeds(junction))
        self._add(gap, -outward, body)

    def _put_loose(self, name: str) -> None:
        body = upright_body(name, "box", self.pump_rows[0], self._label(name), -1)
        body.pins = []
        self._add((0, 0), 1, body)

    def _put_instrument(self, instrument: Instrument) -> None:
        """Put a flow meter beside what it measures."""
        reading = self._label(instrument.name)[-1]
        controlled = instrument.name in self.controlled
        item = next((i for i in self.items for b in i.bodies if b.name == instrument.seat), None)
        if item is not None:
            body = next(b for b in item.bodies if b.name == instrument.seat)
            y = body.y - 4 if body.across else body.y
            self._add(
                item.gap,
                item.side,
                instrument_body(instrument.name, y, reading, controlled),
                distance=1,
            )
            return
        tank = next(
            (
                tank
                for tank, links in self.below.items()
                if instrument.seat in [link.name for link in links]
            ),
            None,
        )
        tank = tank or self.graph.vessels[0]
        seat = self.seats[tank]
        side = -self.inner(tank)
        gap = (seat.shelf, seat.column + (1 if side > 0 else 0))
        y = self.tops[seat.shelf, seat.row] + TANK_ROWS + 2
        self._add(gap, -side, instrument_body(instrument.name, y, reading, controlled), distance=1)

    # Columns

    def _set_columns(self) -> None:
        for shelf, columns in self.columns.items():
            x = 2
            for gap in range(columns + 1):
                x = self._fill((shelf, gap), x, gap in (0, columns))
                if gap == columns:
                    break
                for tank, seat in self.seats.items():
                    if seat.shelf == shelf and seat.column == gap:
                        self.placement.bodies[tank].move(x + TANK_HALF)
                        self._put_below(tank)
                x += 2 * TANK_HALF
            self.placement.width = max(self.placement.width, x + 2)
        for tank, link in self.stubs.items():
            self._put_stub(tank, link)
        for item in self.items:
            self._join(item)

    def _fill(self, gap: tuple[int, int], start: int, outermost: bool) -> int:
        """Place what stands in a gap; return where it ends."""
        left, right = self._overhang(gap, 1), self._overhang(gap, -1)
        offsets = []
        own = [item for item in self.items if item.gap == gap]
        # Instruments stand at the wall, then what is small, then what reaches through many rows.
        own.sort(key=lambda item: (item.distance, item.rows[1] - item.rows[0]))
        for item in own:
            taken = left if item.side < 0 else right
            rows = range(item.rows[0], item.rows[1] + 1)
            offset = max(max((taken.get(row, 0) for row in rows), default=0), item.distance)
            reach = item.reach if item.side < 0 else item.reach[::-1]
            offsets.append((item, offset + reach[0]))
            for row in rows:
                taken[row] = offset + sum(reach) + 2
        used = max(
            (left.get(r, 0) + right.get(r, 0) for r in left.keys() | right.keys()), default=0
        )
        width = used + 4 + self.slack + (0 if outermost else 2)
        for item, offset in offsets:
            x = start + offset if item.side < 0 else start + width - offset
            for body in item.bodies:
                body.move(x)
        return start + width

    def _overhang(self, gap: tuple[int, int], side: int) -> dict[int, int]:
        """Return how far words below the tanks at one wall of a gap reach into it, by row."""
        found: dict[int, int] = {}
        for tank, seat in self.seats.items():
            if (seat.shelf, seat.column + (1 if side > 0 else 0)) != gap:
                continue
            for area in (area for body in self.hanging.get(tank, ()) for area in body.areas):
                reach = (area[2] if side > 0 else -area[0]) - TANK_HALF
                for row in range(area[1], area[3] + 1):
                    if reach > 0:
                        found[row] = max(found.get(row, 0), reach + 1)
        return found

    def _build_below(self, tank: str) -> None:
        """Build what stands below a tank, as if its middle were at 0."""
        links = self.below.get(tank, [])
        floor = self.placement.bodies[tank].y + TANK_ROWS
        for place, link in enumerate(links):
            side = self.inner(tank) if len(links) == 1 else (-1, 1)[place]
            apart = 3 if link.symbol == "box" else 2
            x = 0 if len(links) == 1 else apart * side
            label, ends = self._label(link.name), not link.targets
            below = falling_body(link.name, link.symbol, x, floor, label, side, ends)
            self.placement.bodies[link.name] = below
            self.hanging.setdefault(tank, []).append(below)
            for name in link.targets:
                junction = self.graph.junction(name)
                first = junction is not None and self._falls_into(junction) is link
                if junction is not None and first and name not in self.placement.bodies:
                    splitter = self._splitter(junction, x, below.y + 4, side)
                    self.placement.bodies[name] = splitter
                    self.hanging[tank].append(splitter)

    def _put_below(self, tank: str) -> None:
        """Move what stands below a tank to its place, and join it to the floor."""
        body = self.placement.bodies[tank]
        upper: Body | None = None
        for below in self.hanging.get(tank, ()):
            below.move(body.x)
            if upper is not None and below.symbol in ("splitter", "header"):
                self._connect(upper.name, upper, below)
                continue
            upper = below
            down = below.y + (0 if below.pins else 1)
            way = [(below.x, body.y + TANK_ROWS), (below.x, down)]
            self.placement.fixed.append((below.name, way))

    def _put_stub(self, tank: str, link: Link) -> None:
        body, side = self.placement.bodies[tank], self.inner(tank)
        # The first pin from the wall on the side where no pump stands.
        x = body.x + side * (TANK_HALF - 1)
        pin = next(pin for pin in body.pins if pin.end == (x, body.y - 1))
        pin.used = True
        # Instruments that make room for pipes at the floor reach higher up.
        y = body.y - (6 if self._low(tank) else 3)
        area = (min(x, x + 3 * side) - 2, y - 2, max(x, x + 3 * side) + 2, y)
        stub = Body(link.name, "stub", x, y, [area, (x, y, x, body.y - 1)], [], side)
        self.placement.bodies[link.name] = stub
        self.placement.fixed.append((link.name, [(x, y), (x, body.y)]))

    def _connect(self, name: str, below: Body, splitter: Body) -> None:
        """Join what stands above a splitter to it."""
        pin_in = next(pin for pin in splitter.pins if pin.way == (0, -1) and pin.end[0] == below.x)
        for pin in below.free("out"):
            pin.used = True
        pin_in.used = True
        self.placement.fixed.append((name, [(below.x, below.y), (splitter.x, splitter.y)]))

    def _join(self, item: _Item) -> None:
        """Join a pump to its reservoir, and to the splitter above it."""
        foot = item.bodies[0]
        link = next((link for link in self.graph.links if link.name == foot.name), None)
        if link is None:
            return
        shelf = item.gap[0]
        basin = next((s for s in link.sources if s in self.graph.reservoirs), None)
        down = next((pin for pin in foot.pins if pin.way == DOWN), None)
        if basin is not None and down is not None and foot.y == self.pump_rows[shelf]:
            down.used = True
            row = self.placement.basin_rows[shelf]
            self.placement.draws.append((foot.x, shelf, basin))
            self.placement.fixed.append((f"{link.name}<", [(foot.x, row), (foot.x, foot.y)]))
        if len(item.bodies) > 1:
            splitter = item.bodies[1]
            up = next(pin for pin in foot.pins if pin.way == (0, -1))
            into = next(pin for pin in splitter.pins if pin.way == DOWN)
            _use(up, into)
            way = [(foot.x, foot.y), (splitter.x, splitter.y)]
            self.placement.fixed.append((link.name, way))


def _use(*pins: Pin) -> None:
    for pin in pins:
        pin.used = True
