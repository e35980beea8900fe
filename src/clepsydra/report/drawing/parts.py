"""What stands in the process drawing, after the habits of ISA-5.1: fittings and control."""

from __future__ import annotations

import math

from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.alive import UNKNOWN, alarm_mark, marked, plug_mark, state_mark
from clepsydra.report.drawing.bodies import PITCH, RADII, Body, Point, direction
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import Instrument
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import (
    ALARM,
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
from clepsydra.report.quantities import percent_scale, short_text

#: Where the share of a branch is written, from the middle of its splitter.
_SHARE = {(1, 0): (16, -7), (-1, 0): (-16, -7), (0, -1): (6, -22), (0, 1): (8, 30)}

#: What has a symbol of its own; all else, such as a user's element, is a box.
_OWN_SYMBOLS = ("pump", "valve", "flow", "orifice", "stub")


#: A pump that always runs, where liquid comes into a valve.
_PUMP_BEFORE = circle(0, 24, 8.5, STEEL, width=1.3) + path("M-7.4 28.3L0 15.5L7.4 28.3Z", 1.0, PIPE)


def draw_fitting(scene: Scene, body: Body) -> list[str]:
    """Return the symbol of a body that stands in pipes, and its words; empty for others."""
    x, y, name = PITCH * body.x, PITCH * body.y, body.name
    if body.symbol in ("tank", "instrument", "controller", "relay"):
        return []
    title = scene.title(name)
    if body.symbol in ("splitter", "header"):
        return _splitter(scene, body, x, y)
    half, tall = body.half
    if body.symbol == "delay":
        below = text(x, y + 27, scene.labels[name][0], style="small", colour=MUTED)
        left, right = x - half, x + half
        inside = box((left, right), (y - 11, y + 11), STEEL, "", None)
        banks = path(f"M{left:g} {y - 11:g}H{right:g}M{left:g} {y + 11:g}H{right:g}", 1.8)
        words = text(x, y + 4, scene.delay_time(name), style="small inside")
        return [titled(title, inside, banks, words), below]
    if body.symbol not in _OWN_SYMBOLS:
        words = "" if body.across else scene.elements[name].kind
        shell = box((x - half, x + half), (y - tall, y + tall), rounded=3)
        shape = titled(title, shell, text(x, y + 4, words, style="small inside"))
    else:
        ends = not any(pin.role in ("in", "out", "both") for pin in body.pins)
        symbol = "end" if body.symbol == "flow" and ends else body.symbol
        way = _way(scene, body)
        angle = math.degrees(math.atan2(way[0], -way[1]))
        moved = f"translate({x:g} {y:g})" + (f" rotate({angle:g})" if angle else "")
        of = name if scene.alive else ""
        shapes = [_symbol(symbol, name in scene.still)]
        if scene.elements[name].driven:
            shapes.append(_PUMP_BEFORE)
        if scene.alive and symbol in ("orifice", "valve"):
            shapes.append(plug_mark(name))
        shape = titled(title, *shapes, moved=moved, data_of=of)
    return [shape, *_words(scene, body, x, y)]


def _symbol(symbol: str, still: bool) -> str:
    """Return a symbol around 0 with liquid running up, hollow if it stands still.

    The actuator of a valve is at its right as the liquid runs.
    """
    fill = PAPER if still else PIPE
    halves = path("M-9 -14L9 14H-9L9 -14Z", 1.3, fill)
    shapes = {
        "pump": circle(0, 0, RADII["pump"], PAPER if still else STEEL, width=1.6)
        + path("M-14.7 8.5L0 -17L14.7 8.5Z", 1.2, fill),
        "valve": path("M0 0H16") + path("M16 -9a9 9 0 0 1 0 18Z", fill=PAPER) + halves,
        "flow": path("M-8 6h16l-8 -15Z", 1.0, fill),
        "orifice": path("M-9 -2.5h18M-9 2.5h18", 1.8),
        "end": path("M-6 0h12", 3.0, stroke=PIPE),
        "stub": circle(0, 0, 3.5, fill, width=1.0),
    }
    return shapes[symbol]


def _colour(scene: Scene, words: str) -> str:
    return ALARM if words.startswith("at its ") and not scene.alive else INK


def _way(scene: Scene, body: Body) -> Point:
    """Return where liquid runs through a body: of a pump, along the pipe that leaves it."""
    for pipe in scene.routes.pipes if body.symbol == "pump" else ():
        if pipe.source == body.name != pipe.end and pipe.points[0] == (body.x, body.y):
            return direction(*pipe.points[:2])
    if body.symbol == "valve":
        return (-1, 0) if body.across else (0, body.side)
    return (1, 0) if body.across and body.symbol == "orifice" else (0, -1)


def _words(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    """Return the lines beside a body, or below it where liquid runs through it sideways."""
    lines, told = scene.labels[body.name], _told_beside(scene, body.name)
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
            left, first + step * place, words if what not in UNKNOWN else "", anchor,
            "small" if body.across or quiet or stub else "" if place else "name",
            MUTED if quiet else _colour(scene, words), **_mark(scene, what, body.name),
        )
        for place, (what, words) in enumerate(zip(told, lines, strict=True))
    ]  # fmt: skip


def _mark(scene: Scene, what: str, name: str) -> dict[str, str]:
    """Return by what a page finds a line beside an element."""
    if what != "state":
        return marked(what, name)
    own = scene.process.signal(name)
    return state_mark(name, percent_scale(scene.process, name) if own.shown_unit != "%" else None)


def _told_beside(scene: Scene, name: str) -> list[str]:
    """Return what each line beside an element tells, for a page that moves it; else nothing."""
    told = list(scene.moving(name)) if scene.alive else []
    return [""] * (len(scene.labels[name]) - len(told)) + told


