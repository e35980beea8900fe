"""The frame of the process drawing: shelves, columns and rows, with tanks and what hangs below."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

from clepsydra.report.drawing.bodies import (
    TANK_HALF,
    TANK_ROWS,
    Body,
    falling_body,
    splitter_body,
    tank_body,
)
from clepsydra.report.drawing.flow_graph import FlowGraph, Link
from clepsydra.report.drawing.stacking import stack

Labels = Mapping[str, tuple[str, ...]]
#: A shelf, and the gap between two columns of tanks by the number of the column to its right.
Gap = tuple[int, int]


class Frame:
    """Where tanks stand, and what is joined to their floors.

    Parameters
    ----------
    graph : FlowGraph
    labels : mapping
        Element to the lines written beside it.
    slack : int
        More rows for pipes.

    Attributes
    ----------
    below : dict
        Tank to the links below its floor, at most two.
    standing : dict
        Tank to its body and to those below it, splitters too, in columns from its middle.
    tops : dict
        Shelf and row to the line of the rims.
    pump_rows, basin_rows : list of int
        Of each shelf, the lines of its pumps and of the surface of its reservoirs.

    Examples
    --------
    >>> fall = Link("outlet", "orifice", ("tank",), ("basin",), by_weight=True)
    >>> frame = Frame(FlowGraph(("tank",), (fall,), (), ()), {}, 0)
    >>> frame.tops, [body.name for body in frame.standing["tank"]]
    ({(0, 0): 10}, ['tank', 'outlet'])
    """

    def __init__(self, graph: FlowGraph, labels: Labels, slack: int) -> None:
        self.graph, self.labels = graph, labels
        self.seats = stack(graph)
        self.columns: dict[int, int] = {}
        for seat in self.seats.values():
            self.columns[seat.shelf] = max(self.columns.get(seat.shelf, 0), 1 + seat.column)
        self.below: dict[str, list[Link]] = {}
        for link in graph.links:
            ends = not link.targets and link.symbol == "flow"
            if len(link.sources) == 1 and link.sources[0] in self.seats and not link.submerged:
                own = self.below.setdefault(link.sources[0], [])
                if (link.by_weight or ends) and len(own) < 2:
                    own.append(link)
        self.standing: dict[str, list[Body]] = {}
        self.tops: dict[tuple[int, int], int] = {}
        self.pump_rows: list[int] = []
        self.basin_rows: list[int] = []
        self.height = self._rows(slack)

    @property
    def hanging(self) -> list[Link]:
        """The links below all tanks."""
        return [link for links in self.below.values() for link in links]

    def label(self, name: str) -> tuple[str, ...]:
        """Return the lines written beside an element."""
        return self.labels.get(name, (name,))

    def top(self, tank: str) -> int:
        """Return the line of the rim of a tank."""
        return self.tops[self.seats[tank].shelf, self.seats[tank].row]

    def inner(self, tank: str) -> int:
        """Return the side of a tank on which its instruments stand."""
        seat = self.seats[tank]
        return 1 if seat.column <= (self.columns[seat.shelf] - 1) / 2 else -1

    def beside(self, tank: str, side: int) -> Gap:
        """Return the gap at a side of a tank."""
        seat = self.seats[tank]
        return (seat.shelf, seat.column + (1 if side > 0 else 0))

    def low(self, tank: str) -> bool:
        """Tell whether pipes meet the walls of a tank near its floor."""
        return any(
            tank in (*link.sources, *(link.targets if link.submerged else ()))
            for link in self.graph.links
            if link.submerged or link not in self.below.get(tank, ())
        )

    def lowest(self, names: list[str]) -> str | None:
        """Return that of some tanks that stands lowest."""
        tanks = [name for name in names if name in self.seats]
        return max(
            tanks, key=lambda tank: (self.seats[tank].shelf, self.seats[tank].row), default=None
        )

    def falls_into(self, junction: Link) -> Link | None:
        """Return the first link below a tank that feeds a splitter."""
        if junction.symbol != "splitter" or self.ports(junction) > 4:
            return None
        return next((link for link in self.hanging if junction.name in link.targets), None)

    def ports(self, junction: Link) -> int:
        """Return how many pipes meet at a junction."""
        return len(self.graph.feeding(junction)) + len(junction.targets)

    def splitter(self, junction: Link, x: int, y: int, side: int) -> Body:
        """Return the body of a splitter."""
        words = self.label(junction.name)[0]
        return splitter_body(junction.name, words, x, y, self.ports(junction), side)

    def _rows(self, slack: int) -> int:
        y = 1
        for shelf in sorted(self.columns):
            own = [tank for tank, seat in self.seats.items() if seat.shelf == shelf]
            for row in range(1 + max(self.seats[tank].row for tank in own)):
                tanks = [tank for tank in own if self.seats[tank].row == row]
                y += 9 + slack
                self.tops[shelf, row] = y
                for tank in tanks:
                    self.standing[tank] = [tank_body(tank, 0, y)]
                    self._hang(tank, y + TANK_ROWS)
                hung = [body for tank in tanks for body in self.standing[tank]]
                y = 3 + slack + max(body.room[3] for body in hung)
            metered = any(i.seat not in self.seats for i in self.graph.instruments)
            self.pump_rows.append(y + 3)
            y += 6 + 2 * metered
            self.basin_rows.append(y)
            y += 5
        return y

    def _hang(self, tank: str, floor: int) -> None:
        """Build what stands below a tank, as if its middle were at 0."""
        links = self.below.get(tank, [])
        hung = self.standing[tank]
        for place, link in enumerate(links):
            side = self.inner(tank) if len(links) == 1 else (-1, 1)[place]
            x = 0 if len(links) == 1 else side * (2 if link.symbol == "orifice" else 3)
            label, ends = self.label(link.name), not link.targets
            hung.append(falling_body(link.name, link.symbol, x, floor, label, side, ends))
            for name in link.targets:
                junction = self.graph.junction(name)
                known = any(body.name == name for own in self.standing.values() for body in own)
                if junction is not None and self.falls_into(junction) is link and not known:
                    hung.append(self.splitter(junction, x, hung[-1].y + 4, side))

    def overhang(self, gap: Gap, side: int) -> defaultdict[int, int]:
        """Return how far words below the tanks at one wall of a gap reach into it, by row."""
        found: defaultdict[int, int] = defaultdict(int)
        for tank in (tank for tank in self.seats if self.beside(tank, side) == gap):
            for area in (area for body in self.standing[tank] for area in body.areas):
                reach = side * (area[2 if side > 0 else 0] - self.standing[tank][0].x) - TANK_HALF
                for row in range(area[1], area[3] + 1) if reach > 0 else ():
                    found[row] = max(found[row], reach + 1)
        return found


@dataclass(eq=False)
class Item:
    """What stands in a gap and is moved as one.

    Parameters
    ----------
    gap : (shelf, gap)
    side : {-1, +1}
        The wall of the gap that it keeps close to.
    bodies : list of Body
    rows : (top, bottom)
        In which nothing else stands in its way.
    reach : (left, right)
        How far it reaches from its middle.
    distance : int
        From that wall, at least; what has less stands nearer.
    """

    gap: Gap
    side: int
    bodies: list[Body]
    rows: tuple[int, int]
    reach: tuple[int, int]
    distance: int


class Gaps:
    """The items of every gap, and the columns that follow from them."""

    def __init__(self, frame: Frame, slack: int) -> None:
        self.frame, self.slack = frame, slack
        self.items: list[Item] = []

    @property
    def bodies(self) -> dict[str, Body]:
        """What stands in gaps, by name."""
        return {body.name: body for item in self.items for body in item.bodies}

    def add(
        self, gap: Gap, side: int, *bodies: Body, distance: int = 3, top: int | None = None
    ) -> None:
        """Put bodies into a gap; from `top` on nothing stands above them."""
        lefts, tops, rights, bottoms = zip(*(body.room for body in bodies), strict=True)
        rows = min(tops if top is None else (*tops, top)), max(bottoms)
        reach = -min(lefts), max(rights)
        self.items.append(Item(gap, side, list(bodies), rows, reach, distance))

    def item_of(self, name: str) -> Item | None:
        """Return the item in which a body stands."""
        return next((item for item in self.items for b in item.bodies if b.name == name), None)

    def count(self, gap: Gap, symbol: str) -> int:
        """Return how many items in a gap begin with a symbol."""
        return sum(item.gap == gap and item.bodies[0].symbol == symbol for item in self.items)

    def fill(self, gap: Gap, start: int) -> int:
        """Place what stands in a gap that begins at a column; return where it ends."""
        left, right = (self.frame.overhang(gap, side) for side in (1, -1))
        offsets = []
        own = [item for item in self.items if item.gap == gap]
        # Of what has the same distance, what is small stands before what reaches through many rows.
        for item in sorted(own, key=lambda item: (item.distance, item.rows[1] - item.rows[0])):
            taken, (near, far) = (left, item.reach) if item.side < 0 else (right, item.reach[::-1])
            rows = range(item.rows[0], item.rows[1] + 1)
            offset = max(item.distance, *(taken[row] for row in rows))
            offsets.append((item, offset + near))
            taken.update(dict.fromkeys(rows, offset + near + far + 2))
        used = max((left[row] + right[row] for row in {*left, *right}), default=0)
        width = used + 6 + self.slack
        for item, offset in offsets:
            x = start + offset if item.side < 0 else start + width - offset
            for body in item.bodies:
                body.move(x)
        return start + width
