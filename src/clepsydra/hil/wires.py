"""The wires between a soft PLC and a rig: a bus, what it makes of a value, and how finely."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clepsydra.hil.wire_check import Through, as_it_is
from clepsydra.rig.bus import Bus
from clepsydra.rig.tag import Tag, Writer

if TYPE_CHECKING:
    from clepsydra.rig.doors.modbus.entry import Entry
    from clepsydra.rig.doors.modbus.register_map import RegisterMap
    from clepsydra.rig.doors.opc_ua.client import Access


@dataclass(frozen=True)
class Wires:
    """What lies between a PLC and its plant.

    Parameters
    ----------
    title : str
        "Modbus TCP, counts-27648".
    bus : Bus
        Of the PLC, not open yet; it travels to its process.
    through : callable
        What they make of the value of a tag, in its unit.
    step : callable
        The smallest difference of two values of a tag that they show, in its unit.
    """

    title: str
    bus: Bus
    through: Through
    step: Callable[[Tag], float]


def modbus_wires(register_map: RegisterMap, host: str, port: int, *, timeout: float = 1.0) -> Wires:
    """Return a PLC's way by Modbus TCP to the registers of a rig.

    Parameters
    ----------
    register_map : RegisterMap
        Of the rig's own registers.
    host : str
    port : int
    timeout : float
        A rig that has not answered after so long is silent [s].

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.doors.modbus.encoding import Encoding
    >>> from clepsydra.rig.doors.modbus.register_map import default_map
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> wires = modbus_wires(default_map(tags, Encoding.COUNTS_27648), "127.0.0.1", 5020)
    >>> wires.title, round(wires.step(tags[0]) * 27648, 9)
    ('Modbus TCP, counts-27648', 10.0)
    """
    from clepsydra.rig.doors.modbus.master import ModbusMaster

    def entry(tag: Tag) -> Entry:
        # A master reads a tag where it stands first, and writes it where it can.
        of_plant = tag.writer is Writer.PLANT
        return (register_map.by_tag if of_plant else register_map.written)[tag.name]

    def through(tag: Tag, value: float) -> float:
        found = entry(tag)
        return found.encoding.decode(found.encoding.encode(value, tag), tag)

    def step(tag: Tag) -> float:
        card = entry(tag).encoding.card
        if card is not None:
            return tag.signal.span / (card.high - card.low)
        return _step_of_single(max(abs(tag.signal.low), abs(tag.signal.high)))

    encodings = [
        each.encoding.value for each in register_map.entries if each.tag.signal.kind == "real"
    ]
    title = ", ".join(["Modbus TCP", *dict.fromkeys(encodings)])
    return Wires(title, ModbusMaster(register_map, host, port, timeout=timeout), through, step)


def opc_ua_wires(access: Access, tags: tuple[Tag, ...]) -> Wires:
    """Return a PLC's way by OPC UA to the nodes of a rig, which are numbers in double precision.

    Parameters
    ----------
    access : Access
        Of the PLC; `clepsydra.rig.doors.opc_ua.client.access_to_rig` makes it.
    tags : tuple of Tag
    """
    from clepsydra.rig.doors.opc_ua.client import OpcUaBus
    from clepsydra.rig.doors.opc_ua.node_map import nodes_of_rig

    bus = OpcUaBus(access, nodes_of_rig(tags))
    return Wires(f"OPC UA, {access.policy}", bus, as_it_is, lambda tag: 0.0)


def _step_of_single(value: float) -> float:
    """Return the distance of a number of single precision to the next larger one."""
    if not math.isfinite(value):
        return 0.0
    (bits,) = struct.unpack("<I", struct.pack("<f", value))
    smaller, larger = struct.unpack("<ff", struct.pack("<II", bits, bits + 1))
    return float(larger - smaller)
