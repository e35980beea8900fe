"""How a controller's ports are wired to the tags of a rig, as docs/plc.md tells it."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.tagged import TaggedLaw
from clepsydra.hil.scanner import Wiring
from clepsydra.loop.faults import APPLIED
from clepsydra.rig.tag import ACKNOWLEDGE, COMMAND, COMMAND_STATUS, HEARTBEAT, Tag, Writer


def wiring_of(ready: Exportable, tags: Iterable[Tag]) -> Wiring:
    """Return how an exported controller is wired to a rig.

    Measurements with what their cards say of them, setpoints, modes and manual values, the
    position of each actuator for tracking, whether an alarm of the plant holds it, and the button
    that acknowledges are read; outputs, status words and the watchdog are written.

    Parameters
    ----------
    ready : Exportable
    tags : iterable of Tag
        Of the rig of its process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.exportable import exportable
    >>> from clepsydra.rig.tags import tags_of
    >>> plant = cl.load("quadruple-tank")
    >>> wiring = wiring_of(exportable(cl.design.simc(plant), plant.point), tags_of(plant.point))
    >>> wiring.reads["level_1.sp"], wiring.reads["pump_1.tracking"], wiring.writes["watchdog"]
    ('level_1.sp', 'pump_1.position', 'controller.heartbeat')
    """
    cells = {tag.cell: tag.name for tag in tags if tag.writer is not Writer.CONTROLLER}
    commands = {tag.cell: tag.name for tag in tags if tag.writer is Writer.CONTROLLER}
    law, named = ready.controller, TaggedLaw(ready.controller, ready.process).name
    reads: dict[str, str] = {}
    for name, wire in law.input_wires.items():
        signal = Signal(wire)
        cell = path(signal.owner, APPLIED) if signal.part == "tracking" else wire
        if name in law.free_inputs:
            # What no signal of the process drives has its own name there: an alarm that holds.
            cell = ACKNOWLEDGE if name == "acknowledge" else name
        if cell in cells:
            reads[named(name)] = cells[cell]
    writes: dict[str, str] = {}
    for name, wire in law.output_wires.items():
        signal = Signal(wire)
        is_status = signal.part == "status"
        cell = path(signal.owner, COMMAND_STATUS) if is_status else path(wire, COMMAND)
        cell = HEARTBEAT if name == "watchdog" else cell
        if cell in commands:
            writes[named(name)] = commands[cell]
    quality = {each.name for each in ready.program.inputs if each.part == "good"}
    return replace(Wiring(reads, writes), quality=frozenset(quality & reads.keys()))


def check_units(ready: Exportable, tags: Collection[Tag]) -> None:
    """Refuse a controller whose ports have other units than the tags that they are wired to.

    Raises
    ------
    InputError
        Its numbers would be taken for something else.
    """
    known, wiring = {tag.name: tag for tag in tags}, wiring_of(ready, tags)
    wires = {**wiring.reads, **wiring.writes}
    for port in (*ready.program.inputs, *ready.program.outputs):
        tag = known.get(wires.get(port.name, ""))
        if tag is not None and port.kind == "real" and port.unit != tag.signal.unit:
            raise InputError(
                f"{ready.controller.title}, {port.name}",
                port.unit,
                f"{tag.signal.unit}, as its tag",
                "give the signals of the controller the units of the process",
            )
