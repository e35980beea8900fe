"""Symbols of the process drawing, after the habits of ISA-5.1, as SVG text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.outline import Outline

BALLOON = 19.0
PUMP = 17.0

_PORTS = {"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}


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


def tank(x: float, y: float, outline: Outline, share: float | None, colour: str, title: str) -> str:
    """Return a vessel with its rim at y, filled to a share of its height.

    Parameters
    ----------
    x, y : float
        Middle and rim [px].
    outline : Outline
    share : float or None
        None where nothing is known of a level.
    colour, title : str

    Examples
    --------
    >>> from clepsydra.report.drawing.outline import Outline
    >>> shape = Outline((1.0, 1.0))
    >>> "<title>level of tank_1</title>" in tank(0, 0, shape, 0.6, "#0072B2", "level of tank_1")
    True
    """
    water = ""
    if share is not None:
        filled = outline.polygon(x, y, min(max(share, 0.0), 1.0))
        (left, surface), (right, _) = filled[0], filled[-1]
        water = (
            f'<path class="water" d="{_closed(filled)}" fill="{colour}" fill-opacity="0.22"/>'
            f'<path d="M{left:.1f} {surface:.1f}H{right:.1f}" stroke="{colour}"'
            ' stroke-width="2.5"/>'
        )
    wall = outline.polygon(x, y)
    path = _closed(wall) if share is None or not outline.open_above else _closed(wall)[:-1]
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="{_closed(wall)}" fill="#fff"/>{water}'
        f'<path d="{path}" fill="none" stroke="{INK}" stroke-width="2.2"'
        f' stroke-linejoin="round"/></g>'
    )


def _closed(points: Sequence[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + "Z"


def weir(x: float, y: float, side: int, title: str) -> str:
    """Return a spout at the rim over which a vessel spills.

    Examples
    --------
    >>> "<title>weir" in weir(0, 0, 1, "weir of tank_1")
    True
    """
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="M{x - 7 * side:g} {y - 1:g}q{14 * side} -6 {15 * side} 9m{-4 * side} -4'
        f'l{4 * side} 5l{4 * side} -5" fill="none" stroke="{INK}" stroke-width="1.6"/></g>'
    )


def pump(x: float, y: float, way: tuple[int, int], colour: str, title: str) -> str:
    """Return a pump that delivers along (dx, dy): a circle with a triangle.

    Examples
    --------
    >>> pump(0, 0, (0, -1), "#E69F00", "pump_1").count("<circle")
    1
    """
    (dx, dy), half = way, 0.866 * PUMP
    corners = [
        (x - dx * PUMP / 2 + dy * half, y - dy * PUMP / 2 - dx * half),
        (x + dx * PUMP, y + dy * PUMP),
        (x - dx * PUMP / 2 - dy * half, y - dy * PUMP / 2 + dx * half),
    ]
    return (
        f"<g><title>{escape(title)}</title>"
        f'<circle cx="{x:g}" cy="{y:g}" r="{PUMP:g}" fill="#fff" stroke="{INK}"'
        f' stroke-width="1.8"/><path d="{_closed(corners)}" fill="{colour}" stroke="{INK}"'
        f' stroke-width="1.2" stroke-linejoin="round"/></g>'
    )


def valve(x: float, y: float, across: bool, side: int, colour: str, title: str) -> str:
    """Return a control valve: two triangles and an actuator at `side`, or above if `across`.

    Examples
    --------
    >>> valve(0, 0, False, -1, "#E69F00", "valve valve_1").count("Z")
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
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="{stem}" stroke="{INK}" stroke-width="1.5"/>'
        f'<path d="{dome}" fill="#fff" stroke="{INK}" stroke-width="1.5"/>'
        f'<path d="{body}" fill="{colour}" stroke="{INK}" stroke-width="1.3"'
        f' stroke-linejoin="round"/></g>'
    )


def flow(x: float, y: float, colour: str, title: str) -> str:
    """Return a flow that is given from outside: an arrow upward.

    Examples
    --------
    >>> flow(0, 0, "#E69F00", "forced flow rain").count("Z")
    1
    """
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="M{x - 8:g} {y + 6:g}h16l-8 -15Z" fill="{colour}" stroke="{INK}"/></g>'
    )


