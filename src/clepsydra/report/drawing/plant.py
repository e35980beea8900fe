"""The process drawing: tanks, pipes, pumps, instruments and the loops that a controller closes."""

from __future__ import annotations

from collections.abc import Collection
from itertools import pairwise

from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.report.drawing.bodies import NAME, PITCH, SMALL, WORDS, Pipe
from clepsydra.report.drawing.lines import Point, Points, draw_basins, draw_lines
from clepsydra.report.drawing.parts import (
    draw_fitting,
    draw_function,
    draw_instrument,
)
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import DARK_PAPER, PAPER, picture
from clepsydra.report.drawing.vessels import draw_vessel

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


def process_drawing(
    process: Process,
    point: OperatingPoint | None,
    controller: Controller | None = None,
    *,
    alive: str = "",
    hides: Collection[str] = (),
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
    alive : str, optional
        Its name in a page that moves it: what moves tells in `data-` attributes of which signal it
        is, water is clipped by its tank and only needs to be shifted, and nothing stands still.
    hides : collection of str, optional
        Numbers of the process that the drawing does not tell: "pipe.time".

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
    scene = Scene(process, point, controller, alive, frozenset(hides))
    placement = scene.routes.placement
    width, height = PITCH * placement.width, PITCH * placement.height
    ways = _ways(scene)
    parts = [
        *draw_lines(ways, scene.still, alive=bool(alive)),
        *draw_basins(scene.routes, ways, width, scene.tint),
        *(part for name in scene.graph.vessels for part in draw_vessel(scene, name)),
        *(part for body in placement.bodies.values() for part in draw_fitting(scene, body)),
        *(part for entry in scene.graph.instruments for part in draw_instrument(scene, entry)),
        *(part for entry in scene.functions.values() for part in draw_function(scene, entry)),
    ]
    # A page says itself who controls, and its values move.
    by = "" if controller is None or alive else f", controlled by {controller.title}"
    at = ", at the operating point" if scene.values and not alive else ""
    title = f"Process drawing of {process.title}{by}{at}"
    room = f"max-width:{width:.0f}px;min-width:{_LEAST_SHARE * width:.0f}px"
    return picture("plant", (width, height), title, _STYLE, parts, style=room)


def _ways(scene: Scene) -> dict[Pipe, Points]:
    """Return every line in px: a pipe up to the shells of vessels, a signal up to symbols too."""
    bodies = scene.routes.placement.bodies
    shells = [
        outline.polygon(PITCH * bodies[name].x, PITCH * bodies[name].y)
        for name, outline in scene.outlines.items()
    ]
    ways = {}
    for pipe in scene.routes.pipes:
        ways[pipe] = points = [(PITCH * x, PITCH * y) for x, y in pipe.points]
        for place, inner, name in ((0, 1, pipe.source), (-1, -2, pipe.end)):
            symbol = (
                bodies.get(name) if pipe.kind != "pipe" and name not in scene.outlines else None
            )
            for outline in [symbol.outline] if symbol else shells:
                points[place] = _met(outline, points[place], points[inner])
    return ways


def _met(outline: Points, end: Point, inner: Point) -> Point:
    """Return where a line that ends inside an outline meets it; the end of any other line."""
    for ends, place in zip(zip(*outline, strict=True), end, strict=True):
        if not min(ends) <= place <= max(ends):
            return end
    along = int(end[0] == inner[0])
    across, met = end[1 - along], []
    for pair in pairwise([*outline, outline[0]]):
        (low, one), (high, other) = sorted((corner[1 - along], corner[along]) for corner in pair)
        if low <= across <= high and low < high:
            met.append(one + (across - low) / (high - low) * (other - one))
    first = min(met, key=lambda place: abs(place - inner[along]), default=end[along])
    return (end[0], first) if along else (first, end[1])
