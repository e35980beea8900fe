"""The parts of a control scheme as a study file writes them: loops, selectors, splits, …"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.selector_block import Selection
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, checked_name
from clepsydra.studies.file.gains import check_in_range, read_value
from clepsydra.studies.file.pid_table import LOOP_KEYS, read_form

SELECTOR_KEYS = ("select", "output")
SPLIT_KEYS = ("parts",)
PART_KEYS = ("output", "from", "to", "at_from", "at_to")
RATIO_KEYS = ("measurement", "ratio", "lowest_ratio", "highest_ratio", "output")
FEEDFORWARD_KEYS = ("measurement", "to", "gain", "lead", "lag", "reference")
OUTPUT_KEYS = ("low", "high", "rate_limit")


@dataclass(frozen=True)
class Loop:
    """A PID loop.

    Parameters
    ----------
    table : TableReader
    name : str
    form : PidForm
    measurement : Signal
    setpoint : float or None
        A fixed one [measurement unit]; None for the operator's, or another loop's.
    output : str
        As written.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    name: str
    form: PidForm
    measurement: Signal
    setpoint: float | None
    output: str


@dataclass(frozen=True)
class Selector:
    """The lowest or highest of what several loops ask for.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    name: str
    selection: Selection
    output: str


@dataclass(frozen=True)
class SplitPart:
    """One actuator of a split range; from and to in percent, 0 to 100.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    output: str
    start: float
    end: float


@dataclass(frozen=True)
class Split:
    """A split range.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    name: str
    parts: tuple[SplitPart, ...]


@dataclass(frozen=True)
class Ratio:
    """A flow in proportion to a wild one.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    name: str
    wild: Signal
    output: str


@dataclass(frozen=True)
class Feedforward:
    """What a measurement adds to what another part asks for.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    name: str
    signal: Signal
    to: str


@dataclass(frozen=True)
class SchemeParts:
    """Everything that a scheme is made of.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    table: TableReader
    process: Process
    loops: tuple[Loop, ...]
    selectors: tuple[Selector, ...]
    splits: tuple[Split, ...]
    ratios: tuple[Ratio, ...]
    feedforwards: tuple[Feedforward, ...]
    outputs: dict[str, TableReader]


def read_parts(table: TableReader, process: Process) -> SchemeParts:
    """Read the parts of a control scheme, each by itself.

    Raises
    ------
    InputError
        A key or name is unknown, missing or wrong.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """
    return SchemeParts(
        table=table,
        process=process,
        loops=tuple(_loop(row, name, process) for name, row in _rows(table, "loops", LOOP_KEYS)),
        selectors=tuple(
            _selector(row, name, process) for name, row in _rows(table, "selectors", SELECTOR_KEYS)
        ),
        splits=tuple(
            _split(row, name, process) for name, row in _rows(table, "split_ranges", SPLIT_KEYS)
        ),
        ratios=tuple(
            Ratio(row, name, _measurement(row, process), _output(row, process))
            for name, row in _rows(table, "ratios", RATIO_KEYS)
        ),
        feedforwards=tuple(
            Feedforward(row, name, _measurement(row, process), _adds_to(row, table))
            for name, row in _rows(table, "feedforward", FEEDFORWARD_KEYS)
        ),
        outputs=_outputs(table, process),
    )


def _rows(table: TableReader, key: str, keys: Iterable[str]) -> list[tuple[str, TableReader]]:
    """Return the tables below a key by name."""
    if not table.has(key):
        return []
    expected, remedy = "tables with a name each", f"write as in {table_name(key)}"
    rows = table.table(key, expected, remedy)
    found = []
    for name in rows.present:
        checked_name(name, rows.place(name))
        found.append((name, rows.table(name, "a table", remedy, keys)))
    return found


def table_name(key: str) -> str:
    """Return how the tables below a key are written.

    Examples
    --------
    >>> table_name("loops")
    '[controllers.NAME.loops.NAME]'
    """
    return f"[controllers.NAME.{key}.NAME]"


