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
    layers = max(layer.values(), default=0) + 1
    width = max(column.values(), default=0) + 1
    height = math.ceil(layers / math.ceil(layers / _MOST_ROWS))
    cells = {}
    for tank in graph.vessels:
        band, row = divmod(layers - 1 - layer[tank], height)
        cells[tank] = (band * width + column[tank], row)
    used = sorted({place for place, _ in cells.values()})
    most = _MOST_COLUMNS
    if _beside(graph):
        most = _MOST_NEIGHBOURS + (len(used) == _MOST_NEIGHBOURS + 1)
    chunk = math.ceil(len(used) / math.ceil(len(used) / most)) if used else 1
    seats = {}
    for shelf, first in enumerate(range(0, len(used), chunk)):
        places = used[first : first + chunk]
        # Every second shelf runs back, so that what joins two shelves is short.
        places = places[::-1] if shelf % 2 else places
        own = {tank: cell for tank, cell in cells.items() if cell[0] in places}
        rows = sorted({row for _, row in own.values()})
        for tank, (place, row) in own.items():
            seats[tank] = Seat(shelf, places.index(place), rows.index(row))
    return {tank: seats[tank] for tank in graph.vessels}


def _columns(graph: FlowGraph, layer: dict[str, int]) -> dict[str, int]:
    """Put each tank above the first tank that it drains into, others of them beside it."""
    under: dict[str, str] = {}
    for upper, lower in graph.falls():
        if layer[lower] == layer[upper] - 1:
            under.setdefault(upper, lower)
    column: dict[str, int] = {}

    def settle(tank: str, first: int) -> int:
        column[tank] = free = first
        for upper in (each for each in graph.vessels if under.get(each) == tank):
            free = settle(upper, free)
        return max(free, first + 1)

    grounded = [tank for tank in graph.vessels if tank not in under]
    free = 0
    for tank in _in_a_line(grounded, _beside(graph)):
        free = settle(tank, free)
    return column


def _beside(graph: FlowGraph) -> list[tuple[str, str]]:
    """Return the pairs of tanks that want to be neighbours: joined, or one fed from the other."""
    fed = graph.pairs(link for link in graph.links if not link.submerged)
    return [*graph.neighbours(), *fed]


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
        walk(tank)
    return order
