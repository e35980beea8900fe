"""The room that each part of the process drawing takes on a grid, and where pipes meet it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal

from clepsydra.report.drawing.shapes import width

#: Distance of two lines of the grid [px].
PITCH = 16.0
#: Size of letters: of a name in bold, of other words, and of quiet ones [px].
NAME, WORDS, SMALL = 14.0, 13.0, 12.0
#: Half of the width and the height of a tank, in lines of the grid.
TANK_HALF, TANK_ROWS = 4, 7
#: Radius of what is drawn round, and half of the width and of the height of other symbols [px].
RADII = {"instrument": 19.0, "pump": 17.0, "relay": 13.0, "stub": 4.0}
_HALVES = {"valve": (25.0, 14.0), "flow": (8.0, 9.0), "orifice": (9.0, 9.0)}
UP, DOWN, LEFT, RIGHT = (0, -1), (0, 1), (-1, 0), (1, 0)

Point = tuple[int, int]
Kind = Literal["pipe", "signal", "tap"]


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
        Of liquid "in", "out", "side" or "both"; "signal" or "tap", or "line" for either.
    cost : float
        How much longer another way may be before this pin is taken.
    """

    lead: list[Point]
    way: Point
    role: str
    cost: float = 0.0
    used: bool = False

    @property
    def inward(self) -> list[Point]:
        """Points from the free end of the pin to what it belongs to."""
        (x, y), (dx, dy) = self.lead[0], self.way
        return [*self.lead[::-1], (x - dx, y - dy)]

    @property
    def end(self) -> Point:
        """The outermost point."""
        return self.lead[-1]


@dataclass(eq=False)
class Pipe:
    """A pipe or a signal line as its corner points, from source to end.

    Parameters
    ----------
    line : str
        The element that makes the liquid flow, or the junction that it comes from.
    source, end : str
        The elements between which it runs.
    roles : (str, str)
        Of the pins that it joins there.
    kind : {"pipe", "signal", "tap"}
        A tap joins a transmitter to what it measures.
    points : list of (x, y)
        In lines of the grid; none until it is laid.
    arrow : bool
        It ends in an arrow.
    """

    line: str
    source: str
    end: str
    roles: tuple[str, str] = ("", "")
    kind: Kind = "pipe"
    points: list[Point] = field(default_factory=list)
    arrow: bool = False


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

    @property
    def room(self) -> tuple[int, int, int, int]:
        """Left, top, right and bottom of its areas, and of the ends of its pins."""
        lefts, tops, rights, bottoms = zip(
            *self.areas, *((*pin.end, *pin.end) for pin in self.pins), strict=True
        )
        return min(lefts), min(tops), max(rights), max(bottoms)

    @property
    def half(self) -> tuple[float, float]:
        """Half of the width and of the height of its symbol [px]."""
        if self.symbol in RADII:
            return RADII[self.symbol], RADII[self.symbol]
        left, _, right, _ = self.areas[0]
        wide = PITCH * (right - left) / 2
        if self.symbol == "controller":
            return wide - 13.0, RADII["instrument"]
        half = _HALVES.get(self.symbol, (max(wide, 20.0), 13.0))
        return half[::-1] if self.across and self.symbol == "valve" else half

    @property
    def outline(self) -> list[tuple[float, float]]:
        """The corners of its symbol [px], around the middle of the body."""
        wide, tall = self.half
        corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        if self.symbol in RADII:
            corners = [(math.cos(k * math.pi / 24), math.sin(k * math.pi / 24)) for k in range(48)]
        return [(PITCH * self.x + wide * dx, PITCH * self.y + tall * dy) for dx, dy in corners]

    def move(self, distance: int) -> None:
        """Move it sideways."""
        self.renumber(lambda x: x + distance)

    def renumber(self, across: Callable[[int], int], down: Callable[[int], int] = int) -> None:
        """Give the lines of the grid other numbers."""
        self.x, self.y = across(self.x), down(self.y)
        self.areas = [(across(a), down(b), across(c), down(d)) for a, b, c, d in self.areas]
        for pin in self.pins:
            pin.lead = [(across(x), down(y)) for x, y in pin.lead]

    def facing(self, side: int) -> Body:
        """Return it with its words on that side, from where they are on the right."""
        self.side = side
        if side < 0:
            self.renumber(lambda x, twice=2 * self.x: twice - x)  # type: ignore[misc]
            self.areas = [(c, b, a, d) for a, b, c, d in self.areas]
            for pin in self.pins:
                pin.way = (-pin.way[0], pin.way[1])
        return self

    def free(self, role: str, *, taken: bool = False) -> list[Pin]:
        """Return the pins of a role that no pipe has; where all are taken, these if asked."""
        roles = (role, "line" if role in ("signal", "tap") else "both")
        found = [pin for pin in self.pins if pin.role in roles]
        if not found and role in ("signal", "tap"):
            # What has no place for a signal of its own takes it where it takes a pipe.
            found = self.pins
        return [pin for pin in found if not pin.used] or (found if taken else [])


