"""A level sensor: what the controller sees of a tank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Connection, Element
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class LevelSensor(Element):
    """A sensor in proportion to the level, y = k_c h, or of the level itself, y = h.

    K. H. Johansson, The quadruple-tank process, IEEE Transactions on Control Systems
    Technology 8(3), 2000, section II, doi 10.1109/87.845876.

    Parameters
    ----------
    name : str
        Also the name of the measurement, y [V] with a gain and [m] without.
    tank : str
        The tank whose level it shows.
    low, high : float
        Range of the measurement [V] or [m], 0 % and 100 %.
    gain : float or None
        k_c [V/m]; None for a sensor that shows the level itself.

    Examples
    --------
    >>> sensor = LevelSensor("level_1", "tank_1", low=0.0, high=10.0, gain=50.0)
    >>> readings = sensor.readings({"level_1.gain": 50.0, "tank_1.level": 0.124})
    >>> round(readings["level_1"], 6)  # [V]
    6.2
    """

    kind: ClassVar[str] = "level sensor"
    table: ClassVar[str] = "sensors"
    keys: ClassVar[tuple[str, ...]] = ("tank", "gain", "range")

    tank: str
    low: float
    high: float
    gain: float | None = None

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the sensor from its table of a process file."""
        gain = None
        if table.has("gain"):
            gain = table.quantity(
                "gain", "V/m", "a gain", "give the volts that a metre of level makes", above=0.0
            )
        low, high = table.range("range", "m" if gain is None else "V")
        return cls(
            name,
            tank=table.name("tank", "the name of a tank"),
            low=low,
            high=high,
            gain=gain,
            display_units=table.display_units("gain", "range"),
        )

    @property
    def unit(self) -> str:
        """SI unit of the measurement."""
        return "m" if self.gain is None else "V"

    def to_level(self, value: float) -> float:
        """Return the level [m] that the sensor shows as `value` [V or m]."""
        return value if self.gain is None else value / self.gain

    def connections(self) -> tuple[Connection, ...]:
        """Return the tank."""
        return (Connection(("tank",), self.tank, "tank", carries_flow=False),)

    def measurements(self) -> tuple[Signal, ...]:
        """Return the measurement."""
        return (
            Signal(
                self.name,
                self.unit,
                display_unit=self.display_units.get("range", ""),
                low=self.low,
                high=self.high,
                description=f"measured level of {self.tank}",
            ),
        )

    def measured_states(self) -> dict[str, str]:
        """Return the level that the measurement shows."""
        return {self.name: f"{self.tank}.level"}

    def parameters(self) -> tuple[Signal, ...]:
        """Return the gain where it has one."""
        if self.gain is None:
            return ()
        return (self._parameter("gain", "V/m", self.gain, "volts per level of"),)

    def readings(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return y = k_c h, or y = h."""
        level = symbols[f"{self.tank}.level"]
        if self.gain is None:
            return {self.name: level}
        return {self.name: symbols[f"{self.name}.gain"] * level}
