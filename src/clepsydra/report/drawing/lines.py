"""Pipes and reservoirs of the process drawing as SVG text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from itertools import pairwise

from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import LETTER, PITCH
from clepsydra.report.drawing.routing import Pipe, Routes

_HOP = 6.0

Points = list[tuple[float, float]]


def draw_pipes(
    pipes: Sequence[Pipe], ways: Mapping[Pipe, Points], colours: Mapping[str, str]
) -> list[str]:
    """Return every pipe in the colour of its line, with an arch where it passes over another.

    Parameters
    ----------
    pipes : sequence of Pipe
    ways : mapping
        Pipe to its corner points [px].
    colours : mapping
        Line to colour.

    Examples
    --------
    >>> pipe = Pipe("outlet", "outlet", "basin", [(0, 0), (0, 2)])
    >>> ways = {pipe: [(0.0, 0.0), (0.0, 32.0)]}
    >>> draw_pipes([pipe], ways, {"outlet": "#123456"})[0].count("<path")
    1
    """
    parts = []
    for pipe in pipes:
        points, colour = ways[pipe], colours[pipe.line]
        title = pipe.line if pipe.source == pipe.end else f"{pipe.source} to {pipe.end}"
        (x1, y1), (x2, y2) = points[-2:]
        arrow = ""
        if pipe.arrow and x1 == x2:
            sign = 1 if y2 > y1 else -1
            arrow = f'<path d="M{x2 - 5:g} {y2 - 9 * sign:g}h10l-5 {9 * sign:g}z" fill="{colour}"/>'
        parts.append(
            f'<g><title>{escape(title)}</title><path d="{_path(pipe, ways)}" fill="none"'
            f' stroke="{colour}" stroke-width="3" stroke-linejoin="round"/>{arrow}</g>'
        )
    return parts


def _path(pipe: Pipe, ways: Mapping[Pipe, Points]) -> str:
    points = ways[pipe]
    words = [f"M{points[0][0]:.1f} {points[0][1]:.1f}"]
    for (x1, y1), (x2, y2) in pairwise(points):
        if y1 == y2 and x1 != x2:
            sign = 1 if x2 > x1 else -1
            for x in sorted(_crossings(pipe, ways, x1, x2, y1), reverse=sign < 0):
                words.append(f"H{x - sign * _HOP:.1f}")
                words.append(f"a{_HOP} {_HOP} 0 0 {1 if sign > 0 else 0} {2 * sign * _HOP} 0")
        words.append(f"L{x2:.1f} {y2:.1f}")
    return "".join(words)


def _crossings(
    pipe: Pipe, ways: Mapping[Pipe, Points], x1: float, x2: float, y: float
) -> set[float]:
    low, high = min(x1, x2) + 1.0, max(x1, x2) - 1.0
    found = set()
    for other, points in ways.items():
        if other is pipe:
            continue
        for (ax, ay), (bx, by) in pairwise(points):
            if ax == bx and low < ax < high and min(ay, by) < y - 1.0 and max(ay, by) > y + 1.0:
                found.add(ax)
    return found


def draw_basins(routes: Routes, ways: Mapping[Pipe, Points], width: float) -> list[str]:
    """Return each reservoir under what uses it; used in places far apart, it is drawn in parts.

    Examples
    --------
    >>> from clepsydra.report.drawing.flow_graph import FlowGraph
    >>> from clepsydra.report.drawing.placement import Placement
    >>> placement = Placement(FlowGraph((), ("basin",), (), (), ()), {}, basin_rows=[9])
    >>> len(draw_basins(Routes(placement, [], [(3, 0, "basin"), (6, 0, "basin")]), {}, 500.0))
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
            middle, room = (xs[0] + xs[-1]) / 2, 12.0 + LETTER * len(name) / 2
            left, right = min(xs[0] - 30.0, middle - room), max(xs[-1] + 30.0, middle + room)
            if place:
                left = max(left, (xs[0] + groups[place - 1][1][-1]) / 2 + 4.0)
            if place + 1 < len(groups):
                right = min(right, (xs[-1] + groups[place + 1][1][0]) / 2 - 4.0)
            shift = max(0.0, 4.0 - left)
            left, right = left + shift, min(right + shift, width - 4.0)
            parts.append(symbols.basin(left, right, y, name))
    return parts


def _passed(ways: Mapping[Pipe, Points], left: float, right: float, y: float) -> bool:
    """Tell whether a pipe runs down between two places."""
    return any(
        x1 == x2 and left < x1 < right and min(y1, y2) < y < max(y1, y2)
        for points in ways.values()
        for (x1, y1), (x2, y2) in pairwise(points)
    )
