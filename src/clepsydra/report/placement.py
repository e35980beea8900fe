"""Where each tank, riser and instrument of the process drawing stands.

Tanks stand above those that they drain into, in columns. Between the columns are gaps for what
runs upright: instruments, risers from the pumps, and pipes that pass a tank on their way down.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.report.flow_graph import Feed, FlowGraph, Outlet, Split, leaves

TANK_WIDTH, TANK_HEIGHT = 132.0, 116.0
#: Room for the instruments of one sensor beside a tank.
SENSOR_WIDTH = 98.0
#: Width of a bold letter in a name, wide fonts included.
LETTER = 9.0


@dataclass
class Riser:
    """An upright pipe that feeds tanks; it belongs to a source or to a splitter.

    Parameters
    ----------
    name : str
        Of the pump, inflow or splitter at its foot.
    feed : Feed
        What brings the liquid.
    split : Split or None
    targets : list of (share, tank or reservoir)
        Share is None where nothing is divided.
    parent : Riser or None
        The riser that feeds it through a pipe above the pumps.
    gap : int
    outward : {-1, +1}
        The side on which its labels stand.
    x : float

    Examples
    --------
    >>> feed = Feed("pump_1", True, "basin", "tank_1")
    >>> Riser("pump_1", feed, None, [(None, "tank_1")], None, gap=0, outward=-1).x
    0.0
    """

    name: str
    feed: Feed
    split: Split | None
    targets: list[tuple[float | None, str]]
    parent: Riser | None
    gap: int
    outward: int
    x: float = 0.0


@dataclass
class Placement:
    """The columns, layers and upright lines of a drawing.

    Parameters
    ----------
    graph : FlowGraph
    layer, column : dict
        Of each tank; layer 0 is the lowest.
    centre : dict
        Tank to the x of its centre.
    sensor_side : dict
        Tank to +1 where its instruments stand to the right, -1 to the left.
    risers : list of Riser
    stubs : list of Feed
        Inflows straight into a tank.
    downcomers : dict
        (outlet, receiver) to the x of the upright line that it takes past other tanks.
    width : float

    Examples
    --------
    >>> outlet, pump = Outlet("outlet", "tank", "basin"), Feed("pump", True, "basin", "tank")
    >>> graph = FlowGraph(("tank",), (outlet,), (pump,), ())
    >>> placement = place(graph, {"pump": ("pump",)})
    >>> placement.below("tank"), placement.falls_straight(outlet, "basin")
    ([], True)
    """

    graph: FlowGraph
    layer: dict[str, int]
    column: dict[str, int]
    centre: dict[str, float] = field(default_factory=dict)
    sensor_side: dict[str, int] = field(default_factory=dict)
    risers: list[Riser] = field(default_factory=list)
    stubs: list[Feed] = field(default_factory=list)
    downcomers: dict[tuple[str, str], float] = field(default_factory=dict)
    width: float = 0.0

    def below(self, tank: str) -> list[str]:
        """Return the tanks under a tank in its column, the nearest first."""
        found = [
            other
            for other in self.graph.tanks
            if self.column[other] == self.column[tank] and self.layer[other] < self.layer[tank]
        ]
        return sorted(found, key=lambda other: -self.layer[other])

    def falls_straight(self, outlet: Outlet, receiver: str) -> bool:
        """Tell whether an outlet reaches a receiver without leaving its column."""
        below = self.below(outlet.source)
        if receiver in self.layer:
            return bool(below) and below[0] == receiver
        return not below


def place(graph: FlowGraph, labels: dict[str, tuple[str, ...]]) -> Placement:
    """Place everything that has an x.

    Parameters
    ----------
    graph : FlowGraph
    labels : dict
        Name of each pump, inflow and splitter to the lines written beside it.

    Examples
    --------
    A pump stands to the left of the only tank that it feeds:

    >>> outlet, pump = Outlet("outlet", "tank", "basin"), Feed("pump", True, "basin", "tank")
    >>> graph = FlowGraph(("tank",), (outlet,), (pump,), ())
    >>> placement = place(graph, {"pump": ("pump",)})
    >>> placement.risers[0].x < placement.centre["tank"]
    True
    """
    layer = graph.layers()
    placement = Placement(graph, layer, _columns(graph, layer))
    columns = max(placement.column.values()) + 1
    for tank, column in placement.column.items():
        placement.sensor_side[tank] = 1 if column <= (columns - 1) / 2 else -1
    _collect_risers(placement, columns)
    _lay_out_gaps(placement, columns, labels)
    return placement


def _columns(graph: FlowGraph, layer: dict[str, int]) -> dict[str, int]:
    """Put each tank above the first tank that it drains into, others of them beside it."""
    feeders: dict[str, list[str]] = {tank: [] for tank in graph.tanks}
    grounded = []
    for tank in graph.tanks:
        lower = [
            leaf
            for outlet in graph.outlets
            if outlet.source == tank
            for leaf in leaves(outlet.target)
            if layer.get(leaf) == layer[tank] - 1
        ]
        if lower:
            feeders[lower[0]].append(tank)
        else:
            grounded.append(tank)
    column: dict[str, int] = {}

    def settle(tank: str, first: int) -> int:
        column[tank] = free = first
        for upper in feeders[tank]:
            free = settle(upper, free)
        return max(free, first + 1)

    free = 0
    for tank in grounded:
        free = settle(tank, free)
    return column


def _collect_risers(placement: Placement, columns: int) -> None:
    graph = placement.graph
    by_splitter: dict[str, Riser] = {}
    for feed in graph.feeds:
        if not feed.pumped and isinstance(feed.target, str) and feed.target in placement.layer:
            placement.stubs.append(feed)
            continue
        tanks = [leaf for leaf in leaves(feed.target) if leaf in placement.layer]
        lowest = min(tanks, key=lambda tank: placement.layer[tank], default=graph.tanks[0])
        column = placement.column[lowest]
        left = column <= (columns - 1) / 2
        if columns == 1:
            left = len([riser for riser in placement.risers if riser.parent is None]) % 2 == 0
        gap = column if left else column + 1
        _add_riser(placement, by_splitter, feed, feed.target, None, gap, -1 if left else 1)


def _add_riser(
    placement: Placement,
    by_splitter: dict[str, Riser],
    feed: Feed,
    target: str | Split,
    parent: Riser | None,
    gap: int,
    outward: int,
) -> None:
    if isinstance(target, str):
        riser = Riser(feed.name, feed, None, [(None, target)], parent, gap, outward)
        placement.risers.append(riser)
        return
    if target.name in by_splitter:
        # A second source of the same splitter: a riser without targets, joined to its foot.
        shared = by_splitter[target.name]
        placement.risers.append(Riser(feed.name, feed, None, [], shared, gap, outward))
        return
    direct = [(share, leaf) for share, leaf in target.branches if isinstance(leaf, str)]
    name = target.name if parent else feed.name
    riser = Riser(name, feed, target, list(direct), parent, gap, outward)
    by_splitter[target.name] = riser
    placement.risers.append(riser)
    for _, branch in target.branches:
        if isinstance(branch, Split):
            _add_riser(placement, by_splitter, feed, branch, riser, gap, outward)


def _lay_out_gaps(placement: Placement, columns: int, labels: dict[str, tuple[str, ...]]) -> None:
    strips = [[0, 0] for _ in range(columns + 1)]
    for tank, side in placement.sensor_side.items():
        count = len([sensor for sensor, owner in placement.graph.sensors if owner == tank])
        gap = placement.column[tank] + (1 if side > 0 else 0)
        end = 0 if side > 0 else 1
        strips[gap][end] = max(strips[gap][end], count)
    passing = [
        (outlet, receiver)
        for outlet in placement.graph.outlets
        for receiver in leaves(outlet.target)
        if _needs_downcomer(placement, outlet, receiver)
    ]
    x = 16.0
    middles = []
    for gap in range(columns + 1):
        start = x
        x += SENSOR_WIDTH * strips[gap][0]
        for outlet, receiver in passing:
            tank = outlet.source
            if placement.column[tank] + (1 if placement.sensor_side[tank] > 0 else 0) == gap:
                x += 26.0
                placement.downcomers[outlet.name, receiver] = x - 8.0
        risers = [riser for riser in placement.risers if riser.gap == gap]
        for riser in sorted(risers, key=lambda entry: _order(placement, entry)):
            words = [
                *labels.get(riser.name, ()),
                *(labels[riser.split.name] if riser.split else ()),
            ]
            room = 34.0 + LETTER * max((len(word) for word in words), default=0)
            riser.x = x + (room if riser.outward < 0 else 30.0)
            x += room + 30.0
        x += SENSOR_WIDTH * strips[gap][1]
        x = max(x, start + 40.0)
        if gap < columns:
            middles.append(x + TANK_WIDTH / 2)
            x += TANK_WIDTH
    placement.width = x + 16.0
    for tank, column in placement.column.items():
        placement.centre[tank] = middles[column]


def _needs_downcomer(placement: Placement, outlet: Outlet, receiver: str) -> bool:
    if placement.falls_straight(outlet, receiver):
        return False
    return placement.layer.get(receiver, -1) != placement.layer[outlet.source] - 1


def _order(placement: Placement, riser: Riser) -> tuple[int, int]:
    """Order risers of a gap so that the one that reaches highest stands outermost."""
    highest = max((placement.layer.get(tank, -1) for _, tank in riser.targets), default=-1)
    return (riser.outward, highest * riser.outward)
