"""Symbols of the process drawing, after the habits of ISA-5.1, as SVG text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from clepsydra.report.colours import INK
from clepsydra.report.drawing.outline import Outline
from clepsydra.report.drawing.style import PAPER, PIPE, STEEL

BALLOON, PUMP, RELAY = 19.0, 17.0, 13.0

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
    water = ""
    if share is not None:
        filled = outline.polygon(x, y, min(max(share, 0.0), 1.0))
        (left, surface), (right, _) = filled[0], filled[-1]
        water = (
            f'<path class="water" d="{_closed(filled)}" fill="{tint}"/>'
            f'<path d="M{left:.1f} {surface:.1f}H{right:.1f}" stroke="{PIPE}" stroke-width="1.5"/>'
        )
    wall = outline.polygon(x, y)
    path = _closed(wall) if share is None or not outline.open_above else _closed(wall)[:-1]
    return (
        f'<g class="vessel"><title>{escape(title)}</title>'
        f'<path d="{_closed(wall)}" fill="{PAPER}"/>{water}'
        f'<path d="{path}" fill="none" stroke="{INK}" stroke-width="2"'
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
    return (
        f"<g><title>{escape(title)}</title>"
        f'<circle cx="{x:g}" cy="{y:g}" r="{PUMP:g}" fill="{PAPER if stopped else STEEL}"'
        f' stroke="{INK}" stroke-width="1.6"/><path d="{_closed(corners)}"'
        f' fill="{PAPER if stopped else PIPE}" stroke="{INK}"'
        f' stroke-width="1.2" stroke-linejoin="round"/></g>'
    )


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
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="{stem}" stroke="{INK}" stroke-width="1.5"/>'
        f'<path d="{dome}" fill="{PAPER}" stroke="{INK}" stroke-width="1.5"/>'
        f'<path d="{body}" fill="{PAPER if shut else PIPE}" stroke="{INK}" stroke-width="1.3"'
        f' stroke-linejoin="round"/></g>'
    )


def flow(x: float, y: float, title: str) -> str:
    """Return a flow that is given from outside: an arrow upward.

    Examples
    --------
    >>> flow(0, 0, "forced flow rain").count("Z")
    1
    """
    return (
        f"<g><title>{escape(title)}</title>"
        f'<path d="M{x - 8:g} {y + 6:g}h16l-8 -15Z" fill="{PIPE}" stroke="{INK}"/></g>'
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
        f' height="{2 * half_height:g}" rx="3" fill="{PAPER}" stroke="{INK}" stroke-width="1.5"/>'
        f"{text(x, y + 4, words, style='small inside')}</g>"
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
        f'<rect x="{left:g}" y="{y - 11:g}" width="{2 * half_width:g}" height="22" fill="{PAPER}"/>'
        f'<rect x="{left:g}" y="{y - 11:g}" width="{2 * half_width:g}" height="22" fill="{STEEL}"/>'
        f'<path d="M{left:g} {y - 11:g}H{right:g}M{left:g} {y + 11:g}H{right:g}" stroke="{INK}"'
        f' stroke-width="1.8"/>{text(x, y + 4, words, style="small inside")}</g>'
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
        f'<g><title>{escape(title)}</title><path d="{"".join(paths)}" fill="{PAPER}"'
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
        f' width="{2 * half_width:g}" height="10" rx="5" fill="{PAPER}" stroke="{INK}"'
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


def balloon(x: float, y: float, letters: str, number: str, title: str) -> str:
    """Return an instrument in the field: a circle with its letters and loop number.

    Examples
    --------
    >>> ">LT</text>" in balloon(0, 0, "LT", "101", "level_1")
    True
    """
    return (
        f"<g><title>{escape(title)}</title>"
        f'<circle cx="{x:g}" cy="{y:g}" r="{BALLOON:g}" fill="{PAPER}" stroke="{INK}"'
        f' stroke-width="1.4"/>'
        f"{text(x, y - 3, letters, style='tag')}{text(x, y + 11, number, style='tag')}</g>"
    )


def controller(x: float, y: float, half_width: float, words: Sequence[str], title: str) -> str:
    """Return a function of a control system with shared display: a circle in a box.

    The line across says that an operator has access to it.

    Examples
    --------
    >>> ">LIC</text>" in controller(0, 0, BALLOON, ("LIC", "101"), "controls level_1")
    True
    """
    letters, number = words
    return (
        f"<g><title>{escape(title)}</title>"
        f'<rect x="{x - half_width:g}" y="{y - BALLOON:g}" width="{2 * half_width:g}"'
        f' height="{2 * BALLOON:g}" fill="{PAPER}" stroke="{INK}" stroke-width="1.4"/>'
        f'<circle cx="{x:g}" cy="{y:g}" r="{BALLOON:g}" fill="none" stroke="{INK}"'
        f' stroke-width="1.1"/><path d="M{x - half_width:g} {y:g}H{x + half_width:g}"'
        f' stroke="{INK}" stroke-width="1.1"/>'
        f"{text(x, y - 4.5, letters, style='tag')}{text(x, y + 12.5, number, style='tag')}</g>"
    )


def relay(x: float, y: float, sign: str, title: str) -> str:
    """Return what computes one signal from others: a small circle with a sign in it.

    Examples
    --------
    >>> ">Σ</text>" in relay(0, 0, "Σ", "feedforward")
    True
    """
    return (
        f'<g><title>{escape(title)}</title><circle cx="{x:g}" cy="{y:g}" r="{RELAY:g}"'
        f' fill="{PAPER}" stroke="{INK}" stroke-width="1.4"/>'
        f"{text(x, y + 5, sign, style='tag')}</g>"
    )


def basin(left: float, right: float, y: float, name: str, tint: str) -> str:
    """Return a reservoir with its surface at y.

    Examples
    --------
    >>> ">basin</text>" in basin(0, 90, 0, "basin", "#d3e2ee")
    True
    """
    return (
        f'<g class="basin"><title>{escape(f"reservoir {name}")}</title>'
        f'<rect x="{left:.1f}" y="{y:g}" width="{right - left:.1f}" height="40" fill="{tint}"/>'
        f'<path d="M{left:.1f} {y:g}H{right:.1f}" stroke="{PIPE}" stroke-width="1.5"/>'
        f'<path d="M{left:.1f} {y - 12:g}V{y + 40:g}H{right:.1f}V{y - 12:g}" fill="none"'
        f' stroke="{INK}" stroke-width="2" stroke-linejoin="round"/>'
        f"{text((left + right) / 2, y + 26, name, style='inside')}</g>"
    )
