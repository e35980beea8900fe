"""The room that each part of the process drawing takes on a grid, and where pipes meet it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

#: Distance of two lines of the grid [px].
PITCH = 16.0
#: Width of a letter, wide fonts included: of a name in bold, and of other words [px].
LETTER, SMALL_LETTER = 9.0, 7.5
#: Half of the width and the height of a tank, in lines of the grid.
TANK_HALF, TANK_ROWS = 4, 7
UP, DOWN, LEFT, RIGHT = (0, -1), (0, 1), (-1, 0), (1, 0)

Point = tuple[int, int]


@dataclass(eq=False)
class Pin:
    """Where a pipe may meet a body: the points from its middle outward.

    Parameters
    ----------
    lead : list of (x, y)
        The last one is where the free way of the pipe begins.
    way : (dx, dy)
        Direction outward.
    role : str
        "in", "out" or "both".
    cost : float
        How much longer another way may be before this pin is taken.

    Examples
    --------
    >>> Pin([(0, -1), (0, -2)], UP, "out").end
    (0, -2)
    """

    lead: list[Point]
    way: Point
    role: str
    cost: float = 0.0
    used: bool = False

    @property
    def end(self) -> Point:
        """The outermost point."""
        return self.lead[-1]


@dataclass(eq=False)
class Body:
    """A part of the drawing: its middle, the rectangles that it fills, and its pins.

    Parameters
    ----------
    name, symbol : str
    x, y : int
        Its middle, in lines of the grid.
    areas : list of (left, top, right, bottom)
        No pipe runs through these.
    pins : list of Pin
    side : {-1, 0, +1}
        Where its words stand: left, below, right.
    across : bool
        Liquid runs through it sideways.

    Examples
    --------
    >>> body = Body("pump_1", "pump", 0, 10, [(-1, 9, 1, 11)])
    >>> body.move(5)
    >>> body.x, body.areas
    (5, [(4, 9, 6, 11)])
    """

    name: str
    symbol: str
    x: int
    y: int
    areas: list[tuple[int, int, int, int]]
    pins: list[Pin] = field(default_factory=list)
    side: int = 1
    across: bool = False

    def move(self, distance: int) -> None:
        """Move it sideways."""
        self.x += distance
        self.areas = [(a + distance, b, c + distance, d) for a, b, c, d in self.areas]
        for pin in self.pins:
            pin.lead = [(x + distance, y) for x, y in pin.lead]

    def free(self, role: str) -> list[Pin]:
        """Return the pins of a role that no pipe has taken."""
        return [pin for pin in self.pins if not pin.used and pin.role in (role, "both")]


def lines_of(words: Iterable[str], letter: float = SMALL_LETTER) -> int:
    """Return how many lines of the grid the longest of some words is wide.

    Examples
    --------
    >>> lines_of(["pump_1", "3.00 V"])
    3
    """
    return math.ceil(letter * max((len(word) for word in words), default=0) / PITCH)


def _pin(x: int, y: int, way: Point, length: int, role: str, cost: float = 0.0) -> Pin:
    lead = [(x + way[0] * step, y + way[1] * step) for step in range(1, length + 1)]
    return Pin(lead, way, role, cost)


def tank_body(name: str, x: int, top: int) -> Body:
    """Return a tank; pipes come in over the rim, and may meet the walls near the floor.

    Examples
    --------
    >>> len([pin for pin in tank_body("tank_1", 10, 5).pins if pin.way == UP])
    7
    """
    floor = top + TANK_ROWS
    pins = [
        Pin([(x + dx, top - 1)], UP, "in", 0.1 * abs(dx)) for dx in range(1 - TANK_HALF, TANK_HALF)
    ]
    for way, wall in ((LEFT, x - TANK_HALF), (RIGHT, x + TANK_HALF)):
        pins += [Pin([(wall + way[0], floor - 1 - up)], way, "side", 2.0 * up) for up in range(4)]
    pins += [
        Pin([(x + dx, floor + 1)], DOWN, "side", 3.0 + abs(abs(dx) - 3)) for dx in (-3, -2, 0, 2, 3)
    ]
    area = (x - TANK_HALF, top, x + TANK_HALF, floor)
    return Body(name, "tank", x, top, [area], pins)


def upright_body(name: str, symbol: str, y: int, label: tuple[str, ...], side: int) -> Body:
    """Return a pump, valve, flow or box between tanks that delivers upward, words on one side.

    Examples
    --------
    >>> body = upright_body("pump_1", "pump", 20, ("pump_1", "3.00 V"), side=-1)
    >>> body.areas[1][0], [pin.way for pin in body.free("out")]
    (-6, [(0, -1)])
    """
    half = 3 if symbol == "box" else 1
    words = lines_of(label, LETTER)
    near = half + 1
    label_area = (
        (near, y - 1, near + words, y + 1) if side > 0 else (-near - words, y - 1, -near, y + 1)
    )
    pins = [
        _pin(0, y, UP, 2, "out"),
        _pin(0, y, DOWN, 2, "in"),
        _pin(0, y, (-side, 0), half + 1, "in"),
    ]
    if symbol == "box":
        pins = [Pin(pin.lead, pin.way, "both") for pin in pins]
    return Body(name, symbol, 0, y, [(-half, y - 1, half, y + 1), label_area], pins, side)


def level_body(name: str, symbol: str, y: int, label: tuple[str, ...]) -> Body:
    """Return what joins two tanks below their surfaces; words below it.

    Examples
    --------
    >>> level_body("join", "orifice", 10, ("join",)).across
    True
    """
    half = max(1, math.ceil(lines_of(label) / 2))
    areas = [(-1, y - 2 if symbol == "valve" else y, 1, y), (-half, y + 1, half, y + len(label))]
    pins = [_pin(0, y, LEFT, 2, "both"), _pin(0, y, RIGHT, 2, "both")]
    return Body(name, symbol, 0, y, areas, pins, 0, across=True)


def falling_body(
    name: str, symbol: str, x: int, floor: int, label: tuple[str, ...], side: int, ends: bool
) -> Body:
    """Return what stands below the floor of a tank; `ends` where it leads out of the plant.

    Examples
    --------
    >>> falling_body("outlet", "orifice", 0, 10, ("outlet",), 1, ends=False).pins[0].end
    (0, 12)
    """
    tall = symbol in ("valve", "box", "pump")
    y = floor + (2 if tall else 1)
    half = {"box": 2, "valve": 1, "pump": 1}.get(symbol, 0)
    words = lines_of(label)
    rows = (y - 1, y + max(0, len(label) - 2)) if tall else (y, y + len(label) - 1)
    left, right = (half + 1, half + 1 + words) if side > 0 else (-half - 1 - words, -half - 1)
    actuator = 2 if symbol == "valve" else half
    areas = [
        (x - (actuator if side > 0 else half), y - 1 if tall else y,
         x + (half if side > 0 else actuator), y + (1 if tall or ends else 0)),
        (x + left, rows[0], x + right, rows[1]),
    ]  # fmt: skip
    pins = [] if ends else [_pin(x, y, DOWN, 2 if tall else 1, "out")]
    return Body(name, symbol, x, y, areas, pins, side)


def splitter_body(name: str, x: int, y: int, ports: int, side: int) -> Body:
    """Return a splitter: four ports, or a header with as many as needed.

    Examples
    --------
    >>> len(splitter_body("splitter_1", 0, 5, 3, 1).pins), len(splitter_body("s", 0, 5, 7, 1).pins)
    (4, 18)
    """
    label = (x + 1, y + 1, x + 2 + lines_of([name[:24]]), y + 1)
    if side < 0:
        label = (2 * x - label[2], y + 1, 2 * x - label[0], y + 1)
    if ports <= 4:
        pins = [_pin(x, y, UP, 2, "both"), _pin(x, y, DOWN, 2, "both"),
                _pin(x, y, LEFT, 3, "both"), _pin(x, y, RIGHT, 3, "both")]  # fmt: skip
        return Body(name, "splitter", x, y, [(x - 1, y - 1, x + 1, y + 1), label], pins, side)
    half = 2 * ((ports + 1) // 2)
    pins = [
        Pin([(x + dx, y + way[1]), (x + dx, y + 2 * way[1])], way, "both")
        for dx in range(-half, half + 1, 2)
        for way in (UP, DOWN)
    ]
    return Body(name, "header", x, y, [(x - half, y - 1, x + half, y + 1)], pins, side)


def delay_body(name: str, y: int, way_out: int, words: tuple[str, ...], feeds: int) -> Body:
    """Return a stretch of channel: it fills from one end and from above, and gives at the other.

    Examples
    --------
    >>> [pin.end for pin in delay_body("channel", 5, 1, ("channel",), feeds=1).free("out")]
    [(4, 5)]
    """
    half = max(3, math.ceil(lines_of(words) / 2), math.ceil(feeds / 2))
    pins = [
        _pin(0, y, (way_out, 0), half + 1, "out"),
        _pin(0, y, (-way_out, 0), half + 1, "in"),
        *(Pin([(dx, y - 1), (dx, y - 2)], UP, "in", 3.0) for dx in range(1 - half, half)),
    ]
    areas = [(-half, y - 1, half, y + 1), (-half, y + 2, half, y + 2)]
    return Body(name, "delay", 0, y, areas, pins, 0, across=True)


def instrument_body(name: str, y: int, reading: str, controlled: bool) -> Body:
    """Return a balloon with its words below, and its controller above.

    Examples
    --------
    >>> instrument_body("level_1", 10, "6.20 V", controlled=True).areas
    [(-3, 4, 3, 13)]
    """
    setpoint = f"SP {reading}" if controlled else ""
    half = max(3, math.ceil(lines_of([name[:14], reading, setpoint]) / 2))
    return Body(name, "instrument", 0, y, [(-half, y - (6 if controlled else 1), half, y + 3)])
