"""A forced flow: a flow whose size is given from outside, whatever the levels are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.concentrations import BringsFromOutside, GivenConcentration, brought
from clepsydra.process.declared import filled, link
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.hybrid import Switch
from clepsydra.process.outside_signal import ranged
from clepsydra.process.suction import Suction, drawing, drawn
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class ForcedFlow(BringsFromOutside):
    """A forced flow: q = d, into a tank from outside, out of a tank, or from one to another.

    Out of an empty tank nothing flows, see `clepsydra.process.suction`.

    Parameters
    ----------
    name : str
        Also the name of its signal, d [m³/s], a disturbance unless the file manipulates it.
    source, destination : str
        Elements; empty for outside the plant, but not both.
    """

    kind, table, symbol, place = "forced flow", "flows", "flow", 8
    tagged = True

    source: str = link("the name of a tank", "source", optional=True)
    destination: str = link("the name of a tank", "receiver", optional=True)
    low: float = ranged("m^3/s", "the flow")
    high: float = filled()
    nominal: float = filled()
    steps: tuple[float, ...] = ()
    suction: Suction | None = drawing()
    given: Mapping[str, GivenConcentration] = brought()

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the flow from its table of a process file."""
        flow = super().read(name, table)
        if not flow.source and not flow.destination:
            remedy = 'write as in destination = "tank_1", or give a source'
            raise table.wrong("destination", "the name of a tank", remedy)
        if flow.source:
            expected = "no concentration, since the liquid comes from an element"
            table.refuse(("concentration",), expected, "remove it, or remove the source")
        return flow

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the flow, and the concentrations that vary."""
        ends = self.low, self.high, self.nominal
        flow = self._signal(self.name, "m^3/s", ends, f"flow of {self.name}")
        return (flow, *super().disturbances())

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes of its load steps by signal."""
        own = {self.name: self.steps} if self.steps else {}
        return own | super().load_steps()

    def _switches(self) -> tuple[Switch, ...]:
        return (self.suction,) if self.suction else ()

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q = d."""
        flow = symbols[self.name]
        if self.suction:
            flow = drawn(self.name, flow, symbols)
        fluxes = None
        if not self.source:
            carried = self.concentrations(symbols)
            fluxes = {name: flow * concentration for name, concentration in carried.items()}
        return (Flow(self.source, self.destination, ca.SX(1), ca.SX(flow), fluxes=fluxes),)
