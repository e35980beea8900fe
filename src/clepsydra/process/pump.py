"""A pump: a flow in proportion to a voltage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

from clepsydra.base.signal import Signal
from clepsydra.process.element import Connection, Element, Flow
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class Pump(Element):
    """A pump that follows its voltage at once: q = k v.

    K. H. Johansson, The quadruple-tank process, IEEE Transactions on Control Systems
    Technology 8(3), 2000, section II, doi 10.1109/87.845876.

    Parameters
    ----------
    name : str
        Also the name of the manipulated variable, v [V].
    source : str
        The reservoir that it draws from.
    destination : str
        The element that it feeds.
    gain : float
        k [m³/(s V)].
    low, high : float
        Range of the voltage [V].
    nominal : float or None
        Voltage at the operating point [V]; None where the process gives levels instead.

    Examples
    --------
    >>> pump = Pump("pump_1", "basin", "tank_1", gain=3.33e-6, low=0.0, high=10.0, nominal=3.0)
    >>> (flow,) = pump.flows({"pump_1.gain": 3.33e-6, "pump_1": 3.0}, ())
    >>> round(flow.coefficient * flow.driver * 1e6, 4)  # [cm³/s]
    9.99
    """

    kind: ClassVar[str] = "pump"
    table: ClassVar[str] = "pumps"
    keys: ClassVar[tuple[str, ...]] = ("source", "destination", "gain", "range", "nominal")

    source: str
    destination: str
    gain: float
    low: float
    high: float
    nominal: float | None

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the pump from its table of a process file."""
        low, high = table.range("range", "V", at_least=0.0)
        nominal = None
        if table.has("nominal"):
            nominal = table.quantity(
                "nominal",
                "V",
                "a voltage",
                "choose a voltage within the range",
                at_least=low,
                at_most=high,
            )
        return cls(
            name,
            source=table.name("source", "the name of a reservoir"),
            destination=table.name("destination", "the name of a tank or splitter"),
            gain=table.quantity(
                "gain", "m^3/(s V)", "a gain", "give the flow at one volt", above=0.0
            ),
            low=low,
            high=high,
            nominal=nominal,
            display_units=table.display_units("gain", "range"),
        )

    def connections(self) -> tuple[Connection, ...]:
        """Return the reservoir that it draws from and the element that it feeds."""
        return (
            Connection(("source",), self.source, "reservoir"),
            Connection(("destination",), self.destination, "receiver"),
        )

    def inputs(self) -> tuple[Signal, ...]:
        """Return the voltage; without a nominal value it stands in the middle of its range."""
        return (
            Signal(
                self.name,
                "V",
                display_unit=self.display_units.get("range", ""),
                low=self.low,
                high=self.high,
                initial=(self.low + self.high) / 2 if self.nominal is None else self.nominal,
                description=f"voltage of {self.name}",
            ),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the gain."""
        return (self._parameter("gain", "m^3/(s V)", self.gain, "flow per volt of"),)

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
        """Return q = k v."""
        coefficient, voltage = symbols[f"{self.name}.gain"], symbols[self.name]
        return (Flow(self.source, self.destination, coefficient, voltage),)
