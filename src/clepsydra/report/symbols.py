"""Symbols of the process drawing, after the habits of ISA-5.1, as SVG text."""

from __future__ import annotations

from html import escape

from clepsydra.report.colours import INK, MUTED
from clepsydra.report.placement import TANK_HEIGHT, TANK_WIDTH

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


def tank(x: float, y: float, share: float, colour: str, title: str) -> str:
    """Return an open vessel with its rim at y, filled to a share of its height.

    Examples
    --------
    >>> "<title>level of tank_1</title>" in tank(0, 0, 0.6, "#0072B2", "level of tank_1")
    True
    """
    share = min(max(share, 0.0), 1.0)
    surface = y + TANK_HEIGHT * (1.0 - share)
    right, floor = x + TANK_WIDTH, y + TANK_HEIGHT
    return (
        f"<g><title>{escape(title)}</title>"
        f'<rect x="{x:g}" y="{y:g}" width="{TANK_WIDTH:g}" height="{TANK_HEIGHT:g}" fill="#fff"/>'
        f'<rect x="{x:g}" y="{surface:.1f}" width="{TANK_WIDTH:g}"'
        f' height="{floor - surface:.1f}" fill="{colour}" fill-opacity="0.22"/>'
        f'<line x1="{x:g}" y1="{surface:.1f}" x2="{right:g}" y2="{surface:.1f}"'
        f' stroke="{colour}" stroke-width="2.5"/>'
        f'<path d="M{x:g} {y:g}V{floor:g}H{right:g}V{y:g}" fill="none" stroke="{INK}"'
        f' stroke-width="2.2" stroke-linejoin="round"/></g>'
    )


def pump(x: float, y: float, colour: str, title: str) -> str:
    """Return a pump that delivers upward: a circle with a triangle.

    Examples
    --------
    >>> pump(0, 0, "#E69F00", "pump_1").count("<circle")
    1
    """
    half = 0.866 * PUMP
    return (
        f"<g><title>{escape(title)}</title>"
        f'<circle cx="{x:g}" cy="{y:g}" r="{PUMP:g}" fill="#fff" stroke="{INK}"'
        f' stroke-width="1.8"/>'
        f'<path d="M{x - half:.1f} {y + PUMP / 2:.1f}L{x:g} {y - PUMP:g}L{x + half:.1f}'
        f' {y + PUMP / 2:.1f}Z" fill="{colour}" stroke="{INK}" stroke-width="1.2"'
        f' stroke-linejoin="round"/></g>'
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


def orifice(x: float, y: float, title: str) -> str:
    """Return a restriction in a pipe that falls: two short bars.

    Examples
    --------
    >>> orifice(0, 0, "outlet_1").count("h18")
    2
    """
    bars = "".join(f"M{x - 9:g} {y + shift:g}h18" for shift in (-2.5, 2.5))
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
