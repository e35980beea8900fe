"""Vessels of the process drawing: outline, what is in them, and their words."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.report.colours import INK
from clepsydra.report.drawing.alive import aim_mark, marked, state_mark, vessel_marks
from clepsydra.report.drawing.bodies import NAME, PITCH, SMALL
from clepsydra.report.drawing.outline import TANK_HEIGHT, TANK_WIDTH
from clepsydra.report.drawing.scene import INSIDE, Scene
from clepsydra.report.drawing.shapes import (
    ALARM,
    PAPER,
    PIPE,
    box,
    element,
    path,
    polygon,
    shortened,
    text,
    titled,
    width,
    wrapped,
)
from clepsydra.report.quantities import percent_scale, percent_text, quantity_text, sensor_scale

#: Where the lowest line inside a tank may stand below its rim [px].
_LOWEST = TANK_HEIGHT - 6.0


@dataclass(frozen=True)
class _Row:
    """A line inside a vessel, and what of it a page writes anew."""

    words: str
    style: str = "small inside"
    what: str = ""
    signal: str = ""
    #: What stands before the value.
    before: str = ""
    colour: str = INK


def draw_vessel(scene: Scene, name: str) -> list[str]:
    """Return a vessel with its level to the scale of its height, and the values of its states."""
    body, vessel = scene.routes.placement.bodies[name], scene.elements[name]
    x, y = PITCH * body.x, PITCH * body.y
    states = scene.states(name)
    level = next((signal for signal in states if signal.name == f"{name}.level"), None)
    rows = [_Row(words, "name inside") for words in wrapped(name, INSIDE, NAME, bold=True)]
    title, share = f"{vessel.kind} {name}", None
    if level is not None:
        share, title = 0.5, f"{name}: {vessel.kind}"
        if scene.values:
            value = scene.values[level.name]
            share = (value - level.low) / level.span
            told, title = _level_rows(scene, name, level, share)
            rows += told
    # A page moves the surface: its words stand where it is as if there were none.
    surface = TANK_HEIGHT * (1.0 - (share or 0.0)) if not scene.alive else -TANK_HEIGHT
    others = [signal for signal in states if signal is not level and scene.values]
    others = others[: 2 if level is not None else 4]
    whole, tight = (
        [row for signal in others for row in _told(scene, signal, short=short)]
        for short in (False, True)
    )
    fits = _clear_of(surface, len(rows) + len(whole))[-1] < _LOWEST
    rows += whole if fits else tight
    outline = scene.outlines[name]
    wall = outline.polygon(x, y)
    shapes = [path(polygon(wall), 0.0, PAPER, "none")]
    if share is not None:
        shapes += _moving_water(scene, name) if scene.alive else _water(scene, name, share)
    shut = share is None or not outline.open_above
    rim = path(polygon(wall, closed=shut), 2.0)
    parts = [titled(title, *shapes, rim, kind="vessel")]
    for down, row in zip(_clear_of(surface, len(rows)), rows, strict=True):
        parts.append(_written(scene, row, x, y + down))
    side = _free_side(scene, name)
    if getattr(vessel, "weir", 0.0):
        edge = wall[0][0] if side < 0 else wall[-1][0]
        moved = f"translate({edge:g} {y:g}) scale({side} 1)"
        spout = path("M-7 -1q14 -6 15 9m-4 -4l4 5l4 -5", 1.6)
        parts.append(titled(f"weir of {name}", spout, moved=moved))
    if scene.alive and level is not None:
        pipes = [pipe for pipe in scene.routes.pipes if pipe.end == name and pipe.arrow]
        entries = [PITCH * pipe.points[-1][0] for pipe in pipes]
        parts += vessel_marks(name, x, y, entries, side)
        parts += _aims(scene, level, x + side * TANK_WIDTH / 2, y, side)
    return parts


def _free_side(scene: Scene, name: str) -> int:
    """Return the side of a vessel at which no instrument stands."""
    bodies = scene.routes.placement.bodies
    seats = [i.name for i in scene.graph.instruments if i.seat == name]
    return -1 if not seats or bodies[seats[0]].x > bodies[name].x else 1


def _level_rows(scene: Scene, name: str, level: Signal, share: float) -> tuple[list[_Row], str]:
    """Return the lines that tell a level, and the same for who does not see it."""
    value = scene.values[level.name]
    warning = "full" if share >= 1.0 else "empty" if share <= 0.0 else ""
    shown, percent = scene.value(level.name), percent_text(scene.process, level.name, value)
    rows = [_Row(shown, "inside", "value", level.name)]
    rows.append(_Row(percent, what="state", signal=level.name))
    if warning and not scene.alive:
        rows.append(_Row(warning, colour=ALARM))
    return rows, f"{name}: level {shown} of {quantity_text(level, level.high)}, {percent}"


def _written(scene: Scene, row: _Row, x: float, y: float) -> str:
    """Return a line inside a vessel; of what a page writes, with what it is."""
    of: dict[str, str] = {}
    if scene.alive:
        of = marked(row.what, row.signal) | ({"data_before": row.before} if row.before else {})
        if row.what == "state":
            of = state_mark(row.signal, percent_scale(scene.process, row.signal))
    return text(x, y, row.before + row.words, style=row.style, colour=row.colour, **of)


def _aims(scene: Scene, level: Signal, x: float, y: float, side: int) -> list[str]:
    """Return a pointer for the setpoint of a level; none where its reading is no straight line."""
    process = scene.process
    aims = []
    for name in process.controlled:
        if process.measured_state.get(name) == level.name and process.signal(name).unit != "m^3":
            scale = sensor_scale(process, name)
            ends = tuple(scale.offset + scale.gain * end for end in (level.low, level.high))
            aims.append(aim_mark(name, x, y, side, (ends[0], ends[1])))
    return aims[:1]


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


def _told(scene: Scene, signal: Signal, *, short: bool) -> list[_Row]:
    """Return name and value of a state inside a tank, shortened or in two lines if too long."""
    name, value = signal.name.split(".", 1)[1], scene.value(signal.name)
    beside = width(f" {value}", SMALL)
    if not short and width(name, SMALL) + beside > INSIDE:
        return [
            _Row(shortened(name, INSIDE, SMALL)),
            _Row(value, what="value", signal=signal.name),
        ]
    before = f"{shortened(name, INSIDE - beside, SMALL)} "
    return [_Row(value, what="value", signal=signal.name, before=before)]


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
