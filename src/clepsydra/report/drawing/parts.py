"""What stands in the process drawing, after the habits of ISA-5.1: vessels, fittings, control."""

from __future__ import annotations

import math

from clepsydra.base.signal import Signal
from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.bodies import NAME, PITCH, RADII, SMALL, Body, Point, direction
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import Instrument
from clepsydra.report.drawing.outline import TANK_HEIGHT, TANK_WIDTH
from clepsydra.report.drawing.scene import INSIDE, Scene
from clepsydra.report.drawing.shapes import (
    ALARM,
    PAPER,
    PIPE,
    STEEL,
    box,
    circle,
    element,
    path,
    polygon,
    shortened,
    text,
    titled,
    width,
    wrapped,
)
from clepsydra.report.quantities import percent_text, quantity_text, short_text

#: Where the share of a branch is written, from the middle of its splitter.
_SHARE = {(1, 0): (16, -7), (-1, 0): (-16, -7), (0, -1): (6, -22), (0, 1): (8, 30)}

#: What has a symbol of its own; all else, such as a user's element, is a box.
_OWN_SYMBOLS = ("pump", "valve", "flow", "orifice", "stub")


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
        shape = titled(title, _symbol(symbol, name in scene.still), moved=moved, data_of=of)
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
    return ALARM if words.startswith("at its ") else INK


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
            MUTED if quiet else _colour(scene, words), **_marks(scene, body.name, place),
        )
        for place, words in enumerate(lines)
    ]  # fmt: skip


def _marks(scene: Scene, name: str, place: int) -> dict[str, str]:
    """Return of which signal a line beside an element is, for a page that moves it."""
    told = place - len(scene.labels[name]) + len(scene.readings(name))
    if not scene.alive or told < 0:
        return {}
    return {"data_percent" if told else "data_value": name}


def _splitter(scene: Scene, body: Body, x: float, y: float) -> list[str]:
    junction = scene.graph.junction(body.name)
    shares = dict(zip(junction.targets, junction.shares, strict=True)) if junction else {}
    words = ", ".join(f"{100 * share:g} %" for share in shares.values() if share is not None)
    title = f"{scene.elements[body.name].kind} {body.name}: {words}"
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
            parts.append(text(x + dx, y + dy, f"{short_text(100 * share)} %", anchor, "small"))
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
    title = ", ".join(filter(None, [title, scene.value(name)]))
    tags = text(x, y - 3, f"{letter}T", style="tag"), text(x, y + 11, number, style="tag")
    parts = [titled(title, circle(x, y, RADII["instrument"]), *tags)]
    for place, words in enumerate(scene.labels[name]):
        colour = ALARM if words and words == scene.warning(name) else INK
        of = _marks(scene, name, place)
        parts.append(text(x, y + 33 + 15 * place, words, style="small", colour=colour, **of))
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
        of = f"{function.at}.setpoint" if scene.alive else ""
        found.append(text(x, y - 25, words, style="small", data_setpoint=of))
    return found


#: Where the lowest line inside a tank may stand below its rim [px].
_LOWEST = TANK_HEIGHT - 6.0


