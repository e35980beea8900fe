"""A pump: a flow in proportion to a signal, or where its curve meets its pipe."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.actuator import ROUNDING, follows_in, limited_speed
from clepsydra.process.declared import filled, link, part
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.hybrid import Switch
from clepsydra.process.level_switch import (
    STARTER_KEYS,
    TRIP_KEYS,
    LevelStarter,
    LevelTrips,
    read_starter,
    read_trips,
)
from clepsydra.process.outside_signal import actuator_signal
from clepsydra.process.pump_curve import PumpCurve
from clepsydra.process.suction import Suction, drawing, drawn
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols

_AT_ONCE = "leave it out for a pump that follows its signal at once"
#: What it means that its tank is empty.
_RUNS_DRY = "nothing is left to draw, which damages a pump; keep the level higher"


@dataclass(frozen=True)
class Pump(Element):
    """A pump that is moved by a signal v: q = k max(v - v₀, 0), or by its curve.

    With a gain it is the pump of K. H. Johansson, The quadruple-tank process, IEEE Transactions
    on Control Systems Technology 8(3), 2000, section II, doi 10.1109/87.845876. With a curve the
    signal is its speed, 0 to 1 over the range, see `clepsydra.process.pump_curve`.

    What the signal asks for is reached at once, or with a lag and a limited rate, see
    `clepsydra.process.actuator`. A pump that a level switch has turned off is asked for
    standstill, so that it runs down with its lag; one whose tank is empty delivers nothing at
    once. Noise makes the flow q (1 + noise), and never negative.

    Parameters
    ----------
    gain : float or None
        k [m³/s per unit of the signal]; None with a curve.
    nominal : float or None
        Signal at the operating point; None where the process gives levels instead.
    unit : str
        SI unit of the signal: "V", "A", "1" or "Hz".
    dead_band : float
        v₀, the signal below which nothing flows.
    static_head : float
        Height of the end of the pipe above the source's floor, or above a reservoir [m].
    rate : float
        Largest change of the actual signal [unit/s]. Where it is limited without a lag, the lag
        is one per cent of the time that the whole range takes.

    Examples
    --------
    >>> pump = Pump("pump_1", "basin", "tank_1", gain=3.33e-6, low=0.0, high=10.0, nominal=3.0)
    >>> (flow,) = pump.flows({"pump_1.gain": 3.33e-6, "pump_1": 3.0}, ())
    >>> round(flow.coefficient * flow.driver * 1e6, 4)  # [cm³/s]
    9.99
    """

    kind, table, symbol, place = "pump", "pumps", "pump", 5
    tagged = True

    source: str = link("the name of a tank or reservoir", "source")
    destination: str = link("the name of a tank or splitter", "receiver")
    gain: float | None = quantity(
        "m^3/(s {unit})",
        "a gain",
        "flow per {per_unit} of",
        above=0.0,
        unless="curve",
        remedy="give the flow per unit of the signal",
    )
    low: float = actuator_signal()
    high: float = filled()
    nominal: float | None = filled()
    unit: str = "V"
    dead_band: float = quantity(
        "{unit}",
        "a signal",
        "dead band of",
        at_least=0.0,
        at_most="high",
        absent=0.0,
        unless="curve",
        remedy="give the signal below which nothing flows",
    )
    curve: PumpCurve | None = part(
        lambda table, key, known: PumpCurve.read(table) if table.has(key) else None,
        default=None,
        **told.pairs("in place of a gain: points of flow and head at full speed", "m^3/s", "m"),
    )
    static_head: float = quantity(
        "m",
        "a height",
        "static head of",
        at_least=0.0,
        default=0.0,
        needs="curve",
        required=True,
        remedy="give the height of the end of the pipe above the source",
    )
    pipe_loss: float = quantity(
        "s^2/m^5",
        "a loss of head per flow squared",
        "loss in the pipe of",
        at_least=0.0,
        default=0.0,
        needs="curve",
        remedy="leave it out for a pipe without loss",
    )
    lag: float = follows_in(_AT_ONCE)
    rate: float = quantity(
        "{unit}/s",
        "a change per time",
        "largest change per time of",
        above=0.0,
        absent=math.inf,
        remedy=_AT_ONCE,
    )
    trips: LevelTrips | None = part(
        lambda table, key, known: read_trips(table), TRIP_KEYS, default=None
    )
    starter: LevelStarter | None = part(
        lambda table, key, known: read_starter(table), STARTER_KEYS, default=None
    )
    suction: Suction | None = drawing(_RUNS_DRY)
    noise: float = quantity(
        "1",
        "a relative standard deviation",
        at_least=0.0,
        at_most=1.0,
        default=0.0,
        remedy="leave it out for a steady pump",
    )

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the pump from its table of a process file: with a gain, or with a curve."""
        if table.has("curve"):
            expected = "no such key beside a curve, which gives the flow"
            table.refuse(("gain", "dead_band"), expected, "remove one of the two")
        else:
            remedy = (
                'remove it, or add a curve as in curve = [["0 l/s", "30 m"], ["5 l/s", "27 m"]]'
            )
            table.refuse(("static_head", "pipe_loss"), "no such key without a curve", remedy)
        return super().read(name, table)

    def connections(self) -> tuple[Connection, ...]:
        """Return what it draws from, what it feeds, and the tanks that its switches watch."""
        watched = []
        if self.trips is not None:
            for limit in self.trips.limits:
                watched.append((("trip_above" if limit.above else "trip_below"), limit.tank))
        if self.starter is not None:
            watched.append(("start_above", self.starter.start.tank))
        return (
            *super().connections(),
            *(
                Connection((key, tank), tank, "tank", carries_flow=False)
                for key, tank in watched
            ),
        )  # fmt: skip

    def states(self) -> tuple[Signal, ...]:
        """Return what the signal has reached, where that takes time."""
        if not self._lags:
            return ()
        return (self._moved(self._actual, f"actual value of {self.name}"),)

    def _switches(self) -> tuple[Switch, ...]:
        return tuple(each for each in (self.suction, self.trips, self.starter) if each)

    def inputs(self) -> tuple[Signal, ...]:
        """Return the signal; without a nominal value it stands in the middle of its range."""
        what = "voltage" if self.unit == "V" else "signal"
        return (self._moved(self.name, f"{what} of {self.name}"),)

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the noise of its flow, relative to it."""
        if not self.noise:
            return ()
        most, words = 10 * self.noise, f"relative noise of the flow of {self.name}"
        return (Signal(self._noise, low=-most, high=most, description=words),)

    def noises(self) -> dict[str, float]:
        """Return the standard deviation of its noise [1]."""
        return {self._noise: self.noise} if self.noise else {}

    def as_built(self) -> tuple[str, ...]:
        """Return its gain, where it has one."""
        return () if self.gain is None else (f"{self.name}.gain",)

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q = k max(v - v₀, 0), or the flow of the curve."""
        value = symbols[self._actual] if self._lags else self._asked(symbols)
        coefficient: Any
        if self.curve is not None:
            head = symbols[f"{self.name}.static_head"]
            if self.suction:
                head = head - symbols[f"{self.source}.level"]
            speed = (value - self.low) * (1 / (self.high - self.low))
            coefficient = ca.SX(1)
            driver = self.curve.flow(speed, head, symbols[f"{self.name}.pipe_loss"])
        else:
            coefficient, driver = symbols[f"{self.name}.gain"], value
            if self.dead_band:
                driver = ca.fmax(value - symbols[f"{self.name}.dead_band"], 0)
        if self.noise:
            driver = driver * ca.fmax(1 + symbols[self._noise], 0)
        if self.suction:
            driver = drawn(self.name, driver, symbols)
        return (Flow(self.source, self.destination, coefficient, driver),)

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return how fast it follows its signal."""
        if not self._lags:
            return {}
        rate = symbols[f"{self.name}.rate"] if self._limited else None
        if self.lag:
            per_lag = 1 / symbols[f"{self.name}.lag"]
        else:
            per_lag = symbols[f"{self.name}.rate"] / (ROUNDING * (self.high - self.low))
        missing = self._asked(symbols) - symbols[self._actual]
        return {self._actual: limited_speed(missing, per_lag, rate)}

    def largest_rates(self) -> dict[str, float]:
        """Return its rate, if that is limited."""
        return {self.name: self.rate} if self._limited else {}

    @property
    def per_unit(self) -> str:
        """What its gain is the flow per, in words."""
        return "volt" if self.unit == "V" else "unit of the signal"

    @property
    def _actual(self) -> str:
        return f"{self.name}.actual"

    @property
    def _noise(self) -> str:
        return f"{self.name}.noise"

    @property
    def _limited(self) -> bool:
        return math.isfinite(self.rate)

    @property
    def _lags(self) -> bool:
        return self.lag > 0.0 or self._limited

    def _asked(self, symbols: Symbols) -> Any:
        """Return the signal, or that of standstill while a level switch keeps the pump off."""
        value: Any = symbols[self.name]
        standstill = 0.0 if self.curve is None else self.low
        if self.trips is not None:
            value = ca.if_else(symbols[f"{self.name}.tripped"] > 0.5, standstill, value)
        if self.starter is not None:
            value = ca.if_else(symbols[f"{self.name}.runs"] > 0.5, value, standstill)
        return value

    def _moved(self, name: str, description: str) -> Signal:
        return self._signal(name, self.unit, (self.low, self.high, self.nominal), description)