def box(x: float, y: float, half_width: float, half_height: float, words: str, title: str) -> str:
    """Return a plain box with a word in it, for what has no symbol of its own.

    Examples
    --------
    >>> ">heater</text>" in box(0, 0, 48, 14, "heater", "heater heater_1")
    True
    """
    return (
        f"<g><title>{escape(title)}</title>"
        f'<rect x="{x - half_width:g}" y="{y - half_height:g}" width="{2 * half_width:g}"'
        f' height="{2 * half_height:g}" rx="3" fill="#fff" stroke="{INK}" stroke-width="1.5"/>'
        f"{text(x, y + 4, words, style='small')}</g>"
    )


def channel(x: float, y: float, half_width: float, words: str, title: str) -> str:
    """Return a stretch of channel or pipe in which liquid spends a while.

    Examples
    --------
    >>> ">τ = 60 s</text>" in channel(0, 0, 48, "τ = 60 s", "transport delay channel")
    True
    """
    left, right = x - half_width, x + half_width
    return (
        f"<g><title>{escape(title)}</title>"
        f'<rect x="{left:g}" y="{y - 11:g}" width="{2 * half_width:g}" height="22" fill="#fff"/>'
        f'<rect x="{left:g}" y="{y - 11:g}" width="{2 * half_width:g}" height="22" fill="{MUTED}"'
        f' fill-opacity="0.13"/>'
        f'<path d="M{left:g} {y - 11:g}H{right:g}M{left:g} {y + 11:g}H{right:g}" stroke="{INK}"'
        f' stroke-width="1.8"/>{text(x, y + 4, words, style="small")}</g>'
    )


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
    return (
        f'<g><title>{escape(title)}</title><path d="{"".join(paths)}" fill="#fff"'
        f' stroke="{INK}" stroke-width="1.5" stroke-linejoin="round"/></g>'
    )


def header(x: float, y: float, half_width: float, title: str) -> str:
    """Return a splitter with many ports: a pipe across.

    Examples
    --------
    >>> header(0, 0, 48, "flow splitter splitter_1").count("<rect")
    1
    """
    return (
        f'<g><title>{escape(title)}</title><rect x="{x - half_width:g}" y="{y - 5:g}"'
        f' width="{2 * half_width:g}" height="10" rx="5" fill="#fff" stroke="{INK}"'
        f' stroke-width="1.5"/></g>'
    )


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
    return (
        f'<g><title>{escape(title)}</title><path d="{bars}" stroke="{INK}" stroke-width="1.8"/></g>'
    )


def balloon(x: float, y: float, letters: str, number: int, in_panel: bool, title: str) -> str:
    """Return an instrument: a circle with its letters and loop number.

    The line across the middle says that it stands where the operator is, not in the field.

    Examples
    --------
    >>> ">LIC</text>" in balloon(0, 0, "LIC", 101, in_panel=True, title="controls level_1")
    True
    """
    bar = (
        f'<line x1="{x - BALLOON:g}" y1="{y:g}" x2="{x + BALLOON:g}" y2="{y:g}" stroke="{INK}"'
        f' stroke-width="1.1"/>'
        if in_panel
        else ""
    )
    gap = 1.5 if in_panel else 0.0
    return (
        f"<g><title>{escape(title)}</title>"
        f'<circle cx="{x:g}" cy="{y:g}" r="{BALLOON:g}" fill="#fff" stroke="{INK}"'
        f' stroke-width="1.4"/>{bar}'
        f"{text(x, y - 3.0 - gap, letters, style='tag')}"
        f"{text(x, y + 11.0 + gap, str(number), style='tag')}</g>"
    )


def basin(left: float, right: float, y: float, name: str) -> str:
    """Return a reservoir with its surface at y.

    Examples
    --------
    >>> ">basin</text>" in basin(0, 90, 0, "basin")
    True
    """
    return (
        f"<g><title>{escape(f'reservoir {name}')}</title>"
        f'<rect x="{left:.1f}" y="{y:g}" width="{right - left:.1f}" height="40" fill="{MUTED}"'
        f' fill-opacity="0.13"/>'
        f'<path d="M{left:.1f} {y:g}H{right:.1f}" stroke="{MUTED}" stroke-width="2"/>'
        f'<path d="M{left:.1f} {y - 12:g}V{y + 40:g}H{right:.1f}V{y - 12:g}" fill="none"'
        f' stroke="{INK}" stroke-width="2.2" stroke-linejoin="round"/>'
        f"{text((left + right) / 2, y + 33, name)}</g>"
    )
