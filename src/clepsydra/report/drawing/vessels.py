"""Vessels of the process drawing: profile, content, and the words in them."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.report.colours import INK
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import NAME, PITCH, SMALL
from clepsydra.report.drawing.lettering import shortened, width, wrapped
from clepsydra.report.drawing.outline import TANK_HEIGHT
from clepsydra.report.drawing.scene import INSIDE, Scene
from clepsydra.report.drawing.shapes import text
from clepsydra.report.drawing.style import ALARM
from clepsydra.report.quantities import percent_text, quantity_text

#: Where the lowest line inside a tank may stand below its rim [px].
_LOWEST = TANK_HEIGHT - 6.0


def draw_vessel(scene: Scene, name: str) -> list[str]:
    """Return a vessel with its level to the scale of its height, and the values of its states.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> draw_vessel(Scene(load_process("quadruple-tank"), None, None), "tank_1")[1].split(">")[1]
    'tank_1</text'
    """
    body, element, outline = (
        scene.routes.placement.bodies[name], scene.elements[name], scene.outlines[name],
    )  # fmt: skip
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
            words += [scene.value(level.name), percent_text(scene.process, level.name, value)]
            words += filter(None, [warning])
            title = (
                f"{name}: level {words[names]} of {quantity_text(level, level.high)},"
                f" {words[names + 1]}"
            )
    surface = TANK_HEIGHT * (1.0 - (share or 0.0))
    others = [signal for signal in states if signal is not level and scene.values]
    others = others[: 2 if level is not None else 4]
    whole = [row for signal in others for row in _in_lines(scene, signal)]
    if _clear_of(surface, len(words) + len(whole))[-1] < _LOWEST:
        words += whole
    else:
        words += [_in_a_line(scene, signal) for signal in others]
    parts = [symbols.tank(x, y, outline, share, scene.tint(name), title)]
    for place, (row, line) in enumerate(zip(_clear_of(surface, len(words)), words, strict=True)):
        style = "name inside" if place < names else "inside" if place == names else "small inside"
        parts.append(text(x, y + row, line, style=style, colour=ALARM if line == warning else INK))
    if getattr(element, "weir", 0.0):
        seats = [i.name for i in scene.graph.instruments if i.seat == name]
        right = not seats or scene.routes.placement.bodies[seats[0]].x > body.x
        side = -1 if right else 1
        parts.append(symbols.weir(x + side * outline.wall(0.0), y, side, f"weir of {name}"))
    return parts


def _in_lines(scene: Scene, signal: Signal) -> list[str]:
    """Return name and value of a state inside a tank, in two lines if one is too narrow."""
    short, value = signal.name.split(".", 1)[1], scene.value(signal.name)
    words = f"{short} {value}"
    fits = width(words, SMALL) <= INSIDE
    return [words] if fits else [shortened(short, INSIDE, SMALL), value]


def _in_a_line(scene: Scene, signal: Signal) -> str:
    value = scene.value(signal.name)
    room = INSIDE - width(f" {value}", SMALL)
    return f"{shortened(signal.name.split('.', 1)[1], room, SMALL)} {value}"


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
