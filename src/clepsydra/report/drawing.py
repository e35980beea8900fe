"""The process drawing: tanks, pipes, pumps and instruments, laid out from the process alone."""

from __future__ import annotations

from html import escape

from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report import symbols
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.flow_graph import FlowGraph, flow_graph
from clepsydra.report.placement import (
    LETTER,
    SENSOR_WIDTH,
    TANK_HEIGHT,
    TANK_WIDTH,
    Placement,
    place,
)
from clepsydra.report.quantities import fitted, number_text, quantity_text, short_text
from clepsydra.report.routing import Pipe, Routes, route

_STYLE = (
    "text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Liberation Sans',"
    "'DejaVu Sans',sans-serif;font-size:13px;paint-order:stroke;stroke:#fff;stroke-width:3px;"
    "stroke-linejoin:round}"
    "text.name{font-weight:600;font-size:14px}text.tag{font-size:11.5px;stroke:none}"
    "text.small{font-size:12px}"
)
_HOP = 6.0
#: Letters that the name beside a pump, an inflow or a splitter may have.
_LABEL = 24
#: A page narrower than this scrolls sideways, so that words stay readable [px].
_LEAST_WIDTH = 560.0


def process_drawing(process: Process, point: OperatingPoint) -> str:
    """Draw a process with the values of an operating point, as one ``<svg>`` element.

    Tanks stand above those that they drain into, pumps stand above the reservoir, and each pipe
    from a pump has the colour of the pump's signal. Levels are drawn to the scale of their tank.
    Symbols follow the habits of ISA-5.1: LT-101 measures a level, LIC-101 controls it.

    Parameters
    ----------
    process : Process
    point : OperatingPoint

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
    graph = flow_graph(process)
    placement = place(graph, _labels(process, point, graph))
    routes = route(placement)
    colours = signal_colours(process)
    values = point.as_dict()
    parts = [
        *_draw_pipes(routes, colours),
        *_draw_basins(placement, routes),
        *_draw_tanks(process, placement, routes, values, colours),
        *_draw_fittings(process, point, graph, placement, routes, colours),
        *_draw_instruments(process, placement, routes, values),
    ]
    height = routes.basin_y + 50.0
    title = escape(f"Process drawing of {process.title}, at the operating point")
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {placement.width:.0f} {height:.0f}"'
        f' role="img" style="max-width:{placement.width:.0f}px;'
        f'min-width:{min(placement.width, _LEAST_WIDTH):.0f}px">'
        f"<title>{title}</title><style>{_STYLE}</style>" + "\n".join(parts) + "</svg>"
    )


def _labels(
    process: Process, point: OperatingPoint, graph: FlowGraph
) -> dict[str, tuple[str, ...]]:
    """Return the lines written beside each pump, inflow and splitter."""
    values = point.as_dict()
    labels: dict[str, tuple[str, ...]] = {
        element.name: (fitted(element.name, _LABEL),) for element in process.elements
    }
    for feed in graph.feeds:
        signal = process.signal(feed.name)
        value = quantity_text(signal, values[feed.name])
        percent = f"{number_text(signal.to_percent(values[feed.name]), 2)} %"
        name = fitted(feed.name, _LABEL)
        labels[feed.name] = (name, value, percent) if feed.pumped else (name, value)
    return labels


def _draw_pipes(routes: Routes, colours: dict[str, str]) -> list[str]:
    parts = []
    for pipe in routes.pipes:
        colour = colours.get(pipe.source, colours.get(f"{pipe.source}.level", MUTED))
        end_x, end_y = pipe.points[-1]
        arrow = f'<path d="M{end_x - 5:g} {end_y - 9:g}h10l-5 9z" fill="{colour}"/>'
        parts.append(
            f'<g><title>{escape(pipe.title)}</title><path d="{_path(pipe, routes.pipes)}"'
            f' fill="none" stroke="{colour}" stroke-width="3" stroke-linejoin="round"/>'
            + (arrow if pipe.points[-2][0] == end_x else "")
            + "</g>"
        )
    return parts


def _path(pipe: Pipe, pipes: list[Pipe]) -> str:
    """Return the path of a pipe, with a small arch where it passes over another's upright."""
    words = [f"M{pipe.points[0][0]:.1f} {pipe.points[0][1]:.1f}"]
    for (x1, y1), (x2, y2) in zip(pipe.points, pipe.points[1:], strict=False):
        if y1 == y2 and x1 != x2:
            sign = 1 if x2 > x1 else -1
            for x in sorted(_crossings(pipe, pipes, x1, x2, y1), reverse=sign < 0):
                words.append(f"H{x - sign * _HOP:.1f}")
                words.append(f"a{_HOP} {_HOP} 0 0 {1 if sign > 0 else 0} {2 * sign * _HOP} 0")
        words.append(f"L{x2:.1f} {y2:.1f}")
    return "".join(words)


