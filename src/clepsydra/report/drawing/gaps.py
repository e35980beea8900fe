"""What stands in the gaps between the columns of tanks, side by side."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.report.drawing.bodies import Body
from clepsydra.report.drawing.frame import Frame, Gap


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
    distance : int
        From that wall, at least; what has less stands nearer.

    Examples
    --------
    >>> from clepsydra.report.drawing.bodies import relay_body
    >>> Item((0, 0), -1, [relay_body("sum", 5)], (4, 6)).reach
    (2, 2)
    """

    gap: Gap
    side: int
    bodies: list[Body]
    rows: tuple[int, int]
    distance: int = 3

    @property
    def reach(self) -> tuple[int, int]:
        """How far it reaches to the left and to the right of its middle."""
        rooms = [body.room for body in self.bodies]
        return -min(room[0] for room in rooms), max(room[2] for room in rooms)


class Gaps:
    """The items of every gap, and the columns that follow from them.

    Examples
    --------
    >>> from clepsydra.report.drawing.bodies import relay_body
    >>> from clepsydra.report.drawing.flow_graph import FlowGraph
    >>> gaps = Gaps(Frame(FlowGraph(("tank",), (), (), (), ()), {}, 0), 0)
    >>> gaps.add((0, 0), -1, relay_body("sum", 5))
    >>> gaps.fill((0, 0), 2), gaps.bodies["sum"].x
    (15, 7)
    """

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
        rooms = [body.room for body in bodies]
        tops = [room[1] for room in rooms] + ([] if top is None else [top])
        rows = min(tops), max(room[3] for room in rooms)
        self.items.append(Item(gap, side, list(bodies), rows, distance))

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
        outermost = gap[1] in (0, self.frame.columns[gap[0]])
        width = used + 4 + self.slack + (0 if outermost else 2)
        for item, offset in offsets:
            x = start + offset if item.side < 0 else start + width - offset
            for body in item.bodies:
                body.move(x)
        return start + width
