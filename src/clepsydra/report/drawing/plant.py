"""The process drawing: tanks, pipes, pumps and instruments, laid out from the process alone."""

from __future__ import annotations

from html import escape

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import PITCH, Body
from clepsydra.report.drawing.flow_graph import FlowGraph, Instrument, flow_graph
from clepsydra.report.drawing.lines import Points, draw_basins, draw_pipes
from clepsydra.report.drawing.outline import TANK_HEIGHT, Outline, outline_of
from clepsydra.report.drawing.routing import Pipe, Routes, route
from clepsydra.report.quantities import (
    fitted,
    percent_text,
    quantity_text,
    short_text,
    unit_text,
)

#: Of the drawing alone: in a page, a style holds for every picture.
_STYLE = (
    ".plant text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Liberation Sans',"
    "'DejaVu Sans',sans-serif;font-size:13px;paint-order:stroke;stroke:#fff;stroke-width:3px;"
    "stroke-linejoin:round}"
    ".plant text.name{font-weight:600;font-size:14px}.plant text.tag{font-size:11.5px;stroke:none}"
    ".plant text.small{font-size:12px}"
)
#: Letters that the name beside a pump, a flow or a splitter may have, and one in or at a tank.
_LABEL, _NARROW = 24, 14
#: Letters that a line inside a tank may have, and where the lowest may stand below its rim [px].
_INSIDE, _LOWEST = 19, TANK_HEIGHT - 6.0
#: A page narrower than this scrolls sideways, so that words stay readable: least width [px], and
#: least share of the width of the drawing.
_LEAST_WIDTH, _LEAST_SHARE = 560.0, 0.6


def process_drawing(process: Process, point: OperatingPoint | None) -> str:
    """Draw a process with the values of an operating point, as one ``<svg>`` element.

    Tanks stand above those that they drain into, pumps stand above the reservoir, and each pipe
    from a pump has the colour of the pump's signal. Tanks have the profile of their vessel, and
    levels are drawn to the scale of their tank. Symbols follow the habits of ISA-5.1: LT-101
    measures a level, LIC-101 controls it; A is a concentration and F a flow.

    Parameters
    ----------
    process : Process
    point : OperatingPoint or None
        None draws the plant without values.

    Returns
    -------
    str
        SVG that stands alone or inside HTML; it loads nothing.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> process_drawing(process, find_equilibrium(process)).count("LIC-")
    2
    """
    return _Drawing(process, point).text()


