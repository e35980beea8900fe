"""The kinds of element that a process file may contain; a new kind is a new line here."""

from __future__ import annotations

from clepsydra.process.control_valve import ControlValve
from clepsydra.process.element import Element
from clepsydra.process.flow_splitter import FlowSplitter
from clepsydra.process.forced_flow import ForcedFlow
from clepsydra.process.linear_outlet import LinearOutlet
from clepsydra.process.orifice import Orifice
from clepsydra.process.pump import Pump
from clepsydra.process.reservoir import Reservoir
from clepsydra.process.sensor import Sensor
from clepsydra.process.tank import Tank
from clepsydra.process.transport_delay import TransportDelay

#: In the order in which a process lists its elements.
KINDS: tuple[type[Element], ...] = (
    Reservoir,
    Tank,
    Orifice,
    LinearOutlet,
    Pump,
    ControlValve,
    FlowSplitter,
    ForcedFlow,
    TransportDelay,
    Sensor,
)
