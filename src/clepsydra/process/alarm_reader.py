"""The alarms of a process file: a table for each measurement, checked key by key."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import time_text
from clepsydra.process import told
from clepsydra.process.alarm import LIMITS, Alarm, AlarmKind, Priority, interlocks
from clepsydra.process.document import Document
from clepsydra.process.equations import Equations
from clepsydra.process.signal_values import read_in_range, read_rate, read_value
from clepsydra.process.table_reader import TableReader

#: What the deadband is where a file does not say it: of the range, and of the limit of a rate.
_DEADBAND, _OF_RATE = 0.01, 0.1
#: By how much an input has to move for a measurement to follow, of its range.
_MOVE = 0.01
_PRIORITIES = tuple(priority.words for priority in Priority)
_SHARED: dict[str, told.Schema] = {
    "deadband": told.quantity("how far it comes back before an alarm returns to normal"),
    "on_delay": told.quantity("time for which the condition is there before an alarm comes", "s"),
    "off_delay": told.quantity("time for which it is gone before an alarm returns", "s"),
    "priority": told.choice("how soon an operator has to act", _PRIORITIES),
    "acknowledged": told.flag("whether an operator acknowledges the alarms"),
    "interlock": told.by_name("inputs, and the values at which the alarm holds them"),
}
_RATE: dict[str, told.Schema] = {
    "filter_time": told.quantity("time of the filter of the rate", "s")
}
_FLATLINE: dict[str, told.Schema] = {
    "time": told.quantity("for how long the measurement is stuck", "s"),
    "still": told.quantity("how far it may move and still count as stuck"),
    "moves": told.by_name("inputs, and by how much each moves for the measurement to follow"),
}
_OWN = {AlarmKind.RATE: _RATE, AlarmKind.FLATLINE: _FLATLINE}
#: Those keys that a table of a measurement says for all of its alarms.
_GENERAL = tuple(key for key in _SHARED if key != "interlock")


def _written(kind: AlarmKind) -> told.Schema:
    """Return the schema of one alarm: its limit alone, or a table."""
    limit = {} if kind is AlarmKind.FLATLINE else {"limit": told.quantity("the alarm limit")}
    table = told.table({**limit, **_SHARED, **_OWN.get(kind, {})})
    return {"description": kind.words, "anyOf": [told.QUANTITY, table]}


#: What an editor is told of the key `alarms`.
ALARMS: told.Schema = told.by_name(
    "alarms on measurements, each table named after its sensor",
    told.table(
        {kind.key: _written(kind) for kind in AlarmKind} | {key: _SHARED[key] for key in _GENERAL}
    ),
)


def read_alarms(
    document: Document, general: TableReader, joined: Equations, controlled: Sequence[str]
) -> tuple[Alarm, ...]:
    """Read the alarms of a file, [alarms.level_1] with high = "18 cm".

    Raises
    ------
    InputError
        There is no such measurement; a limit lies outside its range, or on the wrong side of
        another; an alarm could never return to normal; or two hold an input at different values.
    """
    if not general.has("alarms"):
        return ()
    alarms: list[Alarm] = []
    keys = (*(kind.key for kind in AlarmKind), *_GENERAL)
    measured = {signal.name: signal for signal in joined.measurements}
    for name in TableReader(document, ("alarms",), None).present:
        path = ("alarms", name)
        if name not in measured:
            remedy = suggestion(name, measured, f"choose from {', '.join(measured)}")
            raise InputError(document.place(*path), name[:60], "the name of a sensor", remedy)
        table = TableReader(document, path, keys)
        reader = _Reader(table, measured[name], joined, name in controlled)
        found = [reader.alarm(kind) for kind in AlarmKind if table.has(kind.key)]
        if not found:
            expected = f"at least one of {', '.join(kind.key for kind in AlarmKind)}"
            raise InputError(table.place(), "none", expected, "add one, or remove the table")
        _check_order(reader, found)
        alarms += found
    _check_interlocks(document, alarms, {signal.name: signal for signal in joined.inputs})
    return tuple(alarms)


@dataclass(frozen=True)
class _Reader:
    """What reads the alarms of one measurement."""

    table: TableReader
    signal: Signal
    joined: Equations
    controlled: bool

    def alarm(self, kind: AlarmKind) -> Alarm:
        own, key = self.where(kind)
        read = {AlarmKind.RATE: self._rate, AlarmKind.FLATLINE: self._flatline}
        found = read.get(kind, self._level)(kind, own, key)
        usual = _PRIORITIES[kind.priority - 1]
        of_priority = self._of(own, "priority").choice("priority", _PRIORITIES, usual)
        return Alarm(
            self.signal.name,
            kind,
            priority=Priority[of_priority.upper()],
            acknowledged=self._of(own, "acknowledged").flag("acknowledged", default=False),
            off_delay=self._delay(own, "off_delay"),
            interlock=self._interlock(own),
            **found,
        )

    def where(self, kind: AlarmKind) -> tuple[TableReader, str]:
        """Return the table that says an alarm, and the key of its limit there."""
        if not isinstance(self.table.raw(kind.key), dict):
            return self.table, kind.key
        first = "time" if kind is AlarmKind.FLATLINE else "limit"
        keys = [key for key in _SHARED if first != "time" or key not in ("deadband", "on_delay")]
        own = self.table.table(kind.key, "an alarm", "write its limit", (first, *keys, *_own(kind)))
        return own, first

    def _of(self, own: TableReader, key: str) -> TableReader:
        """Return the table that says a key: the alarm's own, or that of all."""
        return own if own.has(key) else self.table

    def _delay(self, own: TableReader, key: str) -> float:
        where, remedy = self._of(own, key), "leave it out for none"
        return where.quantity(key, "s", "a time", remedy, at_least=0.0, default=0.0)

    def _change(self, table: TableReader, key: str, what: str, signal: Signal) -> float:
        """Return a change of a signal, not below zero and no more than its range."""
        value = read_value(table, key, signal, what, "give it", change=True)
        if not 0.0 <= value <= signal.span:
            expected = f"{what} from 0 to {_shown(signal, signal.span)}, the width of the range"
            raise table.wrong(key, expected, "correct it")
        return value

    def _level(self, kind: AlarmKind, own: TableReader, key: str) -> dict[str, Any]:
        if kind is AlarmKind.DEVIATION:
            if not self.controlled:
                expected = f"no deviation, since {self.signal.name} has no setpoint"
                raise own.wrong(key, expected, "remove it, or add the sensor to controlled")
            limit = self._change(own, key, "a deviation", self.signal)
        else:
            limit = read_in_range(own, key, self.signal, "an alarm limit", "give it")
        where = self._of(own, "deadband")
        deadband = _DEADBAND * self.signal.span if self.signal.has_range else 0.0
        if where.has("deadband"):
            deadband = self._change(where, "deadband", "a deadband", self.signal)
        elif kind is AlarmKind.DEVIATION:
            deadband = min(deadband, _OF_RATE * limit)
        self._check_returns(kind, where if where.has("deadband") else own, limit, deadband)
        return {"limit": limit, "deadband": deadband, "on_delay": self._delay(own, "on_delay")}

    def _check_returns(
        self, kind: AlarmKind, where: TableReader, limit: float, deadband: float
    ) -> None:
        """Refuse a deadband beyond which the measurement cannot come back."""
        low, high = self.signal.low, self.signal.high
        room = {AlarmKind.DEVIATION: limit, AlarmKind.LOW: high - limit}
        room |= {AlarmKind.LOW_LOW: high - limit}
        if deadband > room.get(kind, limit - low):
            key = "deadband" if where.has("deadband") else kind.key
            expected = f"a deadband that leaves the {kind.words} room to return to normal"
            raise where.wrong(key, expected, "make it smaller, or move the limit")

    def _rate(self, kind: AlarmKind, own: TableReader, key: str) -> dict[str, Any]:
        limit = read_rate(own, key, self.signal, "a rate of change", "give it")
        deadband = _OF_RATE * limit
        # What holds for all limits is no rate.
        if own is not self.table and own.has("deadband"):
            deadband = read_rate(own, "deadband", self.signal, "a deadband", "give it")
            if deadband > limit:
                raise own.wrong("deadband", "a deadband of at most the limit", "make it smaller")
        remedy = "leave it out for none"
        filter_time = 0.0
        if own is not self.table:
            filter_time = own.quantity(
                "filter_time", "s", "a time", remedy, at_least=0.0, default=0.0
            )
        delay = self._delay(own, "on_delay")
        return {
            "limit": limit, "deadband": deadband, "on_delay": delay, "filter_time": filter_time
        }  # fmt: skip

    def _flatline(self, kind: AlarmKind, own: TableReader, key: str) -> dict[str, Any]:
        remedy = "give the time for which it may stand still"
        time = own.quantity(key, "s", "a time", remedy, above=0.0)
        late = self.joined.reporting.get(self.signal.name)
        if late is not None and time <= late.dead_time + late.sampling:
            longest = time_text(late.dead_time + late.sampling)
            expected = f"a time above {longest}, which the sensor can take to report a movement"
            raise own.wrong(key, expected, "lengthen it")
        still, inputs = 0.0, {signal.name: signal for signal in self._reaching()}
        if own is not self.table and own.has("still"):
            still = self._change(own, "still", "a movement", self.signal)
        moves = {name: _MOVE * signal.span for name, signal in inputs.items() if signal.has_range}
        if own is not self.table and own.has("moves"):
            expected = "a movement for each input"
            inner = own.table("moves", expected, f'write as in {{ {next(iter(inputs))} = "2 %" }}')
            moves = {
                name: self._change(inner, name, "a movement", self._input(inner, name))
                for name in inner.present
            }
        if not moves:
            expected = f"no flatline, since no input of the process moves {self.signal.name}"
            raise own.wrong(key, expected, "remove it, or say the inputs that do in moves")
        return {"limit": still, "on_delay": time, "moves": moves}

    def _reaching(self) -> Iterator[Signal]:
        """Yield the inputs that move the measurement, by whatever way."""
        joined = self.joined
        by_state = _pattern(joined.dynamics.jac_sparsity(0, 0))
        by_input = _pattern(joined.dynamics.jac_sparsity(0, 1))
        place = [signal.name for signal in joined.measurements].index(self.signal.name)
        reached = _pattern(joined.measure.jac_sparsity(0, 0))[place]
        for _ in joined.state:
            reached = reached | (reached @ by_state)
        moved = reached @ by_input
        return (u for u, moves in zip(joined.inputs, moved, strict=True) if moves)

    def _interlock(self, own: TableReader) -> dict[str, float]:
        if own is self.table or not own.has("interlock"):
            return {}
        expected = "a value for each input that the alarm holds"
        inner = own.table("interlock", expected, 'write as in { pump_1 = "0 V" }')
        what = "an interlock value"
        return {
            name: read_in_range(inner, name, self._input(inner, name), what, "give it")
            for name in inner.present
        }

    def _input(self, table: TableReader, name: str) -> Signal:
        """Return an input by its name."""
        known = {signal.name: signal for signal in self.joined.inputs}
        if name not in known:
            remedy = suggestion(name, known, f"choose from {', '.join(known)}")
            if name in {signal.name for signal in self.joined.disturbances}:
                remedy = f"list {name} in manipulated, or give a pump a trip_above or trip_below"
            raise table.refused(name, name[:60], "the name of what a controller moves", remedy)
        return known[name]