def _crossings(pipe: Pipe, pipes: list[Pipe], x1: float, x2: float, y: float) -> set[float]:
    low, high = min(x1, x2) + _HOP, max(x1, x2) - _HOP
    found = set()
    for other in pipes:
        if other.line == pipe.line:
            continue
        for (ax, ay), (bx, by) in zip(other.points, other.points[1:], strict=False):
            if ax == bx and low < ax < high and min(ay, by) < y - 1.0 and max(ay, by) > y + 1.0:
                found.add(ax)
    return found


def _draw_basins(placement: Placement, routes: Routes) -> list[str]:
    """Draw a basin under what uses it; one that is used in places far apart is drawn in parts."""
    groups: list[tuple[str, list[float]]] = []
    for x, name in sorted(routes.basin_uses):
        if groups and groups[-1][0] == name:
            groups[-1][1].append(x)
        else:
            groups.append((name, [x]))
    parts = []
    for index, (name, uses) in enumerate(groups):
        room = 12.0 + LETTER * len(name) / 2
        left, right = min(uses[0] - 34.0, (uses[0] + uses[-1]) / 2 - room), uses[-1] + 34.0
        right = max(right, (uses[0] + uses[-1]) / 2 + room)
        if index:
            left = max(left, (uses[0] + groups[index - 1][1][-1]) / 2 + 4.0)
        if index + 1 < len(groups):
            right = min(right, (uses[-1] + groups[index + 1][1][0]) / 2 - 4.0)
        left, right = max(left, 4.0), min(right, placement.width - 4.0)
        parts.append(symbols.basin(left, right, routes.basin_y, name))
    return parts


def _draw_tanks(
    process: Process,
    placement: Placement,
    routes: Routes,
    values: dict[str, float],
    colours: dict[str, str],
) -> list[str]:
    parts = []
    for name in placement.graph.tanks:
        signal = process.signal(f"{name}.level")
        value, centre, top = values[signal.name], placement.centre[name], routes.tops[name]
        percent = signal.to_percent(value)
        level = quantity_text(signal, value)
        height = quantity_text(signal, signal.high)
        title = f"{name}: level {level}, {number_text(percent)} % of {height}"
        parts.append(
            symbols.tank(centre - TANK_WIDTH / 2, top, percent / 100, colours[signal.name], title)
        )
        first = top + _clear_of(TANK_HEIGHT * (1.0 - percent / 100.0))
        parts.append(symbols.text(centre, first, fitted(name, 14), style="name"))
        parts.append(symbols.text(centre, first + 18, level))
        parts.append(symbols.text(centre, first + 34, f"{number_text(percent)} %", style="small"))
    return parts


def _clear_of(surface: float) -> float:
    """Return where the three lines in a tank start, below its rim, so that no line hits them."""
    if not 30.0 < surface < 88.0:
        return 46.0
    return surface + 18.0 if surface < 59.0 else surface - 42.0


