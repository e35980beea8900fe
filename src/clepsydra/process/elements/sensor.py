"""A sensor: what the controller sees of a level, volume, concentration or flow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.component import Component
from clepsydra.process.declared import filled, part
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flows
from clepsydra.process.reporting import Reporting
from clepsydra.process.sensor_reading import (
    CONTENTS,
    gain_unit,
    read_band,
    read_measured,
    read_scale,
    read_share,
)
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import Vessel, reciprocal, vessel_of
from clepsydra.program.step_law import Symbols

#: A signal of 4 to 20 mA goes on to these currents [A] beyond its range, and no further.
NAMUR_LIMITS = (3.8e-3, 20.5e-3)
_UNITS = {"level": "m", "volume": "m^3", "flow": "m^3/s"}


def _scale(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, Any]:
    return read_scale(table, _quantity_unit(known["measured"], table.components))


@dataclass(frozen=True)
class Sensor(Element):
    """A sensor that shows a quantity q as y = q, y = k q, or y = y_low + k (q - q_low).

    For y = k h see K. H. Johansson, IEEE Transactions on Control Systems Technology 8(3), 2000,
    section II, doi 10.1109/87.845876.

    With a lag it shows q_l instead of q, where T dq_l/dt = q - q_l; a flow has no other way to be
    measured, since it may jump. What reaches the controller is y with noise, rounded to the
    resolution and limited to the range. A signal of 4 to 20 mA is limited to 3.8 and 20.5 mA
    (NAMUR NE 43, Standardisation of the signal level for the failure information of digital
    transmitters, 2003). With a dead time it reaches the controller that much later, and with a
    sampling only at every report, between which the last one is held.

    Parameters
    ----------
    low, high : float
        Range of the measurement [`unit`], 0 % and 100 %.
    gain : float or None
        k, per SI unit of q; None for a sensor that shows q itself.
    zero : float or None
        q_low, which it shows as `low`; None where it shows 0 as 0.
    unit : str
        SI unit of the measurement, "V", "A", "1" or that of q; empty for V with a gain and that
        of q without.
    measured : str
        "level" [m], "volume" [m³], "flow" [m³/s], or the name of a component [its unit].
    vessel : Vessel or None
        Shape of the tank, which a volume needs.
    dead_time, sampling, first_report : float
        From a reading to the controller; from one report to the next, 0 for all the time; and of
        the first report after the start of a run [s].
    band : tuple of float or None
        Lowest and highest measurement [`unit`] between which loads may move an averaging level.

    Examples
    --------
    >>> sensor = Sensor("level_1", "tank_1", low=0.0, high=10.0, gain=50.0)
    >>> readings = sensor.readings({"level_1.gain": 50.0, "tank_1.level": 0.124})
    >>> round(readings["level_1"], 6)  # [V]
    6.2
    >>> sensor.displayed({"level_1": ca.SX(10.3)})
    {'level_1': SX(10)}
    """

    kind, table, symbol, place = "sensor", "sensors", "sensor", 10
    tagged = True

    tank: str = part(
        lambda table, key, known: read_measured(table),
        {
            "tank": told.text("the tank whose content it measures"),
            "quantity": told.choice("what of the tank it measures", CONTENTS),
            "component": told.text("the component whose concentration it measures"),
            "flow": told.text("the element whose flow it measures"),
        },
        fills=True,
        checks=({"anyOf": [{"required": ["tank"]}, {"required": ["flow"]}]},),
    )
    low: float = part(
        _scale,
        {
            "gain": told.quantity("what it shows per quantity"),
            "span": told.quantities("quantities that it shows as the ends of its range", 2),
            "range": told.quantities("range of what it shows", 2),
        },
        fills=True,
        required=("range",),
    )
    high: float = filled()
    gain: float | None = None
    zero: float | None = None
    unit: str = ""
    measured: str = "level"
    flow: str = ""
    vessel: Vessel | None = part(
        lambda table, key, known: vessel_of(table, known["tank"]), {"lag": {}}, default=None
    )
    lag: float | None = quantity(
        "s",
        "a time constant",
        "time constant of",
        above=0.0,
        default=None,
        remedy="leave it out for none",
    )
    dead_time: float = quantity(
        "s",
        "a dead time",
        above=0.0,
        default=0.0,
        remedy="leave it out for none",
    )
    sampling: float = quantity(
        "s",
        "the time from one report to the next",
        above=0.0,
        default=0.0,
        remedy="leave it out for a sensor that tells what it reads at any time",
    )
    first_report: float = quantity(
        "s",
        "the time of its first report",
        at_least=0.0,
        default=0.0,
        needs="sampling",
        remedy="leave it out for one at the start",
    )
    noise: float | None = part(
        read_share, default=None, **told.quantity("standard deviation of its noise")
    )
    resolution: float | None = part(
        read_share, default=None, **told.quantity("smallest step that it shows")
    )
    band: tuple[float, float] | None = part(
        read_band,
        default=None,
        **told.quantities("lowest and highest level that an averaging tank keeps under loads", 2),
    )

    def __post_init__(self) -> None:
        if not self.unit:
            object.__setattr__(self, "unit", self.quantity_unit if self.gain is None else "V")

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the sensor from its table of a process file."""
        sensor = super().read(name, table)
        whole = sensor.vessel is None or sensor.vessel.uniform
        if sensor.lag is None and (sensor.flow or (sensor.measured == "volume" and not whole)):
            # Without a lag the measurement must be in proportion to a state.
            raise table.wrong(
                "lag",
                f"the time constant of a sensor of {'flow' if sensor.flow else 'such a volume'}",
                'write as in lag = "0.5 s"' + ("" if sensor.flow else ", or measure the level"),
            )
        if table.has("first_report") and sensor.first_report >= sensor.sampling:
            expected = "a time below that from one report to the next, its sampling"
            raise table.wrong("first_report", expected, "shorten it, or leave it out")
        return sensor

    @property
    def quantity_unit(self) -> str:
        """SI unit of what it measures."""
        return _quantity_unit(self.measured, self.components)

    @property
    def shown_quantity_unit(self) -> str:
        """The unit of what it measures that the reader sees."""
        shown = "" if self.unit != self.quantity_unit else self.display_units.get("range", "")
        return self.display_units.get("span", shown) or self.quantity_unit

    @property
    def quantity(self) -> str:
        """The signal that it measures: "tank_1.level", "tank_1.salt", "pump_1.flow"."""
        return f"{self.flow}.flow" if self.flow else f"{self.tank}.{self.measured}"

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the largest value of what it measures [SI]: infinite for a flow."""
        if self.measured in _UNITS:
            if self.vessel is None:
                return -math.inf, math.inf
            return 0.0, self.vessel.height if self.measured == "level" else self.vessel.capacity
        component = next(each for each in self.components if each.name == self.measured)
        return component.low, component.high

    def to_quantity(self, reading: float) -> float:
        """Return the quantity [SI] that the sensor shows as a reading [`unit`]."""
        if self.gain is None:
            return reading
        if self.zero is None:
            return reading / self.gain
        return self.zero + (reading - self.low) / self.gain

    def to_reading(self, quantity: float) -> float:
        """Return what the sensor shows [`unit`] of a quantity [SI]."""
        return float(self._shown(quantity, self.gain, self.zero))

    def _shown(self, quantity: Any, gain: Any, zero: Any) -> Any:
        if self.gain is None:
            return quantity
        return gain * quantity if self.zero is None else self.low + gain * (quantity - zero)

    def connections(self) -> tuple[Connection, ...]:
        """Return the tank, or the element that causes the flow."""
        if self.flow:
            return (Connection(("flow",), self.flow, "flow", carries_flow=False),)
        return (Connection(("tank",), self.tank, "tank", carries_flow=False),)

    def states(self) -> tuple[Signal, ...]:
        """Return the lagged quantity where it has a lag.

        Its range goes on beyond that of the sensor, since the quantity may: a finite range scales
        searches, but nothing holds this state within it.
        """
        if self.lag is None:
            return ()
        largest = max(abs(self.to_quantity(end)) for end in (self.low, self.high))
        if self.vessel is not None and self.measured in CONTENTS:
            largest = max(largest, self.bounds[1])
        ends = -largest, 2 * largest, largest / 2
        words, shown = f"{self._words} as {self.name} follows it", self.shown_quantity_unit
        return (Signal(self._lagged, self.quantity_unit, shown, *ends, description=words),)

    def measurements(self) -> tuple[Signal, ...]:
        """Return the measurement."""
        ends, words = (self.low, self.high, 0.0), f"measured {self._words}"
        words = ", ".join([words, *(each.words for each in self.reporting().values())])
        return (self._signal(self.name, self.unit, ends, words),)

    def measured_states(self) -> dict[str, str]:
        """Return the level, the concentration or the lagged state that the measurement shows."""
        if self.lag is not None:
            return {self.name: self._lagged}
        return {self.name: f"{self.tank}.level" if self.measured == "volume" else self.quantity}

    def reporting(self) -> dict[str, Reporting]:
        """Return how late and how seldom it tells what it reads, where it does not at once."""
        if not (self.dead_time or self.sampling):
            return {}
        return {self.name: Reporting(self.dead_time, self.sampling, self.first_report)}

    def noises(self) -> dict[str, float]:
        """Return the standard deviation of the measurement [`unit`] where it is known."""
        return {} if self.noise is None else {self.name: self.noise}

    def parameters(self) -> tuple[Signal, ...]:
        """Return gain, zero and time constant, as far as it has them."""
        found = []
        if self.gain is not None:
            unit = gain_unit(self.unit, self.quantity_unit)
            gain = self._parameter("gain", unit, self.gain, f"signal per {self.measured} of")
            found.append(replace(gain, display_unit=self._shown_gain))
        if self.zero is not None:
            words = f"{self.measured} at the low end of the range of"
            zero = self._parameter("zero", self.quantity_unit, self.zero, words)
            found.append(
                replace(zero, display_unit=self.display_units.get("span", ""), low=-math.inf)
            )
        return (*found, *super().parameters())

    @property
    def _shown_gain(self) -> str:
        """The unit of the gain that the reader sees: that of range over that of span."""
        above, below = (self.display_units.get(key, "") for key in ("range", "span"))
        if self.zero is None or not (above and below):
            return self.display_units.get("gain", "")
        return f"{above}/{below if below.isalpha() else f'({below})'}"

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return dq_l/dt = (q - q_l) / T."""
        if self.lag is None:
            return {}
        difference = self._true(symbols) - symbols[self._lagged]
        return {self._lagged: difference * reciprocal(symbols[f"{self.name}.lag"])}

    def readings(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return y = q, y = k q, or y = y_low + k (q - q_low)."""
        quantity = self._true(symbols) if self.lag is None else symbols[self._lagged]
        gain, zero = symbols.get(f"{self.name}.gain"), symbols.get(f"{self.name}.zero")
        return {self.name: self._shown(quantity, gain, zero)}

    def displayed(self, readings: Symbols) -> dict[str, ca.SX]:
        """Return the reading rounded to the resolution and limited; no number stays none."""
        shown = readings[self.name]
        if self.resolution:
            shown = ca.floor(shown / self.resolution + 0.5) * self.resolution
        low, high = self.limits
        return {self.name: ca.if_else(shown > high, high, ca.if_else(shown < low, low, shown))}

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the largest measurement that it gives [`unit`]."""
        whole = (self.low, self.high)
        return NAMUR_LIMITS if self.unit == "A" and whole == (0.004, 0.02) else whole

    def _true(self, symbols: Symbols) -> ca.SX:
        """Return the quantity at this instant."""
        if self.measured != "volume" or self.vessel is None:
            return symbols[self.quantity]
        sizes = self.vessel.sizes(self.tank, symbols)
        return self.vessel.volume(symbols[f"{self.tank}.level"], sizes)

    @property
    def _lagged(self) -> str:
        return f"{self.name}.lagged"

    @property
    def _words(self) -> str:
        if self.flow:
            return f"flow of {self.flow}"
        if self.measured in _UNITS:
            return f"{self.measured} of {self.tank}"
        return f"concentration of {self.measured} in {self.tank}"


def _quantity_unit(measured: str, components: Sequence[Component]) -> str:
    """Return the SI unit of a quantity."""
    if measured in _UNITS:
        return _UNITS[measured]
    return next(component.unit for component in components if component.name == measured)
