"""Symbols of the process drawing, after the habits of ISA-5.1.

What stands in a pipe is drawn around 0 with liquid running up, and turned to where it runs.
"""

from __future__ import annotations

import math

from clepsydra.report.drawing.outline import Outline
from clepsydra.report.drawing.shapes import (
    PAPER,
    PIPE,
    STEEL,
    box,
    circle,
    path,
    polygon,
    text,
    titled,
)

BALLOON, PUMP, RELAY = 19.0, 17.0, 13.0

Way = tuple[int, int]


def fitting(symbol: str, x: float, y: float, way: Way, still: bool, title: str) -> str:
    """Return the symbol of what liquid runs through along (dx, dy), hollow if it stands still.

    The actuator of a valve is at its right as the liquid runs.

    Examples
    --------
    >>> [fitting("pump", 0, 0, (0, -1), still, "p").count("#6e7781") for still in (False, True)]
    [1, 0]
    """
    fill = PAPER if still else PIPE
    halves = path("M-9 -14L9 14H-9L9 -14Z", 1.3, fill)
    shapes = {
        "pump": circle(0, 0, PUMP, PAPER if still else STEEL, width=1.6)
        + path("M-14.7 8.5L0 -17L14.7 8.5Z", 1.2, fill),
        "valve": path("M0 0H16") + path("M16 -9a9 9 0 0 1 0 18Z", fill=PAPER) + halves,
        "flow": path("M-8 6h16l-8 -15Z", 1.0, fill),
        "orifice": path("M-9 -2.5h18M-9 2.5h18", 1.8),
        "end": path("M-6 0h12", 3.0, stroke=PIPE),
        "stub": circle(0, 0, 3.5, fill, width=1.0),
    }
    return titled(title, shapes[symbol], moved=_turned(x, y, way))


def _turned(x: float, y: float, way: Way) -> str:
    angle = math.degrees(math.atan2(way[0], -way[1]))
    return f"translate({x:g} {y:g})" + (f" rotate({angle:g})" if angle else "")


def splitter(x: float, y: float, ways: set[Way], title: str) -> str:
    """Return a valve with one triangle for each pipe, pointing at its middle."""
    corners = (
        [(0, 0), *((12 * dx + 7 * side * dy, 12 * dy + 7 * side * dx) for side in (-1, 1))]
        for dx, dy in sorted(ways)
    )
    data = "".join(map(polygon, corners))
    return titled(title, path(data, fill=PAPER), moved=f"translate({x:g} {y:g})")


def header(x: float, y: float, half_width: float, title: str) -> str:
    """Return a splitter with many ports: a pipe across."""
    return titled(title, box((x - half_width, x + half_width), (y - 5, y + 5), rounded=5))


def plain(x: float, y: float, half_width: float, words: str, title: str) -> str:
    """Return a box with a word in it, for what has no symbol of its own."""
    shell = box((x - half_width, x + half_width), (y - 13, y + 13), rounded=3)
    return titled(title, shell, text(x, y + 4, words, style="small inside"))


def channel(x: float, y: float, half_width: float, words: str, title: str) -> str:
    """Return a stretch of channel or pipe in which liquid spends a while."""
    left, right = x - half_width, x + half_width
    inside = box((left, right), (y - 11, y + 11), STEEL, "", None)
    banks = path(f"M{left:g} {y - 11:g}H{right:g}M{left:g} {y + 11:g}H{right:g}", 1.8)
    return titled(title, inside, banks, text(x, y + 4, words, style="small inside"))


def balloon(x: float, y: float, letters: str, number: str, title: str) -> str:
    """Return an instrument in the field: a circle with its letters and loop number."""
    words = text(x, y - 3, letters, style="tag"), text(x, y + 11, number, style="tag")
    return titled(title, circle(x, y, BALLOON), *words)


def controller(x: float, y: float, half_width: float, letters: str, number: str, title: str) -> str:
    """Return a function of a control system with shared display: a circle in a box.

    The line across says that an operator has access to it.
    """
    left, right = x - half_width, x + half_width
    return titled(
        title,
        box((left, right), (y - BALLOON, y + BALLOON), width=1.4),
        circle(x, y, BALLOON, "none", width=1.1),
        path(f"M{left:g} {y:g}H{right:g}", 1.1),
        text(x, y - 4.5, letters, style="tag"),
        text(x, y + 12.5, number, style="tag"),
    )


def relay(x: float, y: float, sign: str, title: str) -> str:
    """Return what computes one signal from others: a small circle with a sign in it."""
    return titled(title, circle(x, y, RELAY), text(x, y + 5, sign, style="tag"))


def tank(x: float, y: float, outline: Outline, share: float | None, tint: str, title: str) -> str:
    """Return a vessel with its rim at y, filled to a share of its height.

    Parameters
    ----------
    x, y : float
        Middle and rim [px].
    share : float or None
        None where nothing is known of a level.
    """
    wall = outline.polygon(x, y)
    parts = [path(polygon(wall), 0.0, PAPER, "none")]
    if share is not None:
        filled = outline.polygon(x, y, min(max(share, 0.0), 1.0))
        parts.append(path(polygon(filled), 0.0, tint, "none", class_="water"))
        parts.append(path(polygon([filled[0], filled[-1]], closed=False), stroke=PIPE))
    shut = share is None or not outline.open_above
    return titled(title, *parts, path(polygon(wall, closed=shut), 2.0), kind="vessel")


def weir(x: float, y: float, side: int, title: str) -> str:
    """Return a spout at the rim over which a vessel spills."""
    spout = path("M-7 -1q14 -6 15 9m-4 -4l4 5l4 -5", 1.6)
    return titled(title, spout, moved=f"translate({x:g} {y:g}) scale({side} 1)")


def basin(left: float, right: float, y: float, name: str, tint: str) -> str:
    """Return a reservoir with its surface at y."""
    shell = f"M{left:.1f} {y - 12:g}V{y + 40:g}H{right:.1f}V{y - 12:g}"
    return titled(
        f"reservoir {name}",
        box((left, right), (y, y + 40), tint, "", None),
        path(f"M{left:.1f} {y:g}H{right:.1f}", stroke=PIPE),
        path(shell, 2.0),
        text((left + right) / 2, y + 26, name, style="inside"),
        kind="basin",
    )
