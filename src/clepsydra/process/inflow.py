"""An inflow: liquid from outside that nobody manipulates, a disturbance."""

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
class Inflow(Element):
    """A forced flow: q = d, whatever the levels are.

    Parameters
    ----------
    name : str
        Also the name of the disturbance, d [m³/s].
    destination : str
        The element that it runs into.
    low, high : float
        Range [m³/s].
    nominal : float
        Value at the operating point [m³/s].
    step : float
        Size of the load step of the default scenario [m³/s].

    Examples
    --------
    >>> rain = Inflow("rain", "tank_1", low=0.0, high=1e-5, nominal=0.0, step=2e-6)
    >>> rain.disturbances()[0].high
    1e-05
    """

    kind: ClassVar[str] = "inflow"
    table: ClassVar[str] = "inflows"
    keys: ClassVar[tuple[str, ...]] = ("destination", "range", "nominal", "step")

    destination: str
    low: float
    high: float
    nominal: float
    step: float

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the inflow from its table of a process file."""
        low, high = table.range("range", "m^3/s")
        nominal = table.quantity(
            "nominal",
            "m^3/s",
            "a flow",
            "choose a flow within the range",
            at_least=low,
            at_most=high,
        )
        step = table.quantity("step", "m^3/s", "a flow", "give the size of a typical load step")
        if not low <= nominal + step <= high:
            raise table.refused(
                "step",
                table.written("step"),
                "a step that stays within the range",
                "make the step smaller or the range wider",
            )
        return cls(
            name,
            destination=table.name("destination", "the name of a tank"),
            low=low,
            high=high,
            nominal=nominal,
            step=step,
            display_units=table.display_units("range"),
        )

    def connections(self) -> tuple[Connection, ...]:
        """Return the element that it runs into."""
        return (Connection(("destination",), self.destination, "receiver"),)

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the flow."""
        return (
            Signal(
                self.name,
                "m^3/s",
                display_unit=self.display_units.get("range", ""),
                low=self.low,
                high=self.high,
                initial=self.nominal,
                description=f"disturbance flow of {self.name}",
            ),
        )

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
        """Return q = d."""
        return (Flow("", self.destination, ca.SX(1), symbols[self.name]),)