def _loop(table: TableReader, name: str, process: Process) -> Loop:
    form = read_form(table)
    measurement = _measurement(table, process)
    return Loop(
        table,
        name,
        form,
        measurement,
        _setpoint(table, measurement, form),
        _output(table, process),
    )


def _setpoint(table: TableReader, measurement: Signal, form: PidForm) -> float | None:
    """Return a fixed setpoint, or None where someone else gives it."""
    if not table.has("setpoint") or table.raw("setpoint") == "operator":
        return None
    remedy = 'leave it out where the operator gives it, or write a value, as in setpoint = "60 %"'
    value = read_value(table, "setpoint", measurement, "a fixed setpoint", remedy)
    check_in_range(table, "setpoint", measurement, value, "a setpoint")
    if form.remote_setpoint:
        raise table.refused(
            "remote_setpoint", "true", "no fixed setpoint beside it", "leave one of the two out"
        )
    return value


def _selector(table: TableReader, name: str, process: Process) -> Selector:
    if not table.has("select"):
        raise table.refused("select", "no select", "low or high", 'write as in select = "low"')
    lowest = table.choice("select", ("low", "high"), "low") == "low"
    return Selector(table, name, "low" if lowest else "high", _output(table, process))


def _split(table: TableReader, name: str, process: Process) -> Split:
    remedy = (
        'write as in parts = [{ output = "inlet", from = "0 %", to = "50 %", '
        'at_from = "100 %", at_to = "0 %" }, …]'
    )
    rows = table.tables("parts", "a list of two or more parts of the range", remedy, PART_KEYS)
    if len(rows) < 2:
        raise table.refused(
            "parts", len(rows), "two or more parts of the range, one for each actuator", remedy
        )
    parts: list[SplitPart] = []
    for row in rows:
        start, end = (
            100.0
            * row.quantity(
                key, "1", "a share of the range", 'give it from "0 %" to "100 %"',
                at_least=0.0, at_most=1.0,
            )
            for key in ("from", "to")
        )  # fmt: skip
        if not start < end:
            raise row.refused(
                "to", row.written("to"), "the end of the part above its start", "exchange them"
            )
        for other in parts:
            if start < other.end and other.start < end:
                raise row.refused(
                    "from",
                    row.written("from"),
                    f"a part that does not overlap that of {other.output}, "
                    f"{other.start:g} to {other.end:g} %",
                    "let one begin where the other ends",
                )
        parts.append(SplitPart(row, _output(row, process), start, end))
    return Split(table, name, tuple(parts))


def _outputs(table: TableReader, process: Process) -> dict[str, TableReader]:
    if not table.has("outputs"):
        return {}
    known = [signal.name for signal in process.inputs]
    rows = table.table(
        "outputs", "tables of manipulated variables", f"write {table_name('outputs')}", known
    )
    return {
        name: rows.table(name, "a table", "write its keys", OUTPUT_KEYS) for name in rows.present
    }


def _measurement(table: TableReader, process: Process) -> Signal:
    known = {signal.name: signal for signal in process.measurements}
    remedy = f'write as in measurement = "{next(iter(known))}"'
    name = table.text("measurement", "the sensor that it reads", remedy)
    if name not in known:
        raise table.refused(
            "measurement",
            name[:60],
            f"a sensor of {process.name} ({', '.join(known)})",
            suggestion(name, known, "choose one of them"),
        )
    return known[name]


def _output(table: TableReader, process: Process) -> str:
    remedy = f'write the name of one, as in output = "{process.inputs[0].name}"'
    return table.text("output", "what it moves", remedy)


def _adds_to(table: TableReader, parts: TableReader) -> str:
    """Return the loop, selector or ratio that a feedforward adds to."""
    names = [
        name
        for key in ("loops", "selectors", "ratios")
        if parts.has(key)
        for name in parts.table(key, "tables with a name each", f"write {table_name(key)}").present
    ]
    words = f"the loop, selector or ratio that it adds to ({', '.join(names) or 'none here'})"
    return table.text("to", words, f'write as in to = "{names[0]}"' if names else "add a loop")
