"""Symbols of the process drawing, after the habits of ISA-5.1, as SVG text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from clepsydra.report.colours import INK
from clepsydra.report.drawing.outline import Outline
from clepsydra.report.drawing.style import PAPER, PIPE, STEEL

BALLOON, PUMP, RELAY = 19.0, 17.0, 13.0

_PORTS = {"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}


def titled(title: str, *shapes: str, kind: str = "") -> str:
    """Return shapes as one thing, with what it is called.

    Examples
    --------
    >>> titled("a < b", "<path/>", kind="basin")
    '<g class="basin"><title>a &lt; b</title><path/></g>'
    """
    name = f' class="{kind}"' if kind else ""
    return f"<g{name}><title>{escape(title)}</title>{''.join(shapes)}</g>"


def path(data: str, width: float = 1.5, fill: str = "none", stroke: str = INK) -> str:
    """Return lines along a path's data.

    Examples
    --------
    >>> path("M0 0H9")
    '<path d="M0 0H9" fill="none" stroke="#1f2328" stroke-width="1.5" stroke-linejoin="round"/>'
    """
    line = f'stroke="{stroke}" stroke-width="{width:g}" stroke-linejoin="round"'
    return f'<path d="{data}" fill="{fill}" {line}/>'


def circle(x: float, y: float, radius: float, fill: str = PAPER, width: float = 1.4) -> str:
    """Return a circle with an edge.

    Examples
    --------
    >>> circle(1, 2, 3.5, "none")
    '<circle cx="1" cy="2" r="3.5" fill="none" stroke="#1f2328" stroke-width="1.4"/>'
    """
    edge = f'stroke="{INK}" stroke-width="{width:g}"'
    return f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="{fill}" {edge}/>'


def _across(x: float, y: float, half: float, tall: float, width: float, rounded: float) -> str:
    """Return a box around a point."""
    size = f'width="{2 * half:g}" height="{2 * tall:g}" rx="{rounded:g}"'
    edge = f'stroke="{INK}" stroke-width="{width:g}"'
    return f'<rect x="{x - half:g}" y="{y - tall:g}" {size} fill="{PAPER}" {edge}/>'


def text(
    x: float, y: float, words: str, anchor: str = "middle", style: str = "", colour: str = INK
) -> str:
    """Return words at a point; a white halo keeps them readable over lines.

    Examples
    --------
    >>> text(1, 2, "a<b")
    '<text x="1" y="2" text-anchor="middle" fill="#1f2328">a&lt;b</text>'
    """
    kind = f' class="{style}"' if style else ""
    return (
        f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" fill="{colour}"{kind}>'
        f"{escape(words)}</text>"
    )


def tank(x: float, y: float, outline: Outline, share: float | None, tint: str, title: str) -> str:
    """Return a vessel with its rim at y, filled to a share of its height.

    Parameters
    ----------
    x, y : float
        Middle and rim [px].
    outline : Outline
    share : float or None
        None where nothing is known of a level.
    tint, title : str

    Examples
    --------
    >>> from clepsydra.report.drawing.outline import Outline
    >>> shape = Outline((1.0, 1.0))
    >>> "<title>level of tank_1</title>" in tank(0, 0, shape, 0.6, "#d3e2ee", "level of tank_1")
    True
    """
    parts = [path(_closed(outline.polygon(x, y)), 0.0, PAPER, "none")]
    if share is not None:
        filled = outline.polygon(x, y, min(max(share, 0.0), 1.0))
        (left, surface), (right, _) = filled[0], filled[-1]
        parts += [
            f'<path class="water" d="{_closed(filled)}" fill="{tint}"/>',
            path(f"M{left:.1f} {surface:.1f}H{right:.1f}", stroke=PIPE),
        ]
    wall = _closed(outline.polygon(x, y))
    shut = share is None or not outline.open_above
    return titled(title, *parts, path(wall if shut else wall[:-1], 2.0), kind="vessel")


def _closed(points: Sequence[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + "Z"


def weir(x: float, y: float, side: int, title: str) -> str:
    """Return a spout at the rim over which a vessel spills.

    Examples
    --------
    >>> "<title>weir" in weir(0, 0, 1, "weir of tank_1")
    True
    """
    data = (
        f"M{x - 7 * side:g} {y - 1:g}q{14 * side} -6 {15 * side} 9m{-4 * side} -4"
        f"l{4 * side} 5l{4 * side} -5"
    )
    return titled(title, path(data, 1.6))


def pump(x: float, y: float, way: tuple[int, int], stopped: bool, title: str) -> str:
    """Return a pump that delivers along (dx, dy): a circle with a triangle, hollow if stopped.

    Examples
    --------
    >>> [pump(0, 0, (0, -1), stopped, "pump_1").count("#6e7781") for stopped in (False, True)]
    [1, 0]
    """
    (dx, dy), half = way, 0.866 * PUMP
    corners = [
        (x - dx * PUMP / 2 + dy * half, y - dy * PUMP / 2 - dx * half),
        (x + dx * PUMP, y + dy * PUMP),
        (x - dx * PUMP / 2 - dy * half, y - dy * PUMP / 2 + dx * half),
    ]
    shell = circle(x, y, PUMP, PAPER if stopped else STEEL, 1.6)
    return titled(title, shell, path(_closed(corners), 1.2, PAPER if stopped else PIPE))


def valve(x: float, y: float, across: bool, side: int, shut: bool, title: str) -> str:
    """Return a control valve: two triangles, hollow if shut, and an actuator at `side`.

    Of a valve through which liquid runs sideways, `across`, the actuator is above.

    Examples
    --------
    >>> valve(0, 0, False, -1, False, "valve valve_1").count("Z")
    2
    """
    if across:
        body = f"M{x - 14:g} {y - 9:g}L{x + 14:g} {y + 9:g}V{y - 9:g}L{x - 14:g} {y + 9:g}Z"
        stem = f"M{x:g} {y:g}V{y - 16:g}"
        dome = f"M{x - 9:g} {y - 16:g}a9 9 0 0 1 18 0Z"
    else:
        body = f"M{x - 9:g} {y - 14:g}L{x + 9:g} {y + 14:g}H{x - 9:g}L{x + 9:g} {y - 14:g}Z"
        stem = f"M{x:g} {y:g}H{x + 16 * side:g}"
        dome = f"M{x + 16 * side:g} {y - 9:g}a9 9 0 0 {1 if side > 0 else 0} 0 18Z"
    halves = path(body, 1.3, PAPER if shut else PIPE)
    return titled(title, path(stem), path(dome, fill=PAPER), halves)


def flow(x: float, y: float, stopped: bool, title: str) -> str:
    """Return a flow that is given from outside: an arrow upward, hollow if it stands still.

    Examples
    --------
    >>> [flow(0, 0, still, "forced flow rain").count("#6e7781") for still in (False, True)]
    [1, 0]
    """
    return titled(title, path(f"M{x - 8:g} {y + 6:g}h16l-8 -15Z", 1.0, PAPER if stopped else PIPE))


def box(x: float, y: float, half_width: float, half_height: float, words: str, title: str) -> str:
    """Return a plain box with a word in it, for what has no symbol of its own.

    Examples
    --------
    >>> ">heater</text>" in box(0, 0, 48, 14, "heater", "heater heater_1")
    True
    """
    shell = _across(x, y, half_width, half_height, 1.5, 3)
    return titled(title, shell, text(x, y + 4, words, style="small inside"))


def channel(x: float, y: float, half_width: float, words: str, title: str) -> str:
    """Return a stretch of channel or pipe in which liquid spends a while.

    Examples
    --------
    >>> ">τ = 60 s</text>" in channel(0, 0, 48, "τ = 60 s", "transport delay channel")
    True
    """
    left, right = x - half_width, x + half_width
    inside = path(f"M{left:g} {y - 11:g}H{right:g}v22H{left:g}Z", 0.0, STEEL, "none")
    banks = path(f"M{left:g} {y - 11:g}H{right:g}M{left:g} {y + 11:g}H{right:g}", 1.8)
    return titled(title, inside, banks, text(x, y + 4, words, style="small inside"))


def splitter(x: float, y: float, ports: set[str], title: str) -> str:
    """Return a valve: one triangle for each port, pointing at its middle.

    Examples
    --------
    One triangle for each port:

    >>> splitter(0, 0, {"down", "right", "up"}, "splitter_1").count("Z")
    3
    """
    paths = []
    for port in sorted(ports):
        across, along = _PORTS[port]
        corners = [(x + 12 * across + 7 * side * along, y + 12 * along + 7 * side * across)
                   for side in (-1, 1)]  # fmt: skip
        (x1, y1), (x2, y2) = corners
        paths.append(f"M{x:g} {y:g}L{x1:g} {y1:g}L{x2:g} {y2:g}Z")
    return titled(title, path("".join(paths), fill=PAPER))


def header(x: float, y: float, half_width: float, title: str) -> str:
    """Return a splitter with many ports: a pipe across.

    Examples
    --------
    >>> header(0, 0, 48, "flow splitter splitter_1").count("<rect")
    1
    """
    return titled(title, _across(x, y, half_width, 5, 1.5, 5))


def orifice(x: float, y: float, across: bool, title: str) -> str:
    """Return a restriction: two short bars beside each other in the way of the pipe.

    Examples
    --------
    >>> orifice(0, 0, False, "outlet_1").count("h18")
    2
    """
    bars = "".join(
        f"M{x + shift:g} {y - 9:g}v18" if across else f"M{x - 9:g} {y + shift:g}h18"
        for shift in (-2.5, 2.5)
    )
    return titled(title, path(bars, 1.8))


def balloon(x: float, y: float, letters: str, number: str, title: str) -> str:
    """Return an instrument in the field: a circle with its letters and loop number.

    Examples
    --------
    >>> ">LT</text>" in balloon(0, 0, "LT", "101", "level_1")
    True
    """
    words = text(x, y - 3, letters, style="tag"), text(x, y + 11, number, style="tag")
    return titled(title, circle(x, y, BALLOON), *words)


def controller(x: float, y: float, half_width: float, words: Sequence[str], title: str) -> str:
    """Return a function of a control system with shared display: a circle in a box.

    The line across says that an operator has access to it.

    Examples
    --------
    >>> ">LIC</text>" in controller(0, 0, BALLOON, ("LIC", "101"), "controls level_1")
    True
    """
    letters, number = words
    return titled(
        title,
        _across(x, y, half_width, BALLOON, 1.4, 0),
        circle(x, y, BALLOON, "none", 1.1),
        path(f"M{x - half_width:g} {y:g}H{x + half_width:g}", 1.1),
        text(x, y - 4.5, letters, style="tag"),
        text(x, y + 12.5, number, style="tag"),
    )


def relay(x: float, y: float, sign: str, title: str) -> str:
    """Return what computes one signal from others: a small circle with a sign in it.

    Examples
    --------
    >>> ">Σ</text>" in relay(0, 0, "Σ", "feedforward")
    True
    """
    return titled(title, circle(x, y, RELAY), text(x, y + 5, sign, style="tag"))


def basin(left: float, right: float, y: float, name: str, tint: str) -> str:
    """Return a reservoir with its surface at y.

    Examples
    --------
    >>> ">basin</text>" in basin(0, 90, 0, "basin", "#d3e2ee")
    True
    """
    shell = f"M{left:.1f} {y - 12:g}V{y + 40:g}H{right:.1f}V{y - 12:g}"
    return titled(
        f"reservoir {name}",
        path(f"M{left:.1f} {y:g}H{right:.1f}v40H{left:.1f}Z", 0.0, tint, "none"),
        path(f"M{left:.1f} {y:g}H{right:.1f}", stroke=PIPE),
        path(shell, 2.0),
        text((left + right) / 2, y + 26, name, style="inside"),
        kind="basin",
    )
