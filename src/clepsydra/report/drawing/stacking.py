"""In which column and row of the process drawing each tank stands.

Tanks stand above those that they drain into. A stack that would be too tall goes on in columns
beside it, and what would be too wide goes on in a shelf below, like lines of text.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.report.drawing.flow_graph import FlowGraph

_MOST_ROWS = 4
#: Less where pumps or pipes stand between neighbours, and one more where all fit then.
_MOST_COLUMNS, _MOST_NEIGHBOURS = 5, 3


@dataclass(frozen=True)
class Seat:
    """Where a tank stands: shelf from the top, column from the left, row from the top."""

    shelf: int
    column: int
    row: int


def stack(graph: FlowGraph) -> dict[str, Seat]:
    """Give every tank its seat.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.report.drawing.flow_graph import flow_graph
    >>> stack(flow_graph(load_process("quadruple-tank")))["tank_4"]
    Seat(shelf=0, column=1, row=0)
    """
    layer = graph.layers()
    column = _columns(graph, layer)
    rows = max(layer.values(), default=0) + 1
    width = max(column.values(), default=0) + 1
    height = math.ceil(rows / math.ceil(rows / _MOST_ROWS))
    cells = {}
    for tank in graph.vessels:
        band, row = divmod(rows - 1 - layer[tank], height)
        cells[tank] = (band * width + column[tank], row)
    used = sorted({place for place, _ in cells.values()})
    most = _MOST_COLUMNS
    if _beside(graph):
        most = _MOST_NEIGHBOURS + (len(used) == _MOST_NEIGHBOURS + 1)
    chunk = math.ceil(len(used) / math.ceil(len(used) / most)) if used else 1
    seats = {}
    for tank, (place, row) in cells.items():
        shelf, across = divmod(used.index(place), chunk)
        # Every second shelf runs back, so that what joins two shelves is short.
        across = chunk - 1 - across if shelf % 2 else across
        seats[tank] = Seat(shelf, across, row)
    return _closed_up(seats)


def _closed_up(seats: dict[str, Seat]) -> dict[str, Seat]:
    """Take out the rows and columns of a shelf that hold no tank."""
    closed = {}
    for shelf in {seat.shelf for seat in seats.values()}:
        own = {tank: seat for tank, seat in seats.items() if seat.shelf == shelf}
        rows = sorted({seat.row for seat in own.values()})
        columns = sorted({seat.column for seat in own.values()})
        for tank, seat in own.items():
            closed[tank] = Seat(shelf, columns.index(seat.column), rows.index(seat.row))
    return {tank: closed[tank] for tank in seats}


def _columns(graph: FlowGraph, layer: dict[str, int]) -> dict[str, int]:
    """Put each tank above the first tank that it drains into, others of them beside it."""
    feeders: dict[str, list[str]] = {tank: [] for tank in graph.vessels}
    grounded = []
    for tank in graph.vessels:
        below = [
            lower
            for upper, lower in graph.falls()
            if upper == tank and layer[lower] == layer[tank] - 1
        ]
        if below:
            feeders[below[0]].append(tank)
        else:
            grounded.append(tank)
    column: dict[str, int] = {}

    def settle(tank: str, first: int) -> int:
        column[tank] = free = first
        for upper in feeders[tank]:
            free = settle(upper, free)
        return max(free, first + 1)

    free = 0
    for tank in _in_a_line(grounded, _beside(graph)):
        free = settle(tank, free)
    return column


def _beside(graph: FlowGraph) -> list[tuple[str, str]]:
    """Return the pairs of tanks that want to be neighbours: joined, or one fed from the other."""
    pumped = [
        (source, end)
        for link in graph.links
        if not link.submerged
        for source in link.sources
        for end in graph.ends(link)
        if source in graph.vessels and end in graph.vessels
    ]
    return [*graph.neighbours(), *pumped]


def _in_a_line(tanks: list[str], pairs: Iterable[tuple[str, str]]) -> list[str]:
    """Order tanks so that those of a pair stand side by side where they can."""
    beside: dict[str, list[str]] = {tank: [] for tank in tanks}
    entered: dict[str, int] = dict.fromkeys(tanks, 0)
    for one, other in pairs:
        if one in beside and other in beside and one != other:
            beside[one].append(other)
            beside[other].append(one)
            entered[other] += 1
    order: list[str] = []

    def walk(tank: str) -> None:
        if tank in order:
            return
        order.append(tank)
        for other in beside[tank]:
            walk(other)

    # Begin at the ends of chains, and there where nothing comes in.
    for tank in sorted(tanks, key=lambda t: (len(set(beside[t])) > 1, entered[t] > 0)):
        if tank not in order and (len(set(beside[tank])) <= 1 or not order):
            walk(tank)
    for tank in tanks:
        walk(tank)
    # Tanks without any partner keep the order of the file.
    return order if any(beside.values()) else list(tanks)
