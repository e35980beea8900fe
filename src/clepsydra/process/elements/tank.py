"""A tank: a vessel, open or closed, that mixes what flows into it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.declared import part
from clepsydra.process.element import Element
from clepsydra.process.elements.weir import weir_flow
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.hybrid import Switch
from clepsydra.process.lid import LID_CHOICES, LID_KEY, Lid, read_lid
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.reading import VESSEL_KEYS, read_vessel, vessel_checks
from clepsydra.process.vessels.vessel import Vessel, reciprocal
from clepsydra.program.step_law import Symbols

#: Below this share of its capacity the content of a tank does not count as a divisor, so that
#: an empty tank has a concentration of zero and not of 0/0.
_EMPTY = 1e-6


@dataclass(frozen=True)
class Tank(Element):
    """A tank with a free surface: dV/dt = Σ q_in - Σ q_out, d(V C)/dt = Σ (q C)_in - C Σ q_out.

    The balances of an incompressible liquid and of each dissolved component, ideally mixed;
    W. L. Luyben, Process Modeling, Simulation and Control for Chemical Engineers, 1990,
    sections 2.1 and 3.3. In a tank of constant cross-section A the level is integrated,
    A dh/dt = Σ q; in any other the volume is, and the level follows from the shape. A
    concentration is integrated as the amount V C.

    What flows over a rim with a weir (`weir_flow`) is lost.
    Evaporation takes liquid from the surface in proportion to its area, but nothing that is
    dissolved in it.

    Parameters
    ----------
    vessel : Vessel
        Shape and height; the height is the upper end of the range of the level.
    weir : float
        Length b of the crest of the rim [m]; 0 for a tank that does not spill.
    weir_discharge : float
        Discharge coefficient c of the weir [1].
    evaporation : float
        [m³/s per m² of surface]
    lid : Lid or None
        Of a closed tank; None where the level may rise above the rim.
    """

    kind, table, symbol, place = "tank", "tanks", "tank", 2
    receives = gives = True

    vessel: Vessel = part(
        lambda table, key, known: read_vessel(table),
        {**VESSEL_KEYS, LID_KEY: told.choice("what happens when it is full", LID_CHOICES)},
        checks=vessel_checks(),
    )
    weir: float = quantity(
        "m",
        "a length",
        "length of the weir of",
        at_least=0.0,
        absent=0.0,
        remedy="leave it out for a tank that does not spill",
    )
    weir_discharge: float = quantity(
        "1",
        "a discharge coefficient",
        "discharge of the weir of",
        above=0.0,
        at_most=1.0,
        default=0.62,
        needs="weir",
        remedy="leave it out for 0.62",
    )
    evaporation: float = quantity(
        "m/s",
        "a falling speed of the surface",
        "evaporation from",
        at_least=0.0,
        absent=0.0,
        remedy="leave it out where nothing evaporates",
    )
    lid: Lid | None = None

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the tank from its table of a process file."""
        tank = super().read(name, table)
        return replace(tank, lid=read_lid(table, tank.vessel, spills=tank.weir > 0.0))

    @property
    def height(self) -> float:
        """Height of the rim above the floor [m]."""
        return self.vessel.height

    @property
    def level(self) -> str:
        """The name of the state that stands for its volume."""
        return f"{self.name}.level"

    def states(self) -> tuple[Signal, ...]:
        """Return the level and the concentrations; searches begin half-way up."""
        height, shown = self.height, self.display_units.get("height", "")
        words = f"level of {self.name}"
        level = Signal(self.level, "m", shown, 0.0, height, height / 2, description=words)
        dissolved = (
            each.in_element(self.name, each.low, each.high, (each.low + each.high) / 2)
            for each in self.components
        )
        return (level, *dissolved)

    def contents(self) -> tuple[Signal, ...]:
        """Return the level or the volume, and the amounts."""
        level, *_ = self.states()
        capacity = self.vessel.capacity
        volume = Signal(self._volume, "m^3", low=0.0, high=capacity)
        return (
            level if self._by_level else volume,
            *(
                Signal(self._amount(c.name), c.amount_unit, low=0.0, high=capacity * c.high)
                for c in self.components
            ),
        )

    def to_contents(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return V(h) and V C."""
        level = symbols[self.level]
        volume = self.vessel.volume(level, self.vessel.sizes(self.name, symbols))
        first = {self.level: level} if self._by_level else {self._volume: volume}
        return first | {
            self._amount(c.name): symbols[f"{self.name}.{c.name}"] * volume for c in self.components
        }

    def to_states(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return h(V), at most the top of a closed tank, and the amounts over V."""
        sizes = self.vessel.sizes(self.name, symbols)
        if self._by_level:
            level = symbols[self.level]
        else:
            level = self.vessel.level(symbols[self._volume], sizes)
        if self.lid:  # an event is located to rounding, which is no level above the top
            level = ca.fmin(level, self.vessel.rim(sizes))
        if not self.components:
            return {self.level: level}
        volume = self.vessel.volume(level, sizes) if self._by_level else symbols[self._volume]
        inverse = 1 / ca.fmax(volume, _EMPTY * self.vessel.capacity)
        return {self.level: level} | {
            f"{self.name}.{c.name}": symbols[self._amount(c.name)] * inverse
            for c in self.components
        }

    @property
    def spilt(self) -> str:
        """The volume spilt where it has a weir."""
        return f"{self.name}.spilt" if self.weir else ""

    def totals(self) -> tuple[Signal, ...]:
        """Return the volume spilt where it has a weir."""
        if not self.spilt:
            return ()
        return (Signal(self.spilt, "m^3", description=f"volume spilt over {self.name}"),)

    def parameters(self) -> tuple[Signal, ...]:
        """Return the sizes of the vessel, the weir and the evaporation."""
        sizes = [
            self._parameter(each.name, each.unit, each.initial, f"{each.description} of")
            for each in self.vessel.parameters()
        ]
        return (*sizes, *super().parameters())

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return what it spills and what evaporates."""
        level = symbols[self.level]
        lost = []
        if self.weir:
            coefficient, driver = weir_flow(
                level - self.height,
                symbols[f"{self.name}.weir"],
                symbols[f"{self.name}.weir_discharge"],
                symbols["gravity"],
            )
            lost.append(Flow(self.name, "", coefficient, driver, f"{self.name}.weir"))
        if self.evaporation:
            surface = self.vessel.surface(level, self.vessel.sizes(self.name, symbols))
            wet = ca.if_else(level > 0, surface, 0)
            nothing = {component.name: ca.SX(0) for component in self.components}
            rate = symbols[f"{self.name}.evaporation"]
            lost.append(Flow(self.name, "", rate, wet, f"{self.name}.evaporation", fluxes=nothing))
        return tuple(lost)

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return the balances of liquid and components.

        A flow enters the level as coefficient / A · driver: 1/A and the product of the constants
        are computed once a run, so no step divides by the cross-section.
        """
        if self._by_level:
            factor = reciprocal(
                self.vessel.surface(symbols[self.level], self.vessel.sizes(self.name, symbols))
            )
        else:
            factor = ca.SX(1)
        balance = ca.SX(0)
        for flow in received:
            balance += factor * flow.coefficient * flow.driver
        for flow in given:
            balance -= factor * flow.coefficient * flow.driver
        rates = {self.level if self._by_level else self._volume: balance}
        for component in self.components:
            carried = ca.SX(0)
            for sign, flows in ((1, received), (-1, given)):
                for flow in flows:
                    carried += sign * (flow.fluxes or {})[component.name]
            rates[self._amount(component.name)] = carried
        if self.weir:
            rates[self.spilt] = symbols[f"{self.name}.weir.flow"]
        return rates

    def _switches(self) -> tuple[Switch, ...]:
        return (self.lid,) if self.lid else ()

    @property
    def may_refuse(self) -> bool:
        """Whether its inflow stops when it is full."""
        return self.lid is not None and not self.lid.ends

    def refuses(self, symbols: Symbols) -> ca.SX | None:
        """Return the truth that it is full, where inflow then stops."""
        return self.lid.is_full(self.name, symbols) if self.lid and self.may_refuse else None

    def ended(self, symbols: Symbols) -> ca.SX | None:
        """Return the truth that it is full, where the run then ends."""
        return self.lid.is_full(self.name, symbols) if self.lid and self.lid.ends else None

    def stored(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the volume and the amounts."""
        volume = self.vessel.volume(symbols[self.level], self.vessel.sizes(self.name, symbols))
        return {"liquid": volume if self._by_level else symbols[self._volume]} | {
            component.name: symbols[self._amount(component.name)] for component in self.components
        }

    def concentrations(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return what its outlets carry: the concentrations of the mixed content."""
        return {c.name: symbols[f"{self.name}.{c.name}"] for c in self.components}

    @property
    def _by_level(self) -> bool:
        """Whether the level is integrated: in proportion to the volume, and never cut off."""
        return self.vessel.uniform and self.lid is None

    @property
    def _volume(self) -> str:
        return f"{self.name}.volume"

    def _amount(self, component: str) -> str:
        return f"{self.name}.{component}_amount"
