"""An outlet of a user's own: a flow out of a tank that depends on its level."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.declared import filled, link, read_fields
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Outlet(Element):
    """A flow q(h) from a tank to whatever is below, with quantities that the file gives.

    A subclass says `kind`, `table`, `quantities` (key to SI unit) and `flow`.

    Parameters
    ----------
    source, destination : str
        The tank, and the element that the liquid runs into.
    values : mapping
        Key to value [SI].

    Examples
    --------
    >>> class Tube(Outlet):
    ...     kind, table, quantities = "tube", "tubes", {"slope": "m^2/s"}
    ...     def flow(self, level, gravity, slope):
    ...         return slope * level
    >>> Tube.keys, Tube("tube_1", "tank_1", "basin", {"slope": 2e-5}).parameters()[0].name
    (('source', 'destination', 'slope'), 'tube_1.slope')
    """

    symbol: ClassVar[str] = "orifice"
    quantities: ClassVar[Mapping[str, str]] = {}

    source: str = link("the name of a tank", "tank")
    destination: str = link("the name of an element", "receiver")
    values: Mapping[str, float] = filled()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.keys = ("source", "destination", *cls.quantities)

    @abstractmethod
    def flow(self, level: ca.SX, gravity: ca.SX, **quantities: ca.SX) -> ca.SX:
        """Return the flow [m³/s] at a level [m], with gravity [m/s²] and the quantities."""

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the outlet from its table of a process file."""
        values = {
            key: table.quantity(key, unit, f"a quantity in {unit}", "give it with its unit")
            for key, unit in cls.quantities.items()
        }
        return cls(
            name,
            **read_fields(cls, table),
            values=values,
            display_units=table.display_units(*values),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the quantities."""
        return tuple(
            self._parameter(key, self.quantities[key], value, f"{key} of")
            for key, value in self.values.items()
        )

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q(h)."""
        quantities = {key: symbols[f"{self.name}.{key}"] for key in self.values}
        level = symbols[f"{self.source}.level"]
        rate = self.flow(level=level, gravity=symbols["gravity"], **quantities)
        return (Flow(self.source, self.destination, ca.SX(1), ca.SX(rate)),)
