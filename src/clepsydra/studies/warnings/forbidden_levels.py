"""Setpoints and resting levels at which a trip, a sensor or a rim stops the control."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.words import listed
from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown
from clepsydra.loop.scenario import Scenario
from clepsydra.process.elements.pump import Pump
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.level_switch import LevelLimit
from clepsydra.process.process import Process
from clepsydra.studies.warnings.resting import Rest

#: A level so near to a limit, a share of its range, is at it.
_ROUNDING = 1e-6


def level_words(
    controller: Controller, point: OperatingPoint, scenario: Scenario, rests: list[Rest]
) -> Iterator[Remark]:
    """Return in sentences the levels that the scenario asks for and the plant forbids.

    *Setpoints*, the least and the largest of each controlled measurement: outside of the range
    of the sensor, which then shows its end for ever; at or above the rim or at the floor of the
    tank; at or beyond a level at which a trip stops a pump; at or below the level at which a
    level switch stops a pump that the controller moves; at or above that at which it starts
    another, which then runs all the time.

    *Other tanks*: the same at the operating point, and where each step comes to rest by the
    linear model.

    Parameters
    ----------
    rests : list of Rest
        Of `resting_after`.
    """
    process, controlled = point.process, set()
    for name in dict.fromkeys(controller.setpoints):
        column = scenario.setpoints[:, process.controlled.index(name)]
        signal, sensor = process.signal(name), _sensor(process, name)
        for value in dict.fromkeys((float(np.min(column)), float(np.max(column)))):
            what = f"The setpoint of {name} of {shown(signal, value)}"
            if not signal.low <= value <= signal.high:
                seen = (
                    f"{what} is outside of its range of {shown(signal, signal.low)} to "
                    f"{shown(signal, signal.high)}, which it never shows"
                )
                yield Remark(seen, remedy="choose one inside")
            if sensor is not None and sensor.measured in ("level", "volume"):
                controlled.add(sensor.tank)
                level = _level(sensor, value)
                for why, other in _forbidden(process, controller, sensor.tank, level):
                    yield Remark(f"{what} {why}", remedy=f"choose {other}")
    states = [("At the operating point", "rests at", point.as_dict())]
    states += [
        (f"After the {rest.segment.kind} step of {rest.segment.signal}", "is at about", rest.values)
        for rest in rests
    ]
    said: set[str] = set()
    for when, rests_at, values in states:
        for tank in (element for element in process.elements if isinstance(element, Tank)):
            if tank.name in controlled:
                continue
            level, signal = values[tank.level], process.signal(tank.level)
            floor, _ = _floor(tank.name)
            for why, other in _forbidden(process, controller, tank.name, level):
                # By a linear model a tank that is nearly empty may rest below its floor.
                if why in said or (values is not states[0][2] and why == floor):
                    continue
                said.add(why)
                seen = f"{when} {tank.level} {rests_at} {shown(signal, level)}, which {why}"
                yield Remark(seen, remedy=f"choose {other}")


def _forbidden(
    process: Process, controller: Controller, tank: str, level: float
) -> Iterator[tuple[str, str]]:
    """Yield why a level of a tank cannot be held, "is above …", and which one to choose."""
    signal = process.signal(f"{tank}.level")
    near = _ROUNDING * signal.span
    if level >= signal.high - near:
        rim = f"is at or above the rim of {tank} at {shown(signal, signal.high)}, where it spills"
        yield rim, "a lower one"
    if level <= signal.low + near:
        yield _floor(tank)
    pumps = [element for element in process.elements if isinstance(element, Pump)]
    tripped: dict[LevelLimit, list[str]] = {}
    for pump in pumps:
        for limit in pump.trips.limits if pump.trips else ():
            beyond = (level - limit.level) * (1.0 if limit.above else -1.0)
            if limit.tank == tank and beyond >= -near:
                tripped.setdefault(limit, []).append(pump.name)
    for limit, names in tripped.items():
        side = "below" if limit.above else "above"
        trip = f"is beyond the trip of {listed(names)}, {limit.words()}, so that it is never held"
        yield trip, f"one {side} it"
    for pump in pumps:
        if pump.starter is None or pump.starter.stop.tank != tank:
            continue
        moved = pump.name in controller.manipulated
        if moved and level <= pump.starter.stop.level + near:
            yield (
                f"is below the level switch that stops {pump.name}, {pump.starter.stop.words()}, "
                "so that it is never held",
                "one above it",
            )
        if not moved and level >= pump.starter.start.level - near:
            yield (
                f"is above the level switch that starts {pump.name}, "
                f"{pump.starter.start.words()}, which then runs all the time",
                "one below it",
            )


def _floor(tank: str) -> tuple[str, str]:
    return f"is at or below the floor of {tank}", "a higher one"


def _sensor(process: Process, name: str) -> Sensor | None:
    sensors = (element for element in process.elements if isinstance(element, Sensor))
    return next((sensor for sensor in sensors if sensor.name == name), None)


def _level(sensor: Sensor, reading: float) -> float:
    """Return the level at which a sensor of a level or a volume shows a reading [m]."""
    quantity = sensor.to_quantity(reading)
    if sensor.measured == "level" or sensor.vessel is None:
        return quantity
    return float(sensor.vessel.level(ca.SX(quantity), sensor.vessel.values()))