def _draw_fittings(
    process: Process,
    point: OperatingPoint,
    graph: FlowGraph,
    placement: Placement,
    routes: Routes,
    colours: dict[str, str],
) -> list[str]:
    labels = _labels(process, point, graph)
    parts = []
    for outlet, x, y, side in routes.orifices:
        parts.append(symbols.orifice(x, y, f"orifice {outlet.name}"))
        anchor, words = "end" if side < 0 else "start", fitted(outlet.name, 14)
        parts.append(symbols.text(x + 14 * side, y + 4, words, anchor, "small", MUTED))
    for riser in placement.risers:
        if riser.name != riser.feed.name:
            continue
        name, y = riser.name, routes.pump_y
        title = ", ".join((name, *labels[name][1:]))
        if riser.feed.pumped:
            parts.append(
                f'<path d="M{riser.x:g} {y:g}V{routes.basin_y + 16:g}" stroke="{colours[name]}"'
                f' stroke-width="3"/>'
            )
            parts.append(symbols.pump(riser.x, y, colours[name], f"pump {title}"))
        else:
            parts.append(
                f"<g><title>{escape(f'inflow {title}')}</title>"
                f'<path d="M{riser.x - 6:g} {y:g}h12l-6 -11z" fill="{colours[name]}"/></g>'
            )
        anchor = "end" if riser.outward < 0 else "start"
        for line, words in enumerate(labels[name]):
            x = riser.x + riser.outward * (symbols.PUMP + 7)
            style = "" if line else "name"
            parts.append(symbols.text(x, y - 10 + 17 * line, words, anchor, style))
    for feed, x, y in routes.stubs:
        parts.append(symbols.text(x, y - 19, fitted(feed.name, 14), style="small"))
        parts.append(symbols.text(x, y - 5, labels[feed.name][1], style="small"))
    for fitting in routes.fittings:
        shares = ", ".join(f"{100 * share:g} %" for *_, share in fitting.shares)
        title = f"splitter {fitting.split.name}: {shares}"
        parts.append(symbols.splitter(fitting.x, fitting.y, fitting.ports, title))
        anchor = "end" if fitting.outward < 0 else "start"
        x = fitting.x + 17 * fitting.outward
        parts.append(
            symbols.text(x, fitting.y + 14, labels[fitting.split.name][0], anchor, "small", MUTED)
        )
        for x, y, anchor, share in fitting.shares:
            parts.append(symbols.text(x, y, f"{short_text(100 * share)} %", anchor, "small"))
    return parts


def _draw_instruments(
    process: Process, placement: Placement, routes: Routes, values: dict[str, float]
) -> list[str]:
    parts = []
    count: dict[str, int] = {}
    for number, (sensor, tank) in enumerate(placement.graph.sensors, start=101):
        side = placement.sensor_side[tank]
        wall = placement.centre[tank] + side * TANK_WIDTH / 2
        x = wall + side * (50.0 + SENSOR_WIDTH * count.get(tank, 0))
        count[tank] = count.get(tank, 0) + 1
        y = routes.tops[tank] + TANK_HEIGHT - 40.0
        signal = process.signal(sensor)
        reading = quantity_text(signal, values[sensor])
        edge = x - side * symbols.BALLOON
        parts.append(
            f'<path d="M{wall:g} {y:g}H{edge:g}" stroke="{INK}" stroke-width="1.1" fill="none"/>'
        )
        if sensor in process.controlled:
            above = y - 52.0
            parts.append(
                f'<path d="M{x:g} {y - symbols.BALLOON:g}V{above + symbols.BALLOON:g}"'
                f' stroke="{INK}" stroke-width="1.1" stroke-dasharray="4 3"/>'
            )
            title = f"LIC-{number}: controls {sensor}, setpoint {reading}"
            parts.append(symbols.balloon(x, above, "LIC", number, True, title))
            parts.append(symbols.text(x, above - 25, f"SP {reading}", style="small"))
        title = f"LT-{number}: {sensor} measures the level of {tank}, {reading}"
        parts.append(symbols.balloon(x, y, "LT", number, False, title))
        parts.append(symbols.text(x, y + 33, fitted(sensor, 14), style="small"))
        parts.append(symbols.text(x, y + 48, reading, style="small"))
    return parts