def direction(one: tuple[float, float], other: tuple[float, float]) -> Point:
    """Return the way from a point to another beside, above or below it.

    Examples
    --------
    >>> direction((3, 5), (3, 1))
    (0, -1)
    """
    (x1, y1), (x2, y2) = one, other
    return ((x2 > x1) - (x2 < x1), (y2 > y1) - (y2 < y1))


def lines_of(words: Iterable[str], size: float = WORDS, bold: bool = False) -> int:
    """Return how many lines of the grid the longest of some words is wide.

    Examples
    --------
    >>> lines_of(["pump_1", "3.00 V"])
    4
    """
    return math.ceil(max((width(word, size, bold) for word in words), default=0.0) / PITCH)


def _named(label: tuple[str, ...]) -> int:
    """Return the width of a label whose first line is a name in bold."""
    return max(lines_of(label[:1], NAME, bold=True), lines_of(label[1:]))


def _pins(x: int, y: int, role: str, *ways: tuple[Point, int], cost: float = 0.0) -> list[Pin]:
    """Return pins around a point: each its direction and how many lines long."""
    return [
        Pin([(x + dx * step, y + dy * step) for step in range(1, length + 1)], (dx, dy), role, cost)
        for (dx, dy), length in ways
    ]


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
        pins += [Pin([(wall + way[0], floor - up)], way, "line") for up in range(1, TANK_ROWS)]
    pins += [
        Pin([(x + dx, floor + 1)], DOWN, "side", 3.0 + abs(abs(dx) - 3)) for dx in (-3, -2, 0, 2, 3)
    ]
    area = (x - TANK_HALF, top, x + TANK_HALF, floor)
    return Body(name, "tank", x, top, [area], pins)


def upright_body(
    name: str, symbol: str, y: int, label: tuple[str, ...], side: int, *, both: bool = False
) -> Body:
    """Return a pump, valve, flow or box between tanks that delivers upward, words on one side.

    Parameters
    ----------
    both : bool
        Pipes may come and go at either end, as at a box.

    Examples
    --------
    >>> body = upright_body("pump_1", "pump", 20, ("pump_1", "3.00 V"), side=-1)
    >>> body.areas[1][0], [pin.way for pin in body.free("out")]
    (-7, [(0, -1)])
    """
    half = 3 if symbol == "box" else 1
    words = (half + 1, y - 1, half + 1 + _named(label), y - 1 + max(2, len(label)))
    out, into = ("both", "both") if both or symbol == "box" else ("out", "in")
    pins = _pins(0, y, out, (UP, 2)) + _pins(0, y, into, (DOWN, 2), (LEFT, half + 1))
    # Signals come to the side without words; where liquid comes in there, above or below it.
    pins += _pins(0, y, "signal", (LEFT, half + (2 if symbol == "valve" else 1)))
    for dy in (-1, 1):
        role = "line" if symbol == "pump" else "tap"
        pins += _pins(0, y + dy, role, (LEFT, half + 1), cost=5.0)
    return Body(name, symbol, 0, y, [(-half, y - 1, half, y + 1), words], pins).facing(side)


def level_body(name: str, symbol: str, y: int, label: tuple[str, ...]) -> Body:
    """Return what joins two tanks below their surfaces; words below it.

    Examples
    --------
    >>> level_body("join", "orifice", 10, ("join",)).across
    True
    """
    half = max(1, math.ceil(lines_of(label, SMALL) / 2))
    above = 2 if symbol == "valve" else 1 if symbol == "pump" else 0
    areas = [(-1, y - above, 1, y), (-half, y + 1, half, y + len(label) + 1)]
    pins = _pins(0, y, "both", (LEFT, 2), (RIGHT, 2)) + _pins(0, y, "signal", (UP, above + 1))
    pins += [pin for dx in (-1, 1) for pin in _pins(dx, y, "tap", (UP, above + 1))]
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
    actuator = 2 if symbol == "valve" else half
    top, bottom = y - tall, y + (tall or ends)
    rows = (y - 1, y + max(0, len(label) - 2)) if tall else (y, y + len(label) - 1)
    words = (x + half + 1, rows[0], x + half + 1 + _named(label), rows[1])
    pins = [] if ends else _pins(x, y, "out", (DOWN, 1 + tall))
    pins += _pins(x, y, "signal", (LEFT, actuator + 1))
    pins += _pins(x, bottom, "tap", (LEFT, actuator + 1))
    areas = [(x - actuator, top, x + half, bottom), words]
    return Body(name, symbol, x, y, areas, pins).facing(side)


