"""The process drawing: tanks, pipes, pumps, instruments and the loops that a controller closes."""

from __future__ import annotations

import math

from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report.drawing.bodies import NAME, PITCH, SMALL, WORDS, Body
from clepsydra.report.drawing.lines import Points, draw_basins, draw_lines
from clepsydra.report.drawing.outline import TANK_HEIGHT
from clepsydra.report.drawing.parts import (
    BALLOON,
    PUMP,
    RELAY,
    draw_fitting,
    draw_function,
    draw_instrument,
    draw_vessel,
)
from clepsydra.report.drawing.routing import Pipe
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import DARK_PAPER, PAPER, picture

#: Of the drawing alone: in a page, a style holds for every picture. Words have a rim of paper,
#: so that a line under them does not strike them through.
_STYLE = (
    f".plant text{{font-size:{WORDS:g}px;paint-order:stroke;"
    f"stroke:{PAPER};stroke:light-dark({PAPER},{DARK_PAPER});stroke-width:3px;"
    "stroke-linejoin:round}"
    f".plant text.name{{font-weight:600;font-size:{NAME:g}px}}"
    f".plant text.small{{font-size:{SMALL:g}px}}"
    ".plant text.tag{font-size:11.5px;stroke:none}.plant text.inside{stroke:none}"
)
#: A page narrower than this share of a drawing scrolls sideways, so that words stay readable.
_LEAST_SHARE = 0.58
#: From the middle of a symbol to its edge, sideways and upright [px].
_REACH = {
    "instrument": (BALLOON, BALLOON),
    "controller": (BALLOON, BALLOON),
    "relay": (RELAY, RELAY),
    "pump": (PUMP, PUMP),
    "valve": (25.0, 25.0),
    "flow": (8.0, 9.0),
    "orifice": (9.0, 9.0),
    "stub": (4.0, 4.0),
}


def process_drawing(
    process: Process, point: OperatingPoint | None, controller: Controller | None = None
) -> str:
    """Draw a process with the values of an operating point, as one ``<svg>`` element.

    Tanks stand above those that they drain into, and pumps stand above the reservoir. Tanks have
    the profile of their vessel, and levels are drawn to the scale of their tank. Symbols follow
    ISA-5.1: LT-101 measures a level, LIC-101 controls it; A is a concentration, F a flow, U several
    at once, and signals are dashed. The plant is grey, with a tint for each component of the
    liquid; colour is for what is abnormal. What stands still is hollow, and its pipes are thin.

    Parameters
    ----------
    point : OperatingPoint or None
        None draws the plant without values.
    controller : Controller, optional
        Closes the loops; without one there are transmitters alone.

    Returns
    -------
    str
        SVG that stands alone or inside HTML; it loads nothing.

    References
    ----------
    ANSI/ISA-5.1-2009, Instrumentation symbols and identification; ANSI/ISA-101.01-2015, Human
    machine interfaces for process automation systems.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> process_drawing(plant.process, plant.point).count("LIC-")
    0
    >>> process_drawing(plant.process, plant.point, cl.design.simc(plant)).count("LIC-")
    2
    """
    scene = Scene(process, point, controller)
    placement = scene.routes.placement
    width, height = PITCH * placement.width, PITCH * placement.height
    ways = {pipe: _way(scene, pipe) for pipe in scene.routes.pipes}
    parts = [
        *draw_lines(ways, scene.still),
        *draw_basins(scene.routes, ways, width, scene.tint),
        *(part for name in scene.graph.vessels for part in draw_vessel(scene, name)),
        *(part for body in placement.bodies.values() for part in draw_fitting(scene, body)),
        *(part for entry in scene.graph.instruments for part in draw_instrument(scene, entry)),
        *(part for entry in scene.functions.values() for part in draw_function(scene, entry)),
    ]
    by = "" if controller is None else f", controlled by {controller.title}"
    at = ", at the operating point" if scene.values else ""
    title = f"Process drawing of {process.title}{by}{at}"
    room = f"max-width:{width:.0f}px;min-width:{_LEAST_SHARE * width:.0f}px"
    return picture("plant", (width, height), title, _STYLE, parts, style=room)


def _way(scene: Scene, pipe: Pipe) -> Points:
    """Return a line in px: a pipe up to the shells of vessels, a signal up to the symbols."""
    points = [(PITCH * x, PITCH * y) for x, y in pipe.points]
    bodies = scene.routes.placement.bodies
    for place, inner, end in ((0, 1, pipe.source), (-1, -2, pipe.end)):
        if pipe.kind != "pipe" and end in bodies and end not in scene.outlines:
            points[place] = _edge(bodies[end], points[place], points[inner])
            continue
        for name in scene.outlines:
            points[place] = _shell(scene, name, points[place], points[inner])
    return points


def _edge(body: Body, end: tuple[float, float], inner: tuple[float, float]) -> tuple[float, float]:
    """Return where a signal that ends in a body meets the edge of its symbol."""
    (x, y), (dx, dy) = end, (inner[0] - end[0], inner[1] - end[1])
    across, along = _REACH.get(body.symbol, (0.0, 13.0))
    left, _, right, _ = body.areas[0]
    if body.symbol == "controller":
        across = PITCH * (right - left) / 2 - 32.0 + BALLOON
    elif not across:
        across = max(PITCH * (right - left) / 2, 20.0)
    if body.symbol in ("pump", "instrument"):
        across = math.sqrt(max(across**2 - (y - PITCH * body.y) ** 2, 0.0))
    elif body.symbol != "controller" and y != PITCH * body.y:
        across = 0.0  # it ends at the pipe
    if dy == 0:
        return (PITCH * body.x + math.copysign(across, dx), y)
    return (x, PITCH * body.y + math.copysign(along, dy))


def _shell(
    scene: Scene, vessel: str, end: tuple[float, float], inner: tuple[float, float]
) -> tuple[float, float]:
    """Return where a pipe that ends at a vessel meets its shell."""
    body, outline = scene.routes.placement.bodies[vessel], scene.outlines[vessel]
    (x, y), centre, rim = end, PITCH * body.x, PITCH * body.y
    reach, floor = PITCH * 4, rim + TANK_HEIGHT
    if not (abs(x - centre) <= reach and rim <= y <= floor):
        return end
    if x == inner[0] and y == rim:
        return (x, rim + outline.shell(x - centre, above=True))
    if x == inner[0] and y == floor:
        return (x, rim + outline.shell(x - centre, above=False))
    if y == inner[1]:
        wall = outline.wall(y - rim)
        return (centre + (wall if inner[0] > centre else -wall), y)
    return end
