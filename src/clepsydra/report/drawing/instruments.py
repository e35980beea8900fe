"""Transmitters and the functions of a controller, after ISA-5.1."""

from __future__ import annotations

from clepsydra.report.colours import INK
from clepsydra.report.drawing import symbols
from clepsydra.report.drawing.bodies import PITCH
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import Instrument
from clepsydra.report.drawing.scene import Scene
from clepsydra.report.drawing.shapes import text
from clepsydra.report.drawing.style import ALARM

_QUANTITIES = {"L": "the level", "A": "a concentration", "F": "the flow"}
_RELAYS = {
    "Σ": "sum", "×": "ratio", "<": "lowest of its inputs", ">": "highest of its inputs",
    "÷": "split range",
}  # fmt: skip


def draw_instrument(scene: Scene, instrument: Instrument) -> list[str]:
    """Return a transmitter with its words.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> scene = Scene(load_process("quadruple-tank"), None, None)
    >>> draw_instrument(scene, scene.graph.instruments[0])[-1].split(">")[1]
    'level_1</text'
    """
    body, name, letter = (
        scene.routes.placement.bodies[instrument.name], instrument.name, instrument.letter,
    )  # fmt: skip
    x, y = PITCH * body.x, PITCH * body.y
    quantity = _QUANTITIES.get(letter, "a quantity")
    title = f"{letter}T-{instrument.number}: {name} measures {quantity} of {instrument.seat}"
    reading = scene.value(name)
    title = f"{title}, {reading}" if reading else title
    parts = [symbols.balloon(x, y, f"{letter}T", instrument.number, title)]
    for place, words in enumerate(scene.labels[name]):
        colour = ALARM if words and words == scene.warning(name) else INK
        parts.append(text(x, y + 33 + 15 * place, words, style="small", colour=colour))
    return parts


def draw_function(scene: Scene, function: ControlFunction) -> list[str]:
    """Return a controller with its setpoint, or a relay.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> scene = Scene(plant.process, None, cl.design.simc(plant))
    >>> "LIC-101: controls level_1" in draw_function(scene, scene.functions["loop level_1"])[0]
    True
    """
    body = scene.routes.placement.bodies[function.name]
    x, y = PITCH * body.x, PITCH * body.y
    if function.sign:
        return [symbols.relay(x, y, function.sign, f"{function.name}: {_RELAYS[function.sign]}")]
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
    left, _, right, _ = body.areas[0]
    half = PITCH * (right - left) / 2 - 32.0 + symbols.BALLOON
    found = [symbols.controller(x, y, half, letters, number, f"{letters}-{number}: {title}")]
    for words in scene.labels.get(function.name, ()):
        found.append(text(x, y - 25, words, style="small"))
    return found
