"""Pipes, signal lines and reservoirs of the process drawing as SVG text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from itertools import pairwise

from clepsydra.report.colours import INK
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import NAME, PITCH
from clepsydra.report.drawing.lettering import width
from clepsydra.report.drawing.routing import ORDER, Pipe, Routes
from clepsydra.report.drawing.style import PIPE

_HOP = 6.0

Points = list[tuple[float, float]]


def draw_lines(ways: Mapping[Pipe, Points], still: set[str]) -> list[str]:
    """Return every pipe and signal line, with an arch where it passes over another.

    Signals arch over pipes; of two of a kind the level one arches.

    Parameters
    ----------
    ways : mapping
        Pipe to its corner points [px].
    still : set of str
        Elements and junctions through which nothing flows: their pipes are thin.

    Examples
    --------
    >>> pipe = Pipe("outlet", "outlet", "basin", [(0, 0), (0, 2)])
    >>> draw_lines({pipe: [(0.0, 0.0), (0.0, 32.0)]}, set())[0].count("<path")
    1
    """
    parts = []
    for pipe, points in ways.items():
        title = pipe.line if pipe.source == pipe.end else f"{pipe.source} to {pipe.end}"
        colour, size = (PIPE, 5.0) if pipe.kind == "pipe" else (INK, 4.0)
        stroke = f'stroke-width="{1.6 if pipe.line in still else 3.2:g}"'
        if pipe.kind != "pipe":
            dash = ' stroke-dasharray="5 3"' if pipe.kind == "signal" else ""
            stroke = f'stroke-width="1.2"{dash}'
        parts.append(
            f'<g class="{pipe.kind}"><title>{escape(title)}</title>'
            f'<path d="{_path(pipe, ways)}" fill="none" stroke="{colour}" {stroke}'
            f' stroke-linejoin="round"/>{_arrow(points, size, colour) if pipe.arrow else ""}</g>'
        )
    return parts


def _arrow(points: Points, half: float, colour: str) -> str:
    """Return the tip of a line at its end."""
    (x1, y1), (x2, y2) = points[-2:]
    dx, dy = ((x2 > x1) - (x2 < x1), (y2 > y1) - (y2 < y1))
    corners = [
        (x2 - 2 * half * dx + side * half * dy, y2 - 2 * half * dy + side * half * dx)
        for side in (-1, 1)
    ]
    return (
        f'<path class="arrow" d="M{x2:g} {y2:g}'
        + "".join(f"L{x:g} {y:g}" for x, y in corners)
        + f'Z" fill="{colour}"/>'
    )


def _path(pipe: Pipe, ways: Mapping[Pipe, Points]) -> str:
    points = ways[pipe]
    words = [f"M{points[0][0]:.1f} {points[0][1]:.1f}"]
    for (x1, y1), (x2, y2) in pairwise(points):
        level = y1 == y2
        start, end = (x1, x2) if level else (y1, y2)
        sign = 1 if end > start else -1
        for at in sorted(_crossings(pipe, ways, (x1, y1), (x2, y2)), reverse=sign < 0):
            turn = 1 if (sign > 0) == level else 0
            near, over = at - sign * _HOP, 2 * sign * _HOP
            words.append(f"H{near:.1f}" if level else f"V{near:.1f}")
            words.append(
                f"a{_HOP:g} {_HOP:g} 0 0 {turn} " + (f"{over} 0" if level else f"0 {over}")
            )
        words.append(f"L{x2:.1f} {y2:.1f}")
    return "".join(words)


def _crossings(
    pipe: Pipe,
    ways: Mapping[Pipe, Points],
    start: tuple[float, float],
    end: tuple[float, float],
) -> set[float]:
    """Return where a piece of a line has to arch over others."""
    along = 0 if start[1] == end[1] else 1
    across = 1 - along
    low, high = sorted((start[along], end[along]))
    found = set()
    for other, points in ways.items():
        arches = (
            ORDER.index(pipe.kind) > ORDER.index(other.kind)
            if pipe.kind != other.kind
            else along == 0
        )
        if other is pipe or not arches:
            continue
        for one, two in pairwise(points):
            if (
                one[along] == two[along]
                and low + 1.0 < one[along] < high - 1.0
                and min(one[across], two[across]) < start[across] - 1.0
                and max(one[across], two[across]) > start[across] + 1.0
            ):
                found.add(one[along])
    return found


def draw_basins(
    routes: Routes, ways: Mapping[Pipe, Points], edge: float, tint: Callable[[str], str]
) -> list[str]:
    """Return each reservoir under what uses it; used in places far apart, it is drawn in parts.

    Parameters
    ----------
    routes : Routes
    ways : mapping
        Pipe to its corner points [px].
    edge : float
        Width of the drawing [px].
    tint : callable
        Reservoir to the colour of what is in it.

    Examples
    --------
    >>> from clepsydra.report.drawing.flow_graph import FlowGraph
    >>> from clepsydra.report.drawing.placement import Placement
    >>> placement = Placement(FlowGraph((), ("basin",), (), (), ()), {}, basin_rows=[9])
    >>> routes = Routes(placement, [], [(3, 0, "basin"), (6, 0, "basin")])
    >>> len(draw_basins(routes, {}, 500.0, lambda name: "#d3e2ee"))
    1
    """
    parts = []
    for shelf, row in enumerate(routes.placement.basin_rows):
        y = PITCH * row
        groups: list[tuple[str, list[float]]] = []
        uses = sorted((PITCH * x, name) for x, there, name in routes.basin_uses if there == shelf)
        for x, name in uses:
            last = groups[-1] if groups else None
            if last and last[0] == name and not _passed(ways, last[1][-1], x, y + 10.0):
                last[1].append(x)
            else:
                groups.append((name, [x]))
        for place, (name, xs) in enumerate(groups):
            middle, room = (xs[0] + xs[-1]) / 2, 12.0 + width(name, NAME) / 2
            left, right = min(xs[0] - 30.0, middle - room), max(xs[-1] + 30.0, middle + room)
            if place:
                left = max(left, (xs[0] + groups[place - 1][1][-1]) / 2 + 4.0)
            if place + 1 < len(groups):
                right = min(right, (xs[-1] + groups[place + 1][1][0]) / 2 - 4.0)
            shift = max(0.0, 4.0 - left)
            left, right = left + shift, min(right + shift, edge - 4.0)
            parts.append(symbols.basin(left, right, y, name, tint(name)))
    return parts


def _passed(ways: Mapping[Pipe, Points], left: float, right: float, y: float) -> bool:
    """Tell whether a pipe runs down between two places."""
    return any(
        x1 == x2 and left < x1 < right and min(y1, y2) < y < max(y1, y2)
        for points in ways.values()
        for (x1, y1), (x2, y2) in pairwise(points)
    )
