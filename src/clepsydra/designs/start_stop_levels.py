"""Start and stop levels from the starts that a pump may make in an hour."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.signal import elements, path
from clepsydra.base.units import from_si
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.start_stop_levels import FAMILY, start_stop_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import argument
from clepsydra.designs.design import Studied, design
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.models.brent import root_between
from clepsydra.designs.request import positive_number
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.elements.pump import Pump

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

#: Shares of the tank's height that the levels keep to.
LOWEST, HIGHEST = 0.2, 0.8
_HOUR = 3600.0
_REMEDY = 'write as in 6 or "6 1/h", how often a motor may be started in an hour'


def _starts(table: TableReader, key: str, process: Process) -> float:
    """Read how often a pump may start in an hour; a bare number will do."""
    unit = "1/h" if isinstance(table.raw(key), str) else "1"
    return table.quantity(key, unit, "a number of starts", _REMEDY, above=0.0)


_STARTS_PER_HOUR = argument(
    "starts_per_hour",
    _starts,
    'of one pump, `10` or `"10 1/h"`, above 0',
    {"type": ["number", "string"]},
    "quantity",
    partial(positive_number, "starts_per_hour", expected="a number above 0", remedy=_REMEDY),
)


@design(
    "start_stop_levels",
    "pumps by start and stop levels",
    Studied(280, "Start/stop levels"),
    keys=(_STARTS_PER_HOUR,),
    method="start/stop levels",
)
def design_start_stop_levels(model: LinearModel, *, starts_per_hour: float = 10.0) -> Controller:
    """Return levels at which pumps start and stop, with duty and standby.

    A pump of capacity Q that starts and stops over the volume V has its shortest cycle where the
    inflow is Q/2: T = 4 V/Q. So that it starts at most z times an hour,

        V = Q · 3600 s / (4 z),  or V = 0.9 Q/z with V in m³, Q in l/s and z per hour,

    with Q the largest flow of a pump between the levels. The stages have this volume each, and
    every further one stands higher than the one before it by an equal share of the room that is
    left. All levels lie between 20 and 80 % of the tank's height. Where pumps alternate, each
    starts more seldom than that.

    Parameters
    ----------
    starts_per_hour : float
        z, of one pump.

    Returns
    -------
    Controller
        Without a setpoint.

    Raises
    ------
    InputError
        The model has no operating point, or the number of starts is none above zero.
    NotApplicable
        The process has not one controlled level of a tank that pumps, and nothing else, empty or
        fill, the pumps have level switches of their own, the tank is too small for the volume or
        there to smooth the flow, or all pumps together do not master the flow.

    References
    ----------
    ATV-DVWK-A 134, Planung und Bau von Abwasserpumpanlagen, 2000; Metcalf & Eddy, Wastewater
    Engineering: Collection and Pumping of Wastewater, McGraw-Hill 1981.

    Examples
    --------
    A pump of the wet well lifts at most 41.2 l/s, hence V = 0.9 · 41.2/10 = 3.71 m³ or 0.31 m:

    >>> import clepsydra as cl
    >>> plant = cl.load("wet-well:start-stop")
    >>> for words in design_start_stop_levels(plant.linear).design.split("; "):
    ...     print(words.partition(": ")[2] or words)
    41.2 l/s need 3.71 m³ between start and stop
    stage 1 starts at 1.11 m and stops at 0.8 m
    stage 2 starts at 2.15 m and stops at 1.85 m.
    """
    return _Station(operating_point_of(model)).controller(starts_per_hour)


class _Station:
    """One tank and its pumps."""

    def __init__(self, point: OperatingPoint) -> None:
        self.point, self.process = point, point.process
        self.level = self._controlled_level()
        self.tank = self.process.measured_state[self.level].removesuffix(".level")
        self.pumps = self._pumps()
        self.empties = self.pumps[0].source == self.tank
        self._place = [s.name for s in self.process.state].index(f"{self.tank}.level")
        state = self.process.state[self._place]
        self.low = state.low + LOWEST * (state.high - state.low)
        self.high = state.low + HIGHEST * (state.high - state.low)
        self._check_mastered()

    def controller(self, starts_per_hour: float) -> Controller:
        ends = self.low, self.high
        capacity = max(self._capacity(pump, level) for pump in self.pumps for level in ends)
        volume = capacity * _HOUR / (4.0 * starts_per_hour)
        stages = self._stages(volume, capacity, starts_per_hour)
        manipulated = tuple(pump.name for pump in self.pumps)
        measured, unit = self.process.signal(self.level), self.process.state[self._place].shown_unit
        law = start_stop_law([measured], [self.process.signal(name) for name in manipulated])
        values = {parameter.name: parameter.initial for parameter in law.parameters}
        words: list[str] = []
        for stage, (start, stop) in zip(elements("stage", len(stages)), stages, strict=True):
            values[path(stage, "start_level")] = self._shown(start)
            values[path(stage, "stop_level")] = self._shown(stop)
            first, last = (f"{from_si(level, 'm', unit):.3g} {unit}" for level in (start, stop))
            words.append(f"stage {len(words) + 1} starts at {first} and stops at {last}")
        for pump in self.pumps:
            values |= {path(pump.name, what): pump.high for what in ("running_value", "high_limit")}
            values |= {path(pump.name, what): pump.low for what in ("stopped_value", "low_limit")}
        values = designed_values(law, values, self.point)
        resting = {path(pump.name, "tracking"): pump.low for pump in self.pumps}
        resting[path(measured, "pv")] = self.point.as_dict()[self.level]
        return Controller(
            name="Start/stop levels",
            family=FAMILY,
            structure=Complexity.LOOPS,
            design=(
                f"Start and stop levels for at most {starts_per_hour:g} starts an hour of a pump: "
                f"{_litres(capacity)} need {volume:.3g} m³ between start and stop; "
                f"{'; '.join(words)}."
            ),
            law=law,
            values=values,
            initial_state=state_at_rest(law, values, resting),
            measurements=(self.level,),
            setpoints=(),
            manipulated=manipulated,
            notes=("It follows no setpoint: the level goes to and fro between start and stop.",),
        )

    def _controlled_level(self) -> str:
        process = self.process
        if len(process.controlled) != 1:
            count = len(process.controlled)
            raise NotApplicable(f"it keeps one level, and {process.name} has {count}")
        (level,) = process.controlled
        if not process.measured_state.get(level, "").endswith(".level"):
            raise NotApplicable(f"{level} does not show the level of a tank")
        if level in process.averaging:
            raise NotApplicable(
                f"the tank of {level} is to smooth a flow, which pumps would send in bursts"
            )
        return level

    def _pumps(self) -> tuple[Pump, ...]:
        by_name = {element.name: element for element in self.process.elements}
        found: list[Pump] = []
        for signal in self.process.inputs:
            element = by_name.get(signal.name)
            if not isinstance(element, Pump):
                raise NotApplicable(f"{signal.name} is no pump")
            if element.starter is not None:
                raise NotApplicable(f"{signal.name} has level switches of its own")
            if self.tank not in (element.source, element.destination):
                raise NotApplicable(f"{signal.name} neither empties nor fills {self.tank}")
            found.append(element)
        if len({pump.source == self.tank for pump in found}) > 1:
            raise NotApplicable(f"some pumps empty {self.tank} and others fill it")
        return tuple(found)

    def _check_mastered(self) -> None:
        middle = (self.low + self.high) / 2.0
        off, on = self._rate(middle, ()), self._rate(middle, self.pumps)
        rises, falls = (off, on) if self.empties else (on, off)
        if not (rises > 0.0 and falls < 0.0):
            raise NotApplicable(
                f"at the nominal flows the level of {self.tank} does not go up and down as all "
                "pumps stop and start"
            )

    def _rate(self, level: float, running: Sequence[Pump]) -> float:
        """Return how fast the level rises with some pumps at full speed [m/s]."""
        process, names = self.process, [pump.name for pump in running]
        state, inputs = self._state_at(level), self.point.inputs.copy()
        for pump in self.pumps:
            value = pump.high if pump.name in names else pump.low
            inputs[[s.name for s in process.inputs].index(pump.name)] = value
            for place, signal in enumerate(process.state):
                if signal.name == f"{pump.name}.actual":
                    state[place] = value
        rates = process.dynamics(state, inputs, self.point.disturbances, process.parameter_values)
        return float(rates[self._place])

    def _state_at(self, level: float) -> np.ndarray:
        """Return the state at rest but for this level [m]."""
        state = self.point.state.copy()
        state[self._place] = level
        return state

    def _volume(self, level: float) -> float:
        """Return the liquid in the plant with the level of this tank there [m³]."""
        motion, parameters = self.process.motion, self.process.parameter_values
        contents = motion.to_contents(self._state_at(level), parameters)
        return float(motion.stored(contents, parameters)[motion.stored_names.index("liquid")])

    def _capacity(self, pump: Pump, level: float) -> float:
        """Return the flow of a pump alone at full speed [m³/s]."""
        change = 1e-3 * (self.high - self.low)
        area = (self._volume(level + change) - self._volume(level - change)) / (2.0 * change)
        return abs(self._rate(level, (pump,)) - self._rate(level, ())) * area

    def _stages(
        self, volume: float, capacity: float, starts_per_hour: float
    ) -> list[tuple[float, float]]:
        """Return start and stop of each stage [m]."""
        first, last = (self.low, self.high) if self.empties else (self.high, self.low)
        start, count = self._volume(first), len(self.pumps)
        room = abs(self._volume(last) - start)
        if volume >= room:
            raise NotApplicable(
                f"{starts_per_hour:g} starts an hour of a pump of {_litres(capacity)} need "
                f"{volume:.3g} m³ between start and stop, and {self.tank} has {room:.3g} m³ from "
                f"{LOWEST:.0%} to {HIGHEST:.0%} of its height"
            )

        def level_after(volume: float) -> float:
            """Return the level that lies so much liquid from the first, on the way to the last."""
            if volume == 0.0:
                return first
            return root_between(lambda h: abs(self._volume(h) - start) - volume, first, last)

        shares = [(room - volume) * j / count for j in range(count)]
        return [(level_after(share + volume), level_after(share)) for share in shares]

    def _shown(self, level: float) -> float:
        """Return what the sensor shows [measurement unit]."""
        readings = self.process.measure(self._state_at(level), self.process.parameter_values)
        names = [signal.name for signal in self.process.measurements]
        return float(readings[names.index(self.level)])


def _litres(flow: float) -> str:
    return f"{1e3 * flow:.3g} l/s"
