"""Pipes, signal lines and reservoirs of the process drawing as SVG text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

from clepsydra.report.colours import INK
from clepsydra.report.drawing.alive import direction_mark
from clepsydra.report.drawing.bodies import NAME, PITCH, Pipe, direction
from clepsydra.report.drawing.routing import ORDER, Routes
from clepsydra.report.drawing.shapes import PIPE, box, element, path, polygon, text, titled, width

_HOP = 6.0

Point = tuple[float, float]
Points = list[Point]


def draw_lines(ways: Mapping[Pipe, Points], still: set[str], *, alive: bool = False) -> list[str]:
    """Return every pipe and signal line, with an arch where it passes over another.

    Signals arch over pipes; of two of a kind the level one arches.

    Parameters
    ----------
    ways : mapping
        Pipe to its corner points [px].
    still : set of str
        Elements and junctions through which nothing flows: their pipes are thin.
    alive : bool
        Whether each tells what runs through it, and where to, for a page that moves it.
    """
    parts = []
    for pipe, points in ways.items():
        title = pipe.line if pipe.source == pipe.end else f"{pipe.source} to {pipe.end}"
        colour, size, thick = PIPE, 5.0, 1.6 if pipe.line in still else 3.2
        if pipe.kind != "pipe":
            colour, size, thick = INK, 4.0, 1.2
        dash = "5 3" if pipe.kind == "signal" else ""
        line = path(_arched(pipe, ways), thick, stroke=colour, stroke_dasharray=dash)
        tip = _tip(points, size, colour) if pipe.arrow else ""
        told = {}
        if alive and pipe.kind == "pipe":
            tip = tip or direction_mark(points, colour)
            told = {"data_pipe": pipe.line, "data_from": pipe.source, "data_to": pipe.end}
        elif alive and pipe.kind == "signal":
            told = {"data_acts": pipe.end}
        parts.append(titled(title, line, tip, kind=pipe.kind, **told))
    return parts


def _tip(points: Points, half: float, colour: str) -> str:
    """Return the arrow in which a line ends."""
    x, y = points[-1]
    dx, dy = direction(*points[-2:])
    corners = [
        (x - 2 * half * dx + side * half * dy, y - 2 * half * dy + side * half * dx)
        for side in (-1, 1)
    ]
    return element("path", class_="arrow", d=polygon([(x, y), *corners]), fill=colour)


def _arched(pipe: Pipe, ways: Mapping[Pipe, Points]) -> str:
    points = ways[pipe]
    data = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for one, two in pairwise(points):
        dx, dy = direction(one, two)
        turn = int(dx > 0 or dy < 0)
        for x, y in sorted(_crossings(pipe, ways, one, two), reverse=dx + dy < 0):
            data += f"L{x - _HOP * dx:.1f} {y - _HOP * dy:.1f}"
            data += f"a{_HOP:g} {_HOP:g} 0 0 {turn} {2 * _HOP * dx:g} {2 * _HOP * dy:g}"
        data += f"L{two[0]:.1f} {two[1]:.1f}"
    return data


def _crossings(pipe: Pipe, ways: Mapping[Pipe, Points], start: Point, end: Point) -> set[Point]:
    """Return where a piece of a line has to arch over others."""
    along = int(start[0] == end[0])
    across = 1 - along
    low, high = sorted((start[along], end[along]))
    found = set()
    for other, points in ways.items():
        arches = (ORDER.index(pipe.kind), across) > (ORDER.index(other.kind), 0)
        for one, two in pairwise(points) if arches and other is not pipe else ():
            near, far = sorted((one[across], two[across]))
            if (
                one[along] == two[along]
                and low + 1.0 < one[along] < high - 1.0
                and near < start[across] - 1.0
                and far > start[across] + 1.0
            ):
                found.add((start[0], one[1]) if along else (one[0], start[1]))
    return found


def draw_basins(
    routes: Routes, ways: Mapping[Pipe, Points], edge: float, tint: Callable[[str], str]
) -> list[str]:
    """Return each reservoir under what uses it; used in places far apart, it is drawn in parts.

    Parameters
    ----------
    ways : mapping
        Pipe to its corner points [px].
    edge : float
        Width of the drawing [px].
    tint : callable
        Reservoir to the colour of what is in it.
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
            shell = f"M{left:.1f} {y - 12:g}V{y + 40:g}H{right:.1f}V{y - 12:g}"
            shapes = (
                box((left, right), (y, y + 40), tint(name), "", None),
                path(f"M{left:.1f} {y:g}H{right:.1f}", stroke=PIPE),
                path(shell, 2.0),
                text((left + right) / 2, y + 26, name, style="inside"),
            )
            parts.append(titled(f"reservoir {name}", *shapes, kind="basin"))
    return parts


def _passed(ways: Mapping[Pipe, Points], left: float, right: float, y: float) -> bool:
    """Tell whether a pipe runs down between two places."""
    return any(
        x1 == x2 and left < x1 < right and min(y1, y2) < y < max(y1, y2)
        for points in ways.values()
        for (x1, y1), (x2, y2) in pairwise(points)
    )
