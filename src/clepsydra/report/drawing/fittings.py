"""What stands in the pipes of the process drawing: pumps, valves, splitters, delays, flows."""

from __future__ import annotations

from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import PITCH, Body
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.style import ALARM, PAPER, PIPE
from clepsydra.report.quantities import short_text

#: Where the share of a branch is written, from the middle of its splitter.
_SHARE = {"right": (16, -7, "start"), "left": (-16, -7, "end"), "up": (6, -22, "start"),
          "down": (8, 30, "start")}  # fmt: skip


def draw_fitting(scene: Scene, body: Body) -> list[str]:
    """Return the symbol of a body that stands in pipes, and its words; empty for others.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> scene = Scene(load_process("quadruple-tank"), None, None)
    >>> draw_fitting(scene, scene.routes.placement.bodies["pump_1"])[1].split(">")[1]
    'pump_1</text'
    """
    x, y, name = PITCH * body.x, PITCH * body.y, body.name
    if body.symbol in ("tank", "instrument", "controller", "relay"):
        return []
    title = scene.title(name)
    if body.symbol == "stub":
        return _stub(scene, body, x, y, title)
    if body.symbol in ("splitter", "header"):
        return _splitter(scene, body, x, y)
    half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
    if body.symbol == "delay":
        below = symbols.text(x, y + 27, scene.labels[name][0], style="small", colour=MUTED)
        return [symbols.channel(x, y, half, scene.delay_time(name), title), below]
    side, shut = body.side or 1, name in scene.still
    drawn = {
        "pump": lambda: symbols.pump(x, y, _delivery(scene, body), shut, title),
        "valve": lambda: symbols.valve(x, y, body.across, -side, shut, title),
        "orifice": lambda: symbols.orifice(x, y, body.across, title),
        "flow": lambda: _flow(body, x, y, shut, title),
    }
    words = "" if body.across else scene.elements[name].kind
    plain = symbols.box(x, y, max(half, 20.0), 13.0, words, title)
    return [drawn[body.symbol]() if body.symbol in drawn else plain, *_words(scene, body, x, y)]


def _stub(scene: Scene, body: Body, x: float, y: float, title: str) -> list[str]:
    lines, middle = scene.labels[body.name], x + PITCH * body.side
    fill = PAPER if body.name in scene.still else PIPE
    mark = symbols.titled(title, symbols.circle(x, y, 3.5, fill, 1.0))
    return [mark] + [
        symbols.text(middle, y - 8 - 14 * above, words, style="small", colour=_colour(scene, words))
        for above, words in enumerate(reversed(lines))
    ]


def _colour(scene: Scene, words: str) -> str:
    return ALARM if words.startswith("at its ") else INK


def _delivery(scene: Scene, body: Body) -> tuple[int, int]:
    """Return the direction in which a pump delivers: that of the pipe that leaves it."""
    for pipe in scene.routes.pipes:
        if pipe.source == body.name != pipe.end and pipe.points[0] == (body.x, body.y):
            (x1, y1), (x2, y2) = pipe.points[:2]
            return ((x2 > x1) - (x2 < x1), (y2 > y1) - (y2 < y1))
    return (0, -1)


def _flow(body: Body, x: float, y: float, shut: bool, title: str) -> str:
    if not any(pin.role in ("in", "out", "both") for pin in body.pins):
        return symbols.titled(title, symbols.path(f"M{x - 6:g} {y:g}h12", 3.0, stroke=PIPE))
    return symbols.flow(x, y, shut, title)


def _words(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    """Return the lines beside a body, or below it where liquid runs through it sideways."""
    lines = scene.labels[body.name]
    quiet = body.symbol == "orifice"
    area = body.areas[1] if len(body.areas) > 1 else body.areas[0]
    anchor = "end" if body.side < 0 else "start"
    near = PITCH * (area[2] if body.side < 0 else area[0])
    if body.across:
        left, first, step, anchor = x, y + 26, 16, "middle"
    elif quiet:
        left, first, step = near - 2 * body.side, y + 4, 14
    else:
        first = y + 8 if area[1] == body.y else y + 4 if len(lines) == 1 else y - 10
        left, step = near - 8 * body.side, 17
    return [
        symbols.text(
            left, first + step * place, words, anchor,
            "small" if body.across or quiet else "" if place else "name",
            MUTED if quiet else _colour(scene, words),
        )
        for place, words in enumerate(lines)
    ]  # fmt: skip


def _splitter(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    junction = scene.graph.junction(body.name)
    shares = {} if junction is None else {name: share for share, name in junction.branches}
    ports, parts = set(), []
    for pipe in scene.routes.pipes:
        for place, inner in ((0, 1), (-1, -2)):
            here, there = pipe.points[place], pipe.points[inner]
            if here != (body.x, body.y):
                continue
            port = _port(here, there)
            ports.add(port)
            share = shares.get(pipe.end)
            if place == 0 and pipe.line == body.name and share is not None:
                dx, dy, anchor = _SHARE[port]
                if (port == "up" and body.side < 0) or (port == "down" and body.side > 0):
                    dx, anchor = -dx, {"start": "end", "end": "start"}[anchor]
                words = f"{short_text(100 * share)} %"
                parts.append(symbols.text(x + dx, y + dy, words, anchor, "small"))
    words = ", ".join(f"{100 * share:g} %" for share in shares.values() if share is not None)
    title = f"{scene.elements[body.name].kind} {body.name}: {words}"
    label = scene.labels[body.name][0]
    if body.symbol == "header":
        half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
        return [
            symbols.header(x, y, half, title),
            symbols.text(x + half + 5, y + 4, label, "start", "small", MUTED),
        ]
    anchor = "end" if body.side < 0 else "start"
    below = symbols.text(x + 17 * body.side, y + 18, label, anchor, "small", MUTED)
    return [symbols.splitter(x, y, ports, title), below, *parts]


def _port(here: tuple[int, int], there: tuple[int, int]) -> str:
    """Return the side of a body on which a pipe leaves it."""
    if here[0] == there[0]:
        return "up" if there[1] < here[1] else "down"
    return "left" if there[0] < here[0] else "right"