def _shown(signal: Signal, value: float) -> str:
    number = f"{from_si(value, signal.unit, signal.shown_unit):.6g}"
    return f"{number} {unit_text(signal.shown_unit)}".rstrip()


def _own(kind: AlarmKind) -> tuple[str, ...]:
    return tuple(key for key in _OWN.get(kind, {}) if key != "time")


def _pattern(sparsity: ca.Sparsity) -> np.ndarray:
    found = np.zeros((sparsity.size1(), sparsity.size2()), dtype=bool)
    found[sparsity.row(), sparsity.get_col()] = True
    return found


def _check_order(reader: _Reader, alarms: Sequence[Alarm]) -> None:
    """Refuse limits that do not lie one below the other, from high-high to low-low."""
    limits = {alarm.kind: alarm.limit for alarm in alarms}
    ordered = [kind for kind in LIMITS if kind in limits]
    for upper, lower in pairwise(ordered):
        if limits[upper] <= limits[lower]:
            table, key = reader.where(lower)
            written, limit = table.written(key), _shown(reader.signal, limits[lower])
            expected = f"a limit above that of {lower.key}, {written}"
            expected += f" ({limit})" if written != limit else ""
            table, key = reader.where(upper)
            raise table.wrong(key, expected, "exchange or correct them")


def _check_interlocks(
    document: Document, alarms: Sequence[Alarm], inputs: Mapping[str, Signal]
) -> None:
    """Refuse two interlock values of one input: whichever held it, it would be one of them."""
    held = interlocks(tuple(alarms))
    for alarm in alarms:
        for name, value in alarm.interlock.items():
            if value != held[name]:
                place = document.place(
                    "alarms", alarm.measurement, alarm.kind.key, "interlock", name
                )
                raise InputError(
                    place,
                    _shown(inputs[name], value),
                    f"the value of every other interlock of {name}, "
                    f"{_shown(inputs[name], held[name])}",
                    "hold an input at one value, whichever alarm does",
                )
