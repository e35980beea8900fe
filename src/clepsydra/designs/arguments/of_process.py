"""Arguments that name signals of the process, or are values of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from clepsydra.base.errors import Finding
from clepsydra.base.signal import Signal
from clepsydra.designs.arguments.argument import Argument, argument
from clepsydra.designs.request import positive_number
from clepsydra.process.known_names import known_name, known_names
from clepsydra.process.signal_values import read_value

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader


def _pairs(table: TableReader, key: str, process: Process) -> tuple[tuple[str, str], ...]:
    """Read which input moves which controlled measurement."""
    remedy = f'write as in pairing = {{ {process.controlled[0]} = "{process.inputs[0].name}" }}'
    inputs = [signal.name for signal in process.inputs]
    rows = table.table(key, "controlled measurements, each with its input", remedy)
    pairs: list[tuple[str, str]] = []
    for output in rows.present:
        each = f"a controlled measurement of {process.name}"
        known_name(rows, output, output, process.controlled, each)
        moved = rows.name(output, "the name of an input")
        known_name(rows, output, moved, inputs, f"an input of {process.name}")
        for other, taken in pairs:
            if taken == moved:
                expected = f"an input of its own: {moved} moves {other} already"
                raise rows.refused(output, moved, expected, "pair each input once")
        pairs.append((output, moved))
    if not pairs:
        raise table.refused(key, Finding("no pair"), "at least one pair", remedy)
    return tuple(pairs)


def largest_deviations(name: str, words: str, *, of_inputs: bool) -> Argument:
    """Return an argument that is a largest deviation of some signals [their units]."""
    each = "an input" if of_inputs else "a controlled measurement"

    def read(table: TableReader, key: str, process: Process) -> dict[str, float]:
        known = [u.name for u in process.inputs] if of_inputs else list(process.controlled)
        remedy = f'write as in {{ {known[0]} = "10 %" }}'
        rows = table.table(key, "signals with their largest deviation", remedy)
        found = {}
        for signal in rows.present:
            known_name(rows, signal, signal, known, f"{each} of {process.name}")
            found[signal] = _positive(rows, signal, process.signal(signal), remedy)
        return found

    return argument(name, read, words, _OF_SIGNALS, "of signals")


def one_deviation(name: str, words: str) -> Argument:
    """Return an argument that is one deviation for all controlled measurements, of one unit."""

    def read(table: TableReader, key: str, process: Process) -> float:
        signals = [process.signal(name) for name in process.controlled]
        if len({(signal.unit, signal.low, signal.high) for signal in signals}) > 1:
            names = ", ".join(process.controlled)
            expected = f"no one {key} for {names}, which differ in unit or range"
            raise table.wrong(key, expected, "leave it out, or give a time instead")
        return _positive(table, key, signals[0], 'write as in "20 %" of the range')

    def check(value: Any) -> None:
        positive_number(name, value, "a deviation above 0", "give it in the output's unit")

    kind = {"type": ["string", "number"]}
    return argument(name, read, words, kind, "of signals", check)


def _positive(table: TableReader, key: str, signal: Signal, remedy: str) -> float:
    value = read_value(table, key, signal, "a deviation", remedy, change=True)
    if not value > 0.0:
        raise table.wrong(key, "a deviation above 0", remedy)
    return value


def _sensors(table: TableReader, key: str, process: Process) -> tuple[str, ...]:
    known = [signal.name for signal in process.measurements]
    remedy, each = f'write as in ["{known[0]}"]', "the name of a sensor"
    return known_names(known, table, key, expected="a list of sensors", remedy=remedy, each=each)


def _controlled(table: TableReader, key: str, process: Process) -> str:
    """Read the name of a controlled measurement."""
    name = table.text(key, "a controlled measurement", f'write as in "{process.controlled[0]}"')
    known_name(table, key, name, process.controlled, f"a controlled measurement of {process.name}")
    return name


def _values_of(over: str) -> Argument:
    """Return the operating points of a schedule, quantities of the measurement that it is over."""

    def read(table: TableReader, key: str, process: Process) -> list[float]:
        name = _controlled(table, over, process)
        signal = process.signal(name)
        remedy = f'write as in ["10 {signal.shown_unit}"]'
        written = table.raw(key)
        if not isinstance(written, list) or not written:
            raise table.wrong(key, f"a list of values of {name}", remedy)
        entries = [table.with_value(key, entry) for entry in written]
        return [read_value(entry, key, signal, "a value", remedy) for entry in entries]

    words = "list of values of what a schedule is over"
    schema = {"type": "array", "items": {"type": ["string", "number"]}}
    return argument("points", read, words, schema, "of signals")


_OF_SIGNALS = {"type": "object", "additionalProperties": {"type": ["string", "number"]}}
PAIRING = argument(
    "pairing",
    _pairs,
    "table of controlled measurements, each with its input; as the relative gains suggest if left "
    "out",
    {"type": "object", "additionalProperties": {"type": "string"}},
)
MEASUREMENTS = argument(
    "measurements",
    _sensors,
    "list of sensors that a filter or an observer reads",
    {"type": "array", "items": {"type": "string"}},
)
OVER = argument(
    "over", _controlled, "the controlled measurement that a schedule is over", {"type": "string"}
)
POINTS = _values_of("over")
