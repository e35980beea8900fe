"""The parts of a control scheme as a study file writes them: loops, selectors, splits, …"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.selector_block import Selection
from clepsydra.process import told
from clepsydra.process.declared import OWN, keys_of, part, read_fields, table_schema
from clepsydra.process.signal_values import read_in_range, read_rate
from clepsydra.process.table_reader import TableReader, checked_name
from clepsydra.studies.file.fields import Gain, Value, gain_between, moved, sensor, value_in_range
from clepsydra.studies.file.pid_table import SETTINGS, read_form
from clepsydra.studies.file.written import Written

_PART = "its part of the range"
_THERE = "values of what it moves, there and beyond"
_ENDS = "give the ends between which the loop may trim it"
_TRIMMED = "where a loop has the ratio as its `output`: between which values it may trim it"


def _setpoint(table: TableReader, key: str, known: Mapping[str, Any]) -> float | None:
    """Return a fixed setpoint, or None where someone else gives it."""
    if not table.has(key) or table.raw(key) == "operator":
        return None
    remedy = 'leave it out where the operator gives it, or write a value, as in setpoint = "60 %"'
    value = read_in_range(table, key, known["measurement"], "a setpoint", remedy)
    if known["form"].remote_setpoint:
        raise table.refused(
            "remote_setpoint", "true", "no fixed setpoint beside it", "leave one of the two out"
        )
    return value


def _selection(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
    if not table.has(key):
        raise table.wrong(key, "low or high", 'write as in select = "low"')
    return table.choice(key, get_args(Selection), "low")


def _span(table: TableReader, name: str, known: Mapping[str, Any]) -> tuple[float, float]:
    """Return start and end of a part [%]."""
    remedy = 'give it from "0 %" to "100 %"'
    start, end = (
        100.0 * table.quantity(key, "1", "a share of the range", remedy, at_least=0.0, at_most=1.0)
        for key in ("from", "to")
    )
    if not start < end:
        raise table.wrong("to", "the end of the part above its start", "exchange them")
    return start, end


@dataclass(frozen=True)
class Part(ABC):
    """A part of a scheme that moves something."""

    table: TableReader
    name: str

    @property
    def kind(self) -> str:
        """What it is: loop, selector, split or ratio."""
        return type(self).__name__.lower()

    @property
    def label(self) -> str:
        """What its block is called."""
        return f"{self.kind} {self.name}"

    @property
    @abstractmethod
    def moves(self) -> tuple[tuple[TableReader, str], ...]:
        """What it moves, and the table in which that was written as `output`."""


@dataclass(frozen=True)
class Mover(Part):
    """A part that moves one thing."""

    output: str = moved()

    @property
    def moves(self) -> tuple[tuple[TableReader, str], ...]:
        """What it moves, in its own table."""
        return ((self.table, self.output),)


@dataclass(frozen=True)
class Loop(Mover):
    """A PID loop; a fixed setpoint [measurement unit] is None for the operator's or a loop's."""

    output: str = moved(
        "what it moves: a manipulated variable, a selector, split range or ratio by its name, or "
        'the setpoint of another loop, `"flow.setpoint"`'
    )
    form: PidForm = part(read_form, table_schema(PidForm)["properties"], required=("actions",))
    measurement: Signal = sensor("the sensor that it reads")
    setpoint: float | None = part(_setpoint, **told.quantity('`"operator"`, or a fixed value'))
    settings: TableReader = part(
        lambda table, key, known: table, SETTINGS, required=("action", "gain")
    )


@dataclass(frozen=True)
class Selector(Mover):
    """The lowest or highest of what several loops ask for."""

    select: Selection = part(
        _selection,
        required=(OWN,),
        **told.choice('`"low"` or `"high"`', get_args(Selection)),
    )


@dataclass(frozen=True)
class Leg:
    """A part of a split range: start and end [%], and what it moves has which values there."""

    table: TableReader
    output: str = moved()
    span: tuple[float, float] = part(
        _span,
        {"from": told.quantity(_PART), "to": told.quantity(_PART)},
        required=("from", "to"),
    )
    at_from: Value = value_in_range(_THERE, "a value", "give {signal} there", required=True)
    at_to: Value = value_in_range(_THERE, "a value", "give {signal} there", required=True)


def _legs(table: TableReader, name: str, known: Mapping[str, Any]) -> tuple[Leg, ...]:
    remedy = (
        'write as in parts = [{ output = "inlet", from = "0 %", to = "50 %", '
        'at_from = "100 %", at_to = "0 %" }, …]'
    )
    expected = "a list of two or more parts of the range"
    rows = table.tables("parts", expected, remedy, keys_of(Leg))
    if len(rows) < 2:
        raise table.refused(
            "parts", len(rows), "two or more parts of the range, one for each actuator", remedy
        )
    legs: list[Leg] = []
    for row in rows:
        leg = Leg(row, **read_fields(Leg, row, process=known["process"]))
        for other in legs:
            low, high = other.span
            if leg.span[0] < high and low < leg.span[1]:
                raise row.wrong(
                    "from",
                    f"a part that does not overlap that of {other.output}, {low:g} to {high:g} %",
                    "let one begin where the other ends",
                )
        legs.append(leg)
    return tuple(legs)


@dataclass(frozen=True)
class Split(Part):
    """A split range of several parts."""

    legs: tuple[Leg, ...] = part(
        _legs,
        {
            "parts": told.listed(
                "list of two or more parts that do not overlap", table_schema(Leg), least=2
            )
        },
        required=("parts",),
    )

    @property
    def moves(self) -> tuple[tuple[TableReader, str], ...]:
        """What each of its parts moves."""
        return tuple((leg.table, leg.output) for leg in self.legs)


@dataclass(frozen=True)
class Ratio(Mover):
    """A flow in proportion to a wild one."""

    output: str = moved("what follows it, as of a loop")
    wild: Signal = sensor("the sensor of the wild flow")
    ratio: Gain = gain_between(
        "what is moved per measurement, as a gain", "a ratio", "give what is moved per measurement"
    )
    lowest_ratio: Gain = gain_between(_TRIMMED, "a ratio", _ENDS)
    highest_ratio: Gain = gain_between(_TRIMMED, "a ratio", _ENDS)


def _lag(beside: str) -> Any:
    """Return the field of a time that has a meaning only beside another one."""
    return quantity(
        "s",
        "a time",
        at_least=0.0,
        needs=beside,
        required=True,
        remedy="give both lead and lag, or neither",
    )


def _target(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
    targets = [each.name for kind in ("loops", "selectors", "ratios") for each in known[kind]]
    expected = f"the loop, selector or ratio that it adds to ({', '.join(targets) or 'none here'})"
    return table.text(
        key, expected, f'write as in to = "{targets[0]}"' if targets else "add a loop"
    )


@dataclass(frozen=True)
class Feedforward:
    """What a measurement adds to what another part asks for; lead and lag [s] or None."""

    table: TableReader
    name: str
    signal: Signal = sensor("the sensor of the disturbance")
    to: str = part(
        _target,
        required=(OWN,),
        **told.text("the loop, selector or ratio that it adds to"),
    )
    gain: Gain = gain_between(
        "with its sign", "a gain", "give the change of {moved} per {measured}", required=True
    )
    lead: float | None = _lag(beside="lag")
    lag: float | None = _lag(beside="lead")
    reference: Value | None = value_in_range(
        "where it adds nothing", "a reference", "leave it out for the operating point"
    )


def _rate_limit(table: TableReader, key: str, known: Mapping[str, Any]) -> Value | None:
    if not table.has(key):
        return None
    return lambda signal: read_rate(table, key, signal, "a rate of change", "give the fastest")


@dataclass(frozen=True)
class Output:
    """What narrows a manipulated variable."""

    table: TableReader
    name: str
    low: Value | None = value_in_range("limits", "a limit", "leave it out for the range")
    high: Value | None = value_in_range("limits", "a limit", "leave it out for the range")
    rate_limit: Value | None = part(_rate_limit, **told.text('fastest change, `"10 %/min"`'))


def _parts(kind: type, words: str, *, of_inputs: bool = False) -> Any:
    """Return the field of tables with names, one's own or those of inputs, each of a kind."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[Any, ...]:
        if not table.has(key):
            return ()
        remedy = f"write as in [controllers.NAME.{key}.NAME]"
        expected, names = "tables with a name each", None
        if of_inputs:
            expected = "tables of manipulated variables"
            names = [signal.name for signal in known["process"].inputs]
        rows = table.table(key, expected, remedy, names)
        found = []
        for name in rows.present:
            checked_name(name, rows.place(name))
            row = rows.table(name, "a table", remedy, keys_of(kind))
            found.append(kind(row, name, **read_fields(kind, row, **known)))
        return tuple(found)

    return part(read, **told.by_name(words, table_schema(kind)))


@dataclass(frozen=True)
class SchemeParts(Written):
    """Everything that a scheme is made of, each part read by itself."""

    loops: tuple[Loop, ...] = _parts(Loop, "loops")
    selectors: tuple[Selector, ...] = _parts(Selector, "selectors")
    split_ranges: tuple[Split, ...] = _parts(Split, "split ranges")
    ratios: tuple[Ratio, ...] = _parts(Ratio, "ratios")
    feedforward: tuple[Feedforward, ...] = _parts(Feedforward, "feedforward")
    outputs: tuple[Output, ...] = _parts(Output, "outputs", of_inputs=True)