def _splitter(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    junction = scene.graph.junction(body.name)
    shares = dict(zip(junction.targets, junction.shares, strict=True)) if junction else {}
    if any(f"{body.name}.{target}" in scene.hides for target in shares):
        shares = dict.fromkeys(shares)
    told = ", ".join(f"{100 * share:g} %" for share in shares.values() if share is not None)
    title = f"{scene.elements[body.name].kind} {body.name}: {told}"
    label = scene.labels[body.name][0]
    if body.symbol == "header":
        half, _ = body.half
        below = text(x + half + 5, y + 4, label, "start", "small", MUTED)
        return [titled(title, box((x - half, x + half), (y - 5, y + 5), rounded=5)), below]
    anchor = "end" if body.side < 0 else "start"
    parts = [text(x + 17 * body.side, y + 18, label, anchor, "small", MUTED)]
    pipes = [pipe for pipe in scene.routes.pipes if pipe.kind == "pipe"]
    ways = {direction(*pipe.points[:-3:-1]) for pipe in pipes if pipe.end == body.name}
    for pipe in (pipe for pipe in pipes if pipe.source == body.name):
        way, share = direction(*pipe.points[:2]), shares[pipe.end]
        ways.add(way)
        if share is not None:
            dx, dy = _SHARE[way]
            # Beside the words of the splitter, or on the other side of an upright pipe.
            dx = -dx if way == (0, body.side) else dx
            anchor = "start" if dx > 0 else "end"
            of = {"data_share": body.name, "data_to": pipe.end} if scene.alive else {}
            words = f"{short_text(100 * share)} %"
            parts.append(text(x + dx, y + dy, words, anchor, "small", **of))
    # One triangle for each pipe, pointing at the middle.
    corners = (
        [(0, 0), *((12 * dx + 7 * side * dy, 12 * dy + 7 * side * dx) for side in (-1, 1))]
        for dx, dy in sorted(ways)
    )
    valve = path("".join(map(polygon, corners)), fill=PAPER)
    return [titled(title, valve, moved=f"translate({x:g} {y:g})"), *parts]


_QUANTITIES = {"L": "the level", "A": "a concentration", "F": "the flow"}
_RELAYS = {
    "Σ": "sum", "×": "ratio", "<": "lowest of its inputs", ">": "highest of its inputs",
    "÷": "split range",
}  # fmt: skip


def draw_instrument(scene: Scene, instrument: Instrument) -> list[str]:
    """Return a transmitter with its words."""
    name, letter, number = instrument.name, instrument.letter, instrument.number
    body = scene.routes.placement.bodies[name]
    x, y = PITCH * body.x, PITCH * body.y
    quantity = _QUANTITIES.get(letter, "a quantity")
    title = f"{letter}T-{number}: {name} measures {quantity} of {instrument.seat}"
    late = [each.words for each in scene.elements[name].reporting().values()]
    title = ", ".join(filter(None, [title, *late, scene.value(name)]))
    tags = text(x, y - 3, f"{letter}T", style="tag"), text(x, y + 11, number, style="tag")
    of = marked("transmitter", name) if scene.alive else {}
    parts = [titled(title, circle(x, y, RADII["instrument"]), *tags, **of)]
    lines = zip(_told_beside(scene, name), scene.labels[name], strict=True)
    for place, (what, words) in enumerate(lines):
        colour = ALARM if words and words == scene.warning(name) else INK
        of = marked(what, name)
        parts.append(text(x, y + 33 + 15 * place, words, style="small", colour=colour, **of))
    if scene.alive and any(alarm.measurement == name for alarm in scene.process.alarms):
        parts.append(alarm_mark(name, x, y, RADII["instrument"]))
    return parts


def draw_function(scene: Scene, function: ControlFunction) -> list[str]:
    """Return a controller with its setpoint, or a relay."""
    body = scene.routes.placement.bodies[function.name]
    x, y = PITCH * body.x, PITCH * body.y
    if function.sign:
        title = f"{function.name}: {_RELAYS[function.sign]}"
        sign = text(x, y + 5, function.sign, style="tag")
        return [titled(title, circle(x, y, RADII["relay"]), sign)]
    seats = {scene.graph.owner(name): name for name in function.reads}
    number = next(i.number for i in scene.graph.instruments if i.name in seats)
    letters, title = "UIC", f"moves {' and '.join(function.gives)}"
    if function.at:
        own = scene.graph.owner(function.at)
        seat = next(i for i in scene.graph.instruments if i.name == own)
        alike = [name for name, other in scene.functions.items() if other.at == function.at]
        letter = "ABCDEFGH"[alike.index(function.name) % 8] if len(alike) > 1 else ""
        letters, number = f"{seat.letter}IC", f"{seat.number}{letter}"
        setpoint = scene.setpoint(function)
        title = f"controls {function.at}" + (f", setpoint {setpoint}" if setpoint else "")
    half, tall = body.half
    # A circle in a box has a shared display; the line across, that an operator has access to it.
    shapes = (
        box((x - half, x + half), (y - tall, y + tall), width=1.4),
        circle(x, y, tall, "none", width=1.1),
        path(f"M{x - half:g} {y:g}H{x + half:g}", 1.1),
        text(x, y - 4.5, letters, style="tag"),
        text(x, y + 12.5, number, style="tag"),
    )
    found = [titled(f"{letters}-{number}: {title}", *shapes)]
    for words in scene.labels.get(function.name, ()):
        of = marked("setpoint", f"{function.at}.setpoint") if scene.alive else {}
        moves = {"data_moves": " ".join(function.gives)} if scene.alive else {}
        found.append(text(x, y - 25, words, style="small", **of, **moves))
    return found
