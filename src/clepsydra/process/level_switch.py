"""Level switches of a pump: trips that stop it, and a starter that runs it by a level."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import Finding
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.process import told
from clepsydra.process.hybrid import Event, switch_memory, switching
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import vessel_of
from clepsydra.program.step_law import Symbols

_LEVEL = told.written("m")
#: The keys of a process file that `read_trips` and `read_starter` know.
TRIP_KEYS = {
    "trip_above": told.by_name("levels of tanks above which it stops [m]", _LEVEL),
    "trip_below": told.by_name("levels of tanks below which it stops [m]", _LEVEL),
    "hysteresis": told.quantity("how far levels must come back before it may run again", "m"),
}
STARTER_KEYS = {
    "start_above": told.by_name("level of one tank above which it starts by itself [m]", _LEVEL),
    "stop_below": told.by_name("level of the same tank below which it stops [m]", _LEVEL),
    "running": {"description": "whether it runs at first", "type": "boolean"},
}


@dataclass(frozen=True)
class LevelLimit:
    """A level of a tank that a switch watches.

    Parameters
    ----------
    level : float
        [m]
    above : bool
        It watches for levels above, or else below.
    unit : str
        In which words give the level.

    Examples
    --------
    >>> limit = LevelLimit("tank_3", 0.275, above=True, unit="cm")
    >>> limit.words(), limit.words(back=0.005)
    ('tank_3 above 27.5 cm', 'tank_3 below 27 cm')
    """

    tank: str
    level: float
    above: bool
    unit: str = "m"

    def excess(self, symbols: Symbols) -> ca.SX:
        """Return how far the level is beyond the limit [m], negative before it."""
        beyond = symbols[f"{self.tank}.level"] - self.level
        return beyond if self.above else -beyond

    def words(self, back: float | None = None) -> str:
        """Return it in words; with `back` [m], that the level has come back so far."""
        level = self.level if back is None else self.level + (-back if self.above else back)
        side = "above" if self.above == (back is None) else "below"
        return f"{self.tank} {side} {from_si(round(level, 12), 'm', self.unit):g} {self.unit}"


@dataclass(frozen=True)
class LevelTrips:
    """Limits that switch a pump off while any of them is exceeded.

    Parameters
    ----------
    hysteresis : float
        How far all levels must come back before the pump may run again [m], above zero.

    Examples
    --------
    >>> trips = LevelTrips((LevelLimit("tank_3", 0.275, above=True, unit="cm"),), 0.005)
    >>> symbols = {"tank_3.level": ca.SX(0.28), "pump_1.tripped": ca.SX(0)}
    >>> for event in trips.events("pump_1", symbols):
    ...     print(event.words, round(float(event.guard), 3))
    pump_1 trips: tank_3 above 27.5 cm 0.005
    pump_1 is released: tank_3 below 27 cm -1.0
    """

    limits: tuple[LevelLimit, ...]
    hysteresis: float

    def memory(self, element: str) -> Signal:
        """Return the memory that is 1 while the pump is switched off."""
        return switch_memory(f"{element}.tripped", 0.0, f"{element} has tripped")

    def events(self, element: str, symbols: Symbols) -> tuple[Event, ...]:
        """Return one trip for each limit, and the release when all levels are back."""
        tripped, back = f"{element}.tripped", ca.SX(1)
        on = symbols[tripped] > 0.5
        for limit in self.limits:
            back = ca.fmin(back, -limit.excess(symbols) - self.hysteresis)
        released = " and ".join(limit.words(self.hysteresis) for limit in self.limits)
        released = f"{element} is released: {released}"
        harm = "until it is released nothing is controlled; keep the levels away from it"
        return (
            *(
                switching(
                    tripped,
                    on,
                    True,
                    f"trips_{limit.tank}_{'above' if limit.above else 'below'}",
                    f"{element} trips: {limit.words()}",
                    limit.excess(symbols),
                    harm,
                )
                for limit in self.limits
            ),
            switching(tripped, on, False, "is_released", released, back),
        )


@dataclass(frozen=True)
class LevelStarter:
    """A switch that runs a pump between two levels of one tank, as in a wet well.

    Parameters
    ----------
    start, stop : LevelLimit
        The pump starts above the first and stops below the second, which is lower.
    running : bool
        It runs at first.

    Examples
    --------
    >>> starter = LevelStarter(LevelLimit("well", 1.2, above=True),
    ...                        LevelLimit("well", 0.4, above=False), running=True)
    >>> symbols = {"well.level": ca.SX(0.3), "pump_1.runs": ca.SX(1)}
    >>> [(event.words, round(float(event.guard), 3)) for event in starter.events("pump_1", symbols)]
    [('pump_1 starts: well above 1.2 m', -1.0), ('pump_1 stops: well below 0.4 m', 0.1)]
    """

    start: LevelLimit
    stop: LevelLimit
    running: bool

    def memory(self, element: str) -> Signal:
        """Return the memory that is 1 while the pump runs."""
        return switch_memory(
            f"{element}.runs", float(self.running), f"{element} runs by its switch"
        )

    def events(self, element: str, symbols: Symbols) -> tuple[Event, ...]:
        """Return its start and its stop."""
        runs = f"{element}.runs"
        on = symbols[runs] > 0.5
        starts = f"{element} starts: {self.start.words()}"
        stops = f"{element} stops: {self.stop.words()}"
        return (
            switching(runs, on, True, "starts", starts, self.start.excess(symbols)),
            switching(runs, on, False, "stops", stops, self.stop.excess(symbols)),
        )


def read_trips(table: TableReader) -> LevelTrips | None:
    """Read the keys "trip_above", "trip_below" and "hysteresis" of a pump."""
    limits = (*_limits(table, "trip_above"), *_limits(table, "trip_below"))
    if not limits:
        if table.has("hysteresis"):
            remedy = 'remove it, or add a trip as in trip_above = { tank_3 = "27.5 cm" }'
            raise table.wrong("hysteresis", "no hysteresis, since the pump has no trip", remedy)
        return None
    remedy = "say how far a level must come back before the pump is released"
    hysteresis = table.quantity("hysteresis", "m", "a difference of levels", remedy, above=0.0)
    for limit in limits:
        for lower in limits:
            same = limit.tank == lower.tank and limit.above and not lower.above
            if same and limit.level - hysteresis <= lower.level + hysteresis:
                expected = f"a level far enough below that of trip_above for {limit.tank}"
                remedy = "leave more than two hystereses between the two levels"
                raise table.refused("trip_below", lower.words(), expected, remedy)
        room = limit.level
        if not limit.above:
            vessel = vessel_of(table, limit.tank)
            room = math.inf if vessel is None else vessel.height - limit.level
        if room <= hysteresis:
            raise table.wrong(
                "hysteresis",
                f"less than what is left {'below' if limit.above else 'above'} the level at which "
                f"{limit.tank} trips the pump",
                "make it smaller, or the pump is never released",
            )
    return LevelTrips(limits, hysteresis)


def read_starter(table: TableReader) -> LevelStarter | None:
    """Read the keys "start_above", "stop_below" and "running" of a pump.

    A pump runs at first where the file does not say, since its nominal signal describes an
    operating point at which it runs.
    """
    start, stop = _limits(table, "start_above"), _limits(table, "stop_below")
    if not start and not stop:
        if table.has("running"):
            expected = "no such key, since the pump has no level switch"
            remedy = "remove it, or add start_above and stop_below"
            raise table.refused("running", str(table.raw("running")).lower(), expected, remedy)
        return None
    remedy = 'write as in start_above = { well = "1.2 m" } and stop_below = { well = "0.4 m" }'
    for key, limits in (("start_above", start), ("stop_below", stop)):
        if len(limits) != 1:
            got = Finding(f"no {key}") if not limits else table.written(key)
            raise table.refused(key, got, "one level of one tank", remedy)
    if start[0].tank != stop[0].tank:
        raise table.refused(
            "stop_below", stop[0].tank, f"a level of {start[0].tank}, as in start_above", remedy
        )
    if stop[0].level >= start[0].level:
        raise table.refused(
            "stop_below", stop[0].words(), "a level below that of start_above", remedy
        )
    return LevelStarter(start[0], stop[0], table.flag("running", default=True))


def _limits(table: TableReader, key: str) -> tuple[LevelLimit, ...]:
    if not table.has(key):
        return ()
    expected, remedy = "a level for each tank", f'write as in {key} = {{ tank_1 = "20 cm" }}'
    if not isinstance(table.raw(key), dict):
        raise table.wrong(key, expected, remedy)
    inner = table.table(key, expected, remedy)
    if not inner.present:
        raise table.refused(key, "{}", expected, "name a tank, or remove the key")
    limits = []
    for tank in inner.present:
        vessel = vessel_of(table, tank)
        level = inner.quantity(
            tank, "m", "a level", f"choose a level between floor and rim of {tank}",
            above=0.0, at_most=None if vessel is None else vessel.height,
        )  # fmt: skip
        unit = inner.display_units(tank).get(tank, "m")
        limits.append(LevelLimit(tank, level, key.endswith("above"), unit))
    return tuple(limits)