def draw_vessel(scene: Scene, name: str) -> list[str]:
    """Return a vessel with its level to the scale of its height, and the values of its states."""
    body, element = scene.routes.placement.bodies[name], scene.elements[name]
    x, y = PITCH * body.x, PITCH * body.y
    states = scene.states(name)
    level = next((signal for signal in states if signal.name == f"{name}.level"), None)
    words, title = wrapped(name, INSIDE, NAME, bold=True), f"{element.kind} {name}"
    share, warning, names = None, "", len(words)
    if level is not None:
        share = 0.5
        title = f"{name}: {element.kind}"
        if scene.values:
            value = scene.values[level.name]
            share = (value - level.low) / level.span
            warning = "full" if share >= 1.0 else "empty" if share <= 0.0 else ""
            shown, percent = scene.value(level.name), percent_text(scene.process, level.name, value)
            words += [shown, percent, *filter(None, [warning])]
            title = f"{name}: level {shown} of {quantity_text(level, level.high)}, {percent}"
    surface = TANK_HEIGHT * (1.0 - (share or 0.0))
    others = [signal for signal in states if signal is not level and scene.values]
    others = others[: 2 if level is not None else 4]
    whole, tight = (
        [row for signal in others for row in _told(scene, signal, short=short)]
        for short in (False, True)
    )
    fits = _clear_of(surface, len(words) + len(whole))[-1] < _LOWEST
    words += whole if fits else tight
    outline = scene.outlines[name]
    wall = outline.polygon(x, y)
    shapes = [path(polygon(wall), 0.0, PAPER, "none")]
    if share is not None:
        shapes += _moving_water(scene, name) if scene.alive else _water(scene, name, share)
    shut = share is None or not outline.open_above
    rim = path(polygon(wall, closed=shut), 2.0)
    parts = [titled(title, *shapes, rim, kind="vessel")]
    for place, (row, line) in enumerate(zip(_clear_of(surface, len(words)), words, strict=True)):
        style = "name inside" if place < names else "inside" if place == names else "small inside"
        of = {}
        if scene.alive and level is not None and names <= place < names + 2:
            of = {"data_value" if place == names else "data_percent": level.name}
        colour = ALARM if line == warning else INK
        parts.append(text(x, y + row, line, style=style, colour=colour, **of))
    if getattr(element, "weir", 0.0):
        seats = [i.name for i in scene.graph.instruments if i.seat == name]
        right = not seats or scene.routes.placement.bodies[seats[0]].x > body.x
        edge, side = (wall[0][0], -1) if right else (wall[-1][0], 1)
        moved = f"translate({edge:g} {y:g}) scale({side} 1)"
        spout = path("M-7 -1q14 -6 15 9m-4 -4l4 5l4 -5", 1.6)
        parts.append(titled(f"weir of {name}", spout, moved=moved))
    return parts


def _water(scene: Scene, name: str, share: float) -> list[str]:
    """Return what is in a vessel up to a share of its height, and its surface."""
    body = scene.routes.placement.bodies[name]
    height = min(max(share, 0.0), 1.0)
    filled = scene.outlines[name].polygon(PITCH * body.x, PITCH * body.y, height)
    return [
        path(polygon(filled), 0.0, scene.tint(name), "none", class_="water"),
        path(polygon([filled[0], filled[-1]], closed=False), stroke=PIPE),
    ]


def _moving_water(scene: Scene, name: str) -> list[str]:
    """Return the same for a page: an empty vessel, whose water rises by a shift upward.

    The page shifts it by the share of `data-height` that is filled.
    """
    body = scene.routes.placement.bodies[name]
    x, floor = PITCH * body.x, PITCH * body.y + TANK_HEIGHT
    left, right = x - TANK_WIDTH / 2, x + TANK_WIDTH / 2
    inside = path(polygon(scene.outlines[name].polygon(x, PITCH * body.y)), 0.0, "none", "none")
    place = f"{scene.alive}-{name}"
    water = element(
        "g",
        box((left, right), (floor, floor + TANK_HEIGHT), scene.tint(name), "", None)
        + path(f"M{left:g} {floor:g}H{right:g}", stroke=PIPE),
        class_="water", data_level=f"{name}.level", data_height=TANK_HEIGHT,
    )  # fmt: skip
    return [
        element("clipPath", inside, id=place),
        element("g", water, clip_path=f"url(#{place})"),
    ]


def _told(scene: Scene, signal: Signal, *, short: bool) -> list[str]:
    """Return name and value of a state inside a tank, shortened or in two lines if too long."""
    name, value = signal.name.split(".", 1)[1], scene.value(signal.name)
    beside = width(f" {value}", SMALL)
    if not short and width(name, SMALL) + beside > INSIDE:
        return [shortened(name, INSIDE, SMALL), value]
    return [f"{shortened(name, INSIDE - beside, SMALL)} {value}"]


def _clear_of(surface: float, count: int) -> list[float]:
    """Return the rows of the words in a tank, below its rim, so that the surface strikes none."""
    rows: list[float] = []
    for first in (46.0, 38.0, 30.0, 22.0, 15.0):
        rows, y = [], first
        for place in range(count):
            if y - 13.0 < surface < y + 5.0:
                y = surface + 16.0
            rows.append(y)
            y += 18.0 if place == 0 else 16.0
        if rows[-1] < _LOWEST:
            return rows
    return rows
