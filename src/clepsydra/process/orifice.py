"""An orifice: the outlet of a tank, without a valve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Connection, Element, Flow
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class Orifice(Element):
    """A free outlet at the floor of a tank: q = c a √(2 g h), and q = 0 for h ≤ 0.

    Torricelli's law for a sharp-edged hole that is small against the tank and flows out into
    the open, De motu aquarum, 1644.

    Parameters
    ----------
    name : str
    source : str
        The tank that it empties.
    destination : str
        The element that the liquid falls into.
    area : float
        Cross-section a [m²].
    discharge : float
        Discharge coefficient c [1].

    Examples
    --------
    >>> outlet = Orifice("outlet_1", "tank_1", "basin", area=0.071e-4)
    >>> symbols = {"outlet_1.area": 0.071e-4, "outlet_1.discharge": 1.0, "gravity": 9.81,
    ...            "tank_1.level": 0.124}
    >>> (flow,) = outlet.flows(symbols, ())
    >>> round(float(flow.coefficient * flow.driver) * 1e6, 4)  # [cm³/s]
    11.0744
    """

    kind: ClassVar[str] = "orifice"
    table: ClassVar[str] = "orifices"
    keys: ClassVar[tuple[str, ...]] = ("source", "destination", "area", "discharge")

    source: str
    destination: str
    area: float
    discharge: float = 1.0

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the orifice from its table of a process file."""
        return cls(
            name,
            source=table.name("source", "the name of a tank"),
            destination=table.name("destination", "the name of a tank or reservoir"),
            area=table.quantity(
                "area", "m^2", "an area", "give the cross-section of the hole", above=0.0
            ),
            discharge=table.quantity(
                "discharge",
                "1",
                "a discharge coefficient",
                "give a number, or leave the key out for 1",
                above=0.0,
                default=1.0,
            ),
            display_units=table.display_units("area"),
        )

    def connections(self) -> tuple[Connection, ...]:
        """Return the tank above and the element below."""
        return (
            Connection(("source",), self.source, "tank"),
            Connection(("destination",), self.destination, "receiver"),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the cross-section and the discharge coefficient."""
        return (
            self._parameter("area", "m^2", self.area, "cross-section of"),
            self._parameter("discharge", "1", self.discharge, "discharge coefficient of"),
        )

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
        """Return q = (c a √(2 g)) · √max(h, 0): one root a step, the other once a run."""
        area, discharge = symbols[f"{self.name}.area"], symbols[f"{self.name}.discharge"]
        coefficient = discharge * area * ca.sqrt(2 * symbols["gravity"])
        driver = ca.sqrt(ca.fmax(symbols[f"{self.source}.level"], 0))
        return (Flow(self.source, self.destination, coefficient, driver),)