def splitter_body(name: str, words: str, x: int, y: int, ports: int, side: int) -> Body:
    """Return a splitter: four ports, or a header with as many as needed."""
    label = (x + 1, y + 1, x + 2 + lines_of([words], SMALL), y + 1)
    if ports <= 4:
        pins = _pins(x, y, "both", (UP, 2), (DOWN, 2), (LEFT, 3), (RIGHT, 3))
        areas = [(x - 1, y - 1, x + 1, y + 1), label]
        return Body(name, "splitter", x, y, areas, pins).facing(side)
    half = 2 * ((ports + 1) // 2)
    pins = [
        Pin([(x + dx, y + way[1]), (x + dx, y + 2 * way[1])], way, "both")
        for dx in range(-half, half + 1, 2)
        for way in (UP, DOWN)
    ]
    return Body(name, "header", x, y, [(x - half, y - 1, x + half, y + 1)], pins, side)


def delay_body(name: str, y: int, way_out: int, words: tuple[str, ...], feeds: int) -> Body:
    """Return a stretch of channel: it fills from one end and from above, and gives at the other."""
    half = max(3, math.ceil(lines_of(words, SMALL) / 2), math.ceil(feeds / 2))
    pins = [
        *_pins(0, y, "out", ((way_out, 0), half + 1)),
        *_pins(0, y, "in", ((-way_out, 0), half + 1)),
        *(Pin([(dx, y - 1), (dx, y - 2)], UP, "in", 3.0) for dx in range(1 - half, half)),
    ]
    areas = [(-half, y - 1, half, y + 1), (-half, y + 2, half, y + 2)]
    return Body(name, "delay", 0, y, areas, pins, 0, across=True)


def stub_body(name: str, x: int, y: int, label: tuple[str, ...], side: int, rim: int) -> Body:
    """Return an arrow from outside into a tank, from its words down to the rim."""
    words = math.ceil(lines_of(label, SMALL) / 2)
    # Words stand above the arrow, a little away from the pipes of pumps.
    areas = [(x + 1 - words, y - 2, x + 1 + words, y - 1), (x, y, x, rim)]
    pins = _pins(x, y, "line", (LEFT, 1), (RIGHT, 1))
    pins += _pins(x, y + 1, "line", (LEFT, 1), (RIGHT, 1), cost=2.0)
    return Body(name, "stub", x, y, areas, pins).facing(side)


def instrument_body(name: str, y: int, label: tuple[str, ...]) -> Body:
    """Return the balloon of a transmitter with its words below.

    Examples
    --------
    >>> instrument_body("level_1", 10, ("level_1", "6.20 V")).areas
    [(-2, 9, 2, 13)]
    """
    half = max(2, math.ceil(lines_of(label, SMALL) / 2))
    pins = _pins(0, y, "line", (UP, 2))
    for dy in (0, -1):
        pins += _pins(0, y + dy, "line", (LEFT, half + 1), (RIGHT, half + 1), cost=1.0 - 4.0 * dy)
    return Body(name, "instrument", 0, y, [(-half, y - 1, half, y + 1 + len(label))], pins)


def controller_body(name: str, y: int, label: str, ports: int) -> Body:
    """Return a controller, as wide as its signals need, with its setpoint, if any, above."""
    half, above = 2 + max(0, ports - 8) // 4, 3 if label else 1
    words = max(half, math.ceil(lines_of([label], SMALL) / 2))
    spread = range(1 - half, half) if ports > 4 else range(1)
    pins = [pin for dx in spread for pin in _pins(dx, y, "line", (DOWN, 2))]
    if not label:
        pins += [pin for dx in spread for pin in _pins(dx, y, "line", (UP, 2))]
    for dy in (-1, 0, 1):
        pins += _pins(0, y + dy, "line", (LEFT, half + 1), (RIGHT, half + 1), cost=abs(dy) + 1.0)
    areas = [(-half, y - 1, half, y + 1)]
    areas += [(-words, y - above, words, y - 2)] if label else []
    return Body(name, "controller", 0, y, areas, pins)


def relay_body(name: str, y: int) -> Body:
    """Return a relay that computes something between controllers and actuators."""
    pins = _pins(0, y, "line", (UP, 2), (DOWN, 2), (LEFT, 2), (RIGHT, 2))
    return Body(name, "relay", 0, y, [(-1, y - 1, 1, y + 1)], pins)
