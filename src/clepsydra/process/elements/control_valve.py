"""A control valve: a throttle that a controller opens and shuts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import casadi as ca

from clepsydra.base.errors import Finding
from clepsydra.base.quantity import quantity
from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.process import told
from clepsydra.process.actuator import ROUNDING, follows_in, limited_speed
from clepsydra.process.constant_speed_pump import BAR, WATER, ConstantSpeedPump, kv_conductance
from clepsydra.process.declared import choice, filled, flag, link, part, table_schema
from clepsydra.process.element import Element
from clepsydra.process.elements.orifice import LAMINAR
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.friction import Backlash, Stiction, read_friction
from clepsydra.process.hybrid import Event, Switch
from clepsydra.process.outside_signal import actuator_signal
from clepsydra.process.root_law import falling_root, signed_root
from clepsydra.process.suction import SUCTION_TOLD, Suction, drawn, read_suction
from clepsydra.process.table_reader import TableReader
from clepsydra.process.valve_characteristic import CHARACTERISTICS, opened
from clepsydra.process.vessels.vessel import Vessel, vessel_of
from clepsydra.program.step_law import Symbols

_AT_ONCE = "leave it out for a valve that follows at once"


@dataclass(frozen=True)
class ControlValve(Element):
    """A valve with a flow coefficient: q = Kv f(s) √(Δp / 1 bar · 1000 kg/m³ / ρ).

    IEC 60534-2-1, 2011, for turbulent flow of a liquid without cavitation. With
    Δp = ρ g Δh the density cancels and q = Kv f(s) √(g/100) φ(Δh), Δh in metres; φ is the root
    law of `clepsydra.process.root_law`, laminar below 1 mm. A supply pressure adds
    p / (1000 kg/m³ g) to Δh: it counts as that of a liquid with the density of water. f is in
    `clepsydra.process.valve_characteristic`; with the Kv of pipe and fittings in series,
    1/Kv² = 1/(Kv_valve f)² + 1/Kv_line², it becomes the installed characteristic.

    The position of the actuator follows the signal at once, with a lag, or over a stroke time: at
    a constant speed, with the last of the way at the lag, or without one at a time constant of one
    per cent of the stroke time. The stem follows the actuator, with backlash or stiction if the
    file says so.

    A free discharge falls into whatever is below, and nothing comes back; a submerged valve
    joins two tanks at their floors and flows either way. A valve that would go on emptying a
    tank without liquid breaks off, see `clepsydra.process.suction`. Behind a pump at constant
    speed the flow is where its curve meets lift, line and valve, see
    `clepsydra.process.constant_speed_pump`.

    Parameters
    ----------
    kv : float
        Flow through the open valve at 1 bar of water [m³/s].
    nominal : float or None
        Signal at the operating point; None where the process gives levels instead.
    elevation : float
        Height of the source's floor, or of the surface of a reservoir, above the outlet, or
        above the floor of the other tank if submerged [m].
    pressure : float
        Supply pressure at the source above that at the outlet [Pa].
    line_kv : float
        Kv of pipe and fittings in series [m³/s].
    pump : ConstantSpeedPump or None
        Before it.
    source_vessel : Vessel or None
        Shape of the tank above; None for a reservoir.
    suction : Suction or None
        From that tank, where pressure or elevation would let the valve empty it.

    Examples
    --------
    Kv is the flow at 1 bar, here from a reservoir:

    >>> valve = ControlValve("valve_1", "main", "tank_1", kv=10 / 3600, low=0.0, high=1.0,
    ...                      nominal=1.0, unit="1", pressure=1e5)
    >>> symbols = {"valve_1": 1.0, "valve_1.kv": 10 / 3600, "valve_1.pressure": 1e5}
    >>> symbols["gravity"] = 9.81
    >>> (flow,) = valve.flows(symbols, ())
    >>> round(float(flow.rate) * 3600, 9)  # [m³/h]
    10.0
    """

    kind, table, symbol, place = "control valve", "valves", "valve", 6
    tagged = True
    other_keys: ClassVar[Mapping[str, str]] = {
        "cv": 'give the Kv, 0.865 times the Cv: that of 10 is kv = "8.65 m^3/h"'
    }

    source: str = link("the name of a tank or reservoir", "source")
    destination: str = link("the name of a tank or reservoir", "receiver")
    kv: float = quantity(
        "m^3/s",
        "a Kv",
        "flow at 1 bar through the open",
        above=0.0,
        remedy="give the flow at 1 bar of water, often in m^3/h",
    )
    low: float = actuator_signal()
    high: float = filled()
    nominal: float | None = filled()
    unit: str = "1"
    characteristic: str = choice(CHARACTERISTICS, words="how its flow follows its signal")
    rangeability: float = quantity(
        "1",
        "a rangeability",
        "rangeability of",
        above=1.0,
        default=50.0,
        needs="equal_percentage",
        remedy="leave it out for 50",
    )
    submerged: bool = flag(default=False, words="whether it joins two tanks below their surfaces")
    elevation: float = quantity(
        "m",
        "a height",
        default=0.0,
        remedy="name the higher of the two tanks as the source",
        lowest=lambda known: 0.0 if known["submerged"] else -math.inf,
    )
    pressure: float = quantity(
        "Pa",
        "a supply pressure",
        "pressure before",
        at_least=0.0,
        absent=0.0,
        remedy="leave it out for an open source",
    )
    line_kv: float = quantity(
        "m^3/s",
        "a Kv",
        "flow at 1 bar in the line of",
        above=0.0,
        absent=math.inf,
        remedy="leave it out for a line without loss",
    )
    stroke_time: float = follows_in(_AT_ONCE, "a time", "stroke time of")
    lag: float = follows_in(_AT_ONCE)
    friction: Backlash | Stiction | None = part(
        lambda table, key, known: read_friction(table),
        {
            "backlash": told.quantity("dead travel between signal and valve, a share of the range"),
            "stiction": told.quantity("what friction holds back, a share of the range"),
            "slip_jump": told.quantity("how far it jumps once it slips, a share of the range"),
        },
        default=None,
    )
    pump: ConstantSpeedPump | None = part(
        lambda table, key, known: ConstantSpeedPump.read(table, key) if table.has(key) else None,
        default=None,
        **{"description": "a pump at constant speed before it", **table_schema(ConstantSpeedPump)},
    )
    source_vessel: Vessel | None = part(
        lambda table, key, known: vessel_of(table, known["source"]),
        SUCTION_TOLD,
        default=None,
    )
    suction: Suction | None = None

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the valve from its table of a process file."""
        valve = super().read(name, table)
        if not valve.equal_percentage:
            table.refuse(
                ("rangeability",),
                "no rangeability, since only an equal-percentage valve has one",
                'remove it, or write characteristic = "equal percentage"',
            )
        source = valve.source
        if valve.pump:
            expected = "no such key beside a pump, whose curve and static_head say it"
            table.refuse(("elevation", "submerged"), expected, "remove one of the two")
            valve = replace(valve, pump=valve.pump.named(name))
        forced = valve.pump is not None or valve.elevation + valve.pressure / BAR > 0.0
        if valve.source_vessel is None and not valve.submerged and not forced:
            raise table.refused(
                "pressure",
                Finding("a valve without pressure"),
                f"a pressure, or an elevation of {source} above the outlet, "
                f"since {source} is no tank",
                'write as in pressure = "0.5 bar" or elevation = "2 m"',
            )
        return replace(valve, suction=read_suction(table, source, forced=forced))

    @property
    def equal_percentage(self) -> bool:
        """Whether every part of the stroke multiplies the flow alike."""
        return self.characteristic == "equal percentage"

    def states(self) -> tuple[Signal, ...]:
        """Return the position of the actuator, where it takes time to move."""
        if not self._lags:
            return ()
        words = f"position of the actuator of {self.name}"
        at = (self.inputs()[0].initial - self.low) / (self.high - self.low)
        return (Signal(self._position, "1", "%", 0.0, 1.0, at, description=words),)

    def _switches(self) -> tuple[Switch, ...]:
        return (self.suction,) if self.suction else ()

    def memories(self) -> tuple[Signal, ...]:
        """Return whether it draws liquid, and where a stem with play or stiction stands."""
        return (*super().memories(), *(self.friction.memories(self.name) if self.friction else ()))

    def inputs(self) -> tuple[Signal, ...]:
        """Return the signal; without a nominal value it stands in the middle of its range."""
        ends = self.low, self.high, self.nominal
        return (self._signal(self.name, self.unit, ends, f"signal to {self.name}"),)

    def parameters(self) -> tuple[Signal, ...]:
        """Return the numbers of the valve, of its line and of its actuator."""
        own = [] if self.friction is None else self.friction.parameters()
        friction = [self._parameter(key, "1", value, words) for key, value, words in own]
        pump = () if self.pump is None else self.pump.parameters()
        return (*super().parameters(), *friction, *pump)

    def as_built(self) -> tuple[str, ...]:
        """Return its Kv."""
        return (f"{self.name}.kv",)

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q = (Kv √(g/100)) · (f φ), with the line in series."""
        coefficient, share, head = self._hydraulics(symbols)
        if self.pump:
            flow = self.pump.flow(coefficient * share, head, symbols)
            if self.suction:
                flow = drawn(self.name, flow, symbols)
            return (Flow(self.source, self.destination, ca.SX(1), flow),)
        if self.submerged:
            driving = signed_root(head - symbols[f"{self.destination}.level"], LAMINAR)
        else:
            driving = falling_root(head, LAMINAR)
        if self.suction:
            # What comes back through a submerged valve may still come.
            rest = ca.fmin(driving, 0) if self.submerged else 0
            driving = drawn(self.name, driving, symbols, rest)
        return (
            Flow(
                self.source,
                self.destination,
                coefficient,
                share * driving,
                reversible=self.submerged,
            ),
        )

    def _hydraulics(self, symbols: Symbols) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Return what the open valve lets through per root of a metre, its share, and the head."""
        gravity = symbols["gravity"]
        coefficient = symbols[f"{self.name}.kv"] * kv_conductance(gravity)
        share = opened(
            self.characteristic, self._stem(symbols), symbols.get(f"{self.name}.rangeability", 1.0)
        )
        if self._has_line:
            ratio = symbols[f"{self.name}.kv"] / symbols[f"{self.name}.line_kv"]
            share = share / ca.sqrt(1 + (ratio * ratio) * (share * share))
        head = ca.SX(0)
        if self.elevation:
            head = head + self.elevation
        if self.pressure:
            head = head + symbols[f"{self.name}.pressure"] / (WATER * gravity)
        if self.submerged or self.source_vessel:
            head = head + symbols[f"{self.source}.level"]
        return coefficient, share, head

    @property
    def driven(self) -> bool:
        """Whether a pump stands before it."""
        return self.pump is not None

    def remarks(self, symbols: Mapping[str, float]) -> tuple[Remark, ...]:
        """Return what its pump does not bear for long."""
        if self.pump is None:
            return ()
        numbers = {name: ca.SX(value) for name, value in symbols.items()}
        coefficient, share, head = self._hydraulics(numbers)
        return self.pump.remarks(float(coefficient * share), float(head), symbols)

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return the speed of the actuator."""
        if not self._lags:
            return {}
        rate = 1 / symbols[f"{self.name}.stroke_time"] if self.stroke_time else None
        if rate is None or self.lag:
            per_lag = 1 / symbols[f"{self.name}.lag"]
        else:
            per_lag = rate * (1 / ROUNDING)
        missing = self._asked(symbols) - symbols[self._position]
        return {self._position: limited_speed(missing, per_lag, rate)}

    def largest_rates(self) -> dict[str, float]:
        """Return the speed of its stroke, if that takes a time."""
        return {self.name: (self.high - self.low) / self.stroke_time} if self.stroke_time else {}

    def events(self, symbols: Symbols) -> tuple[Event, ...]:
        """Return where its tank runs empty, and where the stem breaks away and sticks."""
        if self.friction is None:
            return super().events(symbols)
        stem = self.friction.events(self.name, *self._actuator(symbols), symbols)
        return (*super().events(symbols), *stem)

    def updates(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return where the stem stands at the end of a step."""
        if self.friction is None:
            return {}
        return {
            f"{self.name}.stem": self._stem(symbols),
            f"{self.name}.begins": ca.SX(0),
        }

    @property
    def _position(self) -> str:
        return f"{self.name}.position"

    @property
    def _lags(self) -> bool:
        return self.lag > 0.0 or self.stroke_time > 0.0

    @property
    def _has_line(self) -> bool:
        return math.isfinite(self.line_kv)

    def _asked(self, symbols: Symbols) -> ca.SX:
        """Return the opening that the signal asks for, from stop to stop."""
        share = (symbols[self.name] - self.low) * (1 / (self.high - self.low))
        return ca.fmin(ca.fmax(share, 0), 1)

    def _actuator(self, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
        """Return where the actuator is, and where it is on its way to."""
        asked = self._asked(symbols)
        return (symbols[self._position] if self._lags else asked), asked

    def _stem(self, symbols: Symbols) -> ca.SX:
        position, _ = self._actuator(symbols)
        if self.friction is None:
            return position
        return self.friction.stem(self.name, position, symbols)
