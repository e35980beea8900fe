"""What stands in the pipes of the process drawing: pumps, valves, splitters, delays, flows."""

from __future__ import annotations

from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import PITCH, Body, direction
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import text
from clepsydra.report.drawing.style import ALARM
from clepsydra.report.quantities import short_text

#: Where the share of a branch is written, from the middle of its splitter.
_SHARE = {(1, 0): (16, -7), (-1, 0): (-16, -7), (0, -1): (6, -22), (0, 1): (8, 30)}

#: What has a symbol of its own; all else, such as a user's element, is a box.
_OWN_SYMBOLS = ("pump", "valve", "flow", "orifice", "stub")


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
    if body.symbol in ("splitter", "header"):
        return _splitter(scene, body, x, y)
    half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
    if body.symbol == "delay":
        below = text(x, y + 27, scene.labels[name][0], style="small", colour=MUTED)
        return [symbols.channel(x, y, half, scene.delay_time(name), title), below]
    if body.symbol not in _OWN_SYMBOLS:
        words = "" if body.across else scene.elements[name].kind
        shape = symbols.plain(x, y, max(half, 20.0), words, title)
    else:
        ends = not any(pin.role in ("in", "out", "both") for pin in body.pins)
        symbol = "end" if body.symbol == "flow" and ends else body.symbol
        shape = symbols.fitting(symbol, x, y, _way(scene, body), name in scene.still, title)
    return [shape, *_words(scene, body, x, y)]


def _colour(scene: Scene, words: str) -> str:
    return ALARM if words.startswith("at its ") else INK


def _way(scene: Scene, body: Body) -> symbols.Way:
    """Return where liquid runs through a body: of a pump, along the pipe that leaves it."""
    for pipe in scene.routes.pipes if body.symbol == "pump" else ():
        if pipe.source == body.name != pipe.end and pipe.points[0] == (body.x, body.y):
            return direction(*pipe.points[:2])
    if body.symbol == "valve":
        return (-1, 0) if body.across else (0, body.side)
    return (1, 0) if body.across and body.symbol == "orifice" else (0, -1)


def _words(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    """Return the lines beside a body, or below it where liquid runs through it sideways."""
    lines = scene.labels[body.name]
    quiet, stub = body.symbol == "orifice", body.symbol == "stub"
    area = body.areas[1] if len(body.areas) > 1 else body.areas[0]
    anchor = "middle" if body.across or stub else "end" if body.side < 0 else "start"
    near = PITCH * (area[2] if body.side < 0 else area[0])
    if stub:
        left, first, step = x + PITCH * body.side, y - 8 - 14 * (len(lines) - 1), 14
    elif body.across:
        left, first, step = x, y + 26, 16
    elif quiet:
        left, first, step = near - 2 * body.side, y + 4, 14
    else:
        first = y + 8 if area[1] == body.y else y + 4 if len(lines) == 1 else y - 10
        left, step = near - 8 * body.side, 17
    return [
        text(
            left, first + step * place, words, anchor,
            "small" if body.across or quiet or stub else "" if place else "name",
            MUTED if quiet else _colour(scene, words),
        )
        for place, words in enumerate(lines)
    ]  # fmt: skip


def _splitter(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    junction = scene.graph.junction(body.name)
    shares = {} if junction is None else {name: share for share, name in junction.branches}
    ways, parts = set(), []
    for pipe in scene.routes.pipes:
        for place, inner in ((0, 1), (-1, -2)):
            here, there = pipe.points[place], pipe.points[inner]
            if here != (body.x, body.y):
                continue
            way = direction(here, there)
            ways.add(way)
            share = shares.get(pipe.end)
            if place == 0 and pipe.line == body.name and share is not None:
                dx, dy = _SHARE[way]
                # Beside the words of the splitter, or on the other side of an upright pipe.
                dx = -dx if way == (0, body.side) else dx
                words = f"{short_text(100 * share)} %"
                parts.append(text(x + dx, y + dy, words, "start" if dx > 0 else "end", "small"))
    words = ", ".join(f"{100 * share:g} %" for share in shares.values() if share is not None)
    title = f"{scene.elements[body.name].kind} {body.name}: {words}"
    label = scene.labels[body.name][0]
    if body.symbol == "header":
        half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
        below = text(x + half + 5, y + 4, label, "start", "small", MUTED)
        return [symbols.header(x, y, half, title), below]
    anchor = "end" if body.side < 0 else "start"
    below = text(x + 17 * body.side, y + 18, label, anchor, "small", MUTED)
    return [symbols.splitter(x, y, ways, title), below, *parts]
