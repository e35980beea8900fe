"""The kinds of element that a process file may contain; a new kind is a new line here."""

from __future__ import annotations

from clepsydra.process.element import Element
from clepsydra.process.flow_splitter import FlowSplitter
from clepsydra.process.inflow import Inflow
from clepsydra.process.level_sensor import LevelSensor
from clepsydra.process.orifice import Orifice
from clepsydra.process.pump import Pump
from clepsydra.process.reservoir import Reservoir
from clepsydra.process.tank import Tank

#: In the order in which a process lists its elements.
KINDS: tuple[type[Element], ...] = (
    Reservoir,
    Tank,
    Orifice,
    Pump,
    FlowSplitter,
    Inflow,
    LevelSensor,
)