class _Drawing:
    def __init__(self, process: Process, point: OperatingPoint | None) -> None:
        self.process = process
        self.values = {} if point is None else point.as_dict()
        self.elements = {element.name: element for element in process.elements}
        self.graph: FlowGraph = flow_graph(process)
        self.outlines = {name: outline_of(self.elements[name]) for name in self.graph.vessels}
        self.signals = signal_colours(process)
        self.labels = {name: self._label(name) for name in self.elements}
        self.routes: Routes = route(self.graph, self.labels, frozenset(process.controlled))
        self.bodies = self.routes.placement.bodies
        self.ways = {pipe: self._way(pipe) for pipe in self.routes.pipes}

    def text(self) -> str:
        """Return the drawing."""
        placement = self.routes.placement
        width, height = PITCH * placement.width, PITCH * placement.height
        parts = [
            *draw_pipes(self.routes.pipes, self.ways, self._line_colours()),
            *draw_basins(self.routes, self.ways, width),
            *(part for name in self.graph.vessels for part in self._vessel(name)),
            *(
                part
                for instrument in self.graph.instruments
                for part in self._instrument(instrument)
            ),
            *(part for body in self.bodies.values() for part in self._fitting(body)),
        ]
        at = ", at the operating point" if self.values else ""
        title = escape(f"Process drawing of {self.process.title}{at}")
        least = max(min(width, _LEAST_WIDTH), _LEAST_SHARE * width)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
            f' class="plant" role="img" style="max-width:{width:.0f}px;min-width:{least:.0f}px">'
            f"<title>{title}</title><style>{_STYLE}</style>" + "\n".join(parts) + "</svg>"
        )

    # Words

    def _value(self, name: str) -> str:
        """Return the value of a signal at the operating point; empty where there is none."""
        if name not in self.values:
            return ""
        return quantity_text(self.process.signal(name), self.values[name])

    def _label(self, name: str) -> tuple[str, ...]:
        """Return the lines written beside an element; of an instrument name and reading."""
        element = self.elements[name]
        if element.symbol == "delay" or element.measurements():
            return (fitted(name, _NARROW), self._value(name))
        lines = [fitted(name, _NARROW if element.symbol == "orifice" else _LABEL)]
        if self._value(name):
            lines.append(self._value(name))
            signal = self.process.signal(name)
            if signal in self.process.inputs and signal.shown_unit != "%":
                lines.append(percent_text(self.process, name, self.values[name], 2))
        return tuple(lines)

    def _title(self, name: str) -> str:
        element = self.elements[name]
        return ", ".join((f"{element.kind} {name}", *self.labels[name][1:]))

    # Pipes

    def _line_colours(self) -> dict[str, str]:
        """Return the colour of each link and junction: its signal's, or that of its tank."""
        colours = {}
        for link in self.graph.links:
            levels = [f"{source}.level" for source in link.sources]
            known = [name for name in (link.name, *levels) if name in self.signals]
            colours[link.name] = self.signals[known[0]] if known else MUTED
        for junction in self.graph.junctions:
            colours[junction.name] = MUTED
        for _ in self.graph.junctions:
            for junction in self.graph.junctions:
                above = {
                    colours[link.name] for link in self.graph.links if junction.name in link.targets
                }
                above |= {
                    colours[other.name]
                    for other in self.graph.junctions
                    if junction.name in [name for _, name in other.branches]
                }
                colours[junction.name] = above.pop() if len(above) == 1 else MUTED
        return colours

    def _way(self, pipe: Pipe) -> Points:
        """Return a pipe in px, drawn out to the shell of the vessels that it meets."""
        points = [(PITCH * x, PITCH * y) for x, y in pipe.points]
        for place, inner in ((0, 1), (-1, -2)):
            for name, outline in self.outlines.items():
                points[place] = self._met(self.bodies[name], outline, points[place], points[inner])
        return points

    def _met(
        self, body: Body, outline: Outline, end: tuple[float, float], inner: tuple[float, float]
    ) -> tuple[float, float]:
        (x, y), centre, rim = end, PITCH * body.x, PITCH * body.y
        reach, floor = PITCH * 4, rim + TANK_HEIGHT
        if not (abs(x - centre) <= reach and rim <= y <= floor):
            return end
        if x == inner[0] and y == rim:
            return (x, rim + max(outline.shell(x - centre, above=True), 3.0))
        if x == inner[0] and y == floor:
            return (x, rim + outline.shell(x - centre, above=False))
        if y == inner[1]:
            wall = outline.wall(y - rim)
            return (centre + (wall if inner[0] > centre else -wall), y)
        return end

    # Vessels

    def _vessel(self, name: str) -> list[str]:
        body, element, outline = self.bodies[name], self.elements[name], self.outlines[name]
        x, y = PITCH * body.x, PITCH * body.y
        own = [signal for signal in self.process.state if signal.name.startswith(f"{name}.")]
        level = next((signal for signal in own if signal.name == f"{name}.level"), None)
        lines, title, share = [], f"{element.kind} {name}", None
        if level is not None:
            share = 0.5
            title = f"{name}: {element.kind}"
            if self.values:
                value = self.values[level.name]
                share = (value - level.low) / level.span
                lines = [self._value(level.name), percent_text(self.process, level.name, value)]
                title = (
                    f"{name}: level {lines[0]} of {quantity_text(level, level.high)}, {lines[1]}"
                )
        lines.insert(0, fitted(name, _NARROW))
        surface = TANK_HEIGHT * (1.0 - (share or 0.0))
        others = [signal for signal in own if signal is not level and self.values]
        others = others[: 2 if level is not None else 4]
        whole = [words for signal in others for words in self._in_lines(signal)]
        if _clear_of(surface, len(lines) + len(whole))[-1] < _LOWEST:
            lines += whole
        else:
            lines += [self._in_a_line(signal) for signal in others]
        colour = self.signals.get(f"{name}.level", MUTED)
        parts = [symbols.tank(x, y, outline, share, colour, title)]
        rows = _clear_of(surface, len(lines))
        styles = ["name", "", *["small"] * len(lines)]
        for row, words, style in zip(rows, lines, styles, strict=False):
            parts.append(symbols.text(x, y + row, words, style=style))
        if getattr(element, "weir", 0.0):
            side = -1 if self._instruments_right(name) else 1
            words = f"weir of {name}"
            parts.append(symbols.weir(x + side * outline.wall(0.0), y, side, words))
        return parts

    def _in_lines(self, signal: Signal) -> list[str]:
        """Return name and value of a state inside a tank, in two lines if one is too narrow."""
        short, value = signal.name.split(".", 1)[1], self._value(signal.name)
        words = f"{short} {value}"
        return [words] if len(words) <= _INSIDE else [fitted(short, _INSIDE), value]

    def _in_a_line(self, signal: Signal) -> str:
        value = self._value(signal.name)
        short = fitted(signal.name.split(".", 1)[1], max(3, _INSIDE - 1 - len(value)))
        return f"{short} {value}"

    def _instruments_right(self, tank: str) -> bool:
        seats = [i.name for i in self.graph.instruments if i.seat == tank]
        return not seats or self.bodies[seats[0]].x > self.bodies[tank].x

    # What stands in pipes

    def _fitting(self, body: Body) -> list[str]:
        x, y, name = PITCH * body.x, PITCH * body.y, body.name
        if body.symbol in ("tank", "instrument"):
            return []
        colour, title = self.signals.get(name, "#fff"), self._title(name)
        if body.symbol == "stub":
            words, value = (*self.labels[name][:2], "")[:2]
            middle = x + 24 * body.side
            parts = [symbols.text(middle, y - 19, fitted(words, _NARROW), style="small")]
            mark = (
                f"<g><title>{escape(title)}</title>"
                f'<circle cx="{x:g}" cy="{y:g}" r="3" fill="{colour}"/></g>'
            )
            return [mark, *parts, symbols.text(middle, y - 5, value, style="small")]
        if body.symbol in ("splitter", "header"):
            return self._splitter(body, x, y)
        if body.symbol == "delay":
            half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
            time = self._delay_time(name)
            name_below = symbols.text(x, y + 27, self.labels[name][0], style="small", colour=MUTED)
            return [symbols.channel(x, y, half, time, f"{title.split(',')[0]}, {time}"), name_below]
        side = body.side or 1
        drawn = {
            "pump": lambda: symbols.pump(x, y, self._delivery(body), colour, title),
            "valve": lambda: symbols.valve(x, y, body.across, -side, colour, title),
            "orifice": lambda: symbols.orifice(x, y, body.across, title),
            "flow": lambda: self._flow(body, x, y, colour, title),
        }
        half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
        words = "" if body.across else fitted(self.elements[name].kind, int(half / 4))
        plain = symbols.box(x, y, max(half, 20.0), 13.0, words, title)
        shape = drawn[body.symbol]() if body.symbol in drawn else plain
        return [shape, *self._words(body, x, y)]

    def _delivery(self, body: Body) -> tuple[int, int]:
        """Return the direction in which a pump delivers: that of the pipe that leaves it."""
        for pipe in self.routes.pipes:
            if pipe.source == body.name != pipe.end and pipe.points[0] == (body.x, body.y):
                (x1, y1), (x2, y2) = pipe.points[:2]
                return ((x2 > x1) - (x2 < x1), (y2 > y1) - (y2 < y1))
        return (0, -1)

    def _flow(self, body: Body, x: float, y: float, colour: str, title: str) -> str:
        if not body.pins:
            return (
                f"<g><title>{escape(title)}</title>"
                f'<path d="M{x - 6:g} {y:g}h12" stroke="{colour}" stroke-width="3"/></g>'
            )
        return symbols.flow(x, y, colour, title)

    def _words(self, body: Body, x: float, y: float) -> list[str]:
        """Return the lines beside a body, or below it where liquid runs through it sideways."""
        lines = self.labels[body.name]
        quiet = body.symbol == "orifice"
        if body.across:
            return [
                symbols.text(
                    x, y + 26 + 16 * place, words, style="small", colour=MUTED if quiet else INK
                )
                for place, words in enumerate(lines)
            ]
        anchor = "end" if body.side < 0 else "start"
        area = body.areas[1] if len(body.areas) > 1 else body.areas[0]
        near = PITCH * (area[2] if body.side < 0 else area[0])
        if quiet:
            return [symbols.text(near - 2 * body.side, y + 4, lines[0], anchor, "small", MUTED)]
        first = y + 4 if len(lines) == 1 else y - 10
        if not body.pins and body.symbol == "flow":
            first = y + 8
        return [
            symbols.text(
                near - 8 * body.side, first + 17 * place, words, anchor, "" if place else "name"
            )
            for place, words in enumerate(lines)
        ]

    def _delay_time(self, name: str) -> str:
        element = self.elements[name]
        time, unit = getattr(element, "time", None), element.display_units.get("time", "s")
        return (
            "" if time is None else f"τ = {short_text(from_si(time, 's', unit))} {unit_text(unit)}"
        )

    def _splitter(self, body: Body, x: float, y: float) -> list[str]:
        junction = self.graph.junction(body.name)
        shares = {} if junction is None else {name: share for share, name in junction.branches}
        ports, parts = set(), []
        for pipe in self.routes.pipes:
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
        title = f"{self.elements[body.name].kind} {body.name}: {words}"
        if body.symbol == "header":
            half = PITCH * (body.areas[0][2] - body.areas[0][0]) / 2
            return [
                symbols.header(x, y, half, title),
                symbols.text(
                    x + half + 5, y + 4, self.labels[body.name][0], "start", "small", MUTED
                ),
            ]
        anchor = "end" if body.side < 0 else "start"
        label = symbols.text(
            x + 17 * body.side, y + 18, self.labels[body.name][0], anchor, "small", MUTED
        )
        return [symbols.splitter(x, y, ports, title), label, *parts]

    # Instruments

    def _instrument(self, instrument: Instrument) -> list[str]:
        body, name, letter = self.bodies[instrument.name], instrument.name, instrument.letter
        x, y = PITCH * body.x, PITCH * body.y
        reading = self._value(name)
        seat = self.bodies.get(instrument.seat)
        parts = []
        if seat is not None:
            side = 1 if x > PITCH * seat.x else -1
            outline = self.outlines.get(seat.name)
            first = PITCH * seat.x + (side * outline.wall(y - PITCH * seat.y) if outline else 0.0)
            begin = y if outline else PITCH * seat.y
            edge = x - side * symbols.BALLOON
            parts.append(
                f'<path d="M{first:g} {begin:g}V{y:g}H{edge:g}" stroke="{INK}"'
                ' stroke-width="1.1" fill="none"/>'
            )
        if name in self.process.controlled:
            above = y - 52.0
            parts.append(
                f'<path d="M{x:g} {y - symbols.BALLOON:g}V{above + symbols.BALLOON:g}"'
                f' stroke="{INK}" stroke-width="1.1" stroke-dasharray="4 3"/>'
            )
            title = f"{letter}IC-{instrument.number}: controls {name}, setpoint {reading}"
            parts.append(symbols.balloon(x, above, f"{letter}IC", instrument.number, True, title))
            if reading:
                parts.append(symbols.text(x, above - 25, f"SP {reading}", style="small"))
        quantity = _QUANTITIES.get(letter, "a quantity")
        title = f"{letter}T-{instrument.number}: {name} measures {quantity} of {instrument.seat}"
        title = f"{title}, {reading}" if reading else title
        parts.append(symbols.balloon(x, y, f"{letter}T", instrument.number, False, title))
        parts.append(symbols.text(x, y + 33, fitted(name, _NARROW), style="small"))
        parts.append(symbols.text(x, y + 48, reading, style="small"))
        return parts


_QUANTITIES = {"L": "the level", "A": "a concentration", "F": "the flow"}
#: Where the share of a branch is written, from the middle of its splitter.
_SHARE = {"right": (16, -7, "start"), "left": (-16, -7, "end"), "up": (6, -17, "start"),
          "down": (8, 30, "start")}  # fmt: skip


def _port(here: tuple[int, int], there: tuple[int, int]) -> str:
    """Return the side of a body on which a pipe leaves it."""
    if here[0] == there[0]:
        return "up" if there[1] < here[1] else "down"
    return "left" if there[0] < here[0] else "right"


def _clear_of(surface: float, lines: int) -> list[float]:
    """Return the rows of the words in a tank, below its rim, so that the surface strikes none."""
    rows: list[float] = []
    for first in (46.0, 38.0, 30.0, 22.0):
        rows, y = [], first
        for place in range(lines):
            if y - 13.0 < surface < y + 5.0:
                y = surface + 16.0
            rows.append(y)
            y += 18.0 if place == 0 else 16.0
        if rows[-1] < _LOWEST:
            return rows
    return rows
