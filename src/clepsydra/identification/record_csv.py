"""A record from a CSV file, such as a logger or ``clepsydra simulate`` writes."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.csv_table import csv_head, csv_numbers, csv_rows
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, to_si
from clepsydra.identification.record import MOST_ROWS, Record, sampling_period
from clepsydra.process.process import Process

#: Units that the house counts in; of any other kind of quantity numbers stay as written.
_SI = ("m", "V", "1", "m^3/s", "A", "m^3", "m^2", "s", "kg/m^3", "mol/m^3", "K", "Pa", "kg/s")
_GAP = "fill the gap, or cut the record there: nothing is interpolated"


def read_record(path: str | Path, process: Process | None = None) -> Record:
    """Read a record from a CSV file.

    The head names time and signals with their units: ``time [s],pump_1 [V],level_1 [cm]``.
    Columns are separated by commas or semicolons; numbers have a decimal point. Rows follow each
    other regularly; an input is held from its row to the next.

    Parameters
    ----------
    path : str or Path
    process : Process, optional
        Whose signals have names and units of their own.

    Raises
    ------
    InputError
        The file cannot be read, a cell is empty or no number, a column appears twice or has no
        unit, time is irregular, or there are fewer than 30 rows or more than 100,000: line and
        column are named.

    Examples
    --------
    >>> import tempfile
    >>> rows = "".join(f"{k},{3 + k % 2},{12 + k}\\n" for k in range(40))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "tank.csv")
    ...     _ = path.write_text("time [min],pump [V],level [cm]\\n" + rows)
    ...     record = read_record(path)
    >>> record.period, record.signals[1].unit, float(record.values["level"][0])
    (60.0, 'm', 0.12)
    """
    file = Path(path)
    if file.suffix.lower() == ".parquet":
        raise InputError(str(file), "a Parquet file", "a CSV file", "write it with --format csv")
    (line, head), *rows = csv_rows(file, MOST_ROWS)
    fields = csv_head(head, f"{file}, line {line}")
    names = [name for name, _ in fields]
    signals, factors = _signals(fields, f"{file}, line {line}", process)
    lines = [line for line, _ in rows]
    numbers = csv_numbers(rows, names, file, _GAP)
    time = numbers[:, 0] * to_si(f"1 {fields[0][1]}", "s", f"{file}, column 'time'")
    if len(time) < 2:
        raise InputError(str(file), "1 row", "rows of numbers", "record for longer")
    period = sampling_period(time, lambda row: f"{file}, line {lines[row]}, column 'time'")
    values = {signal.name: numbers[:, at] * factors[at - 1] for at, signal in enumerate(signals, 1)}
    return Record(str(file), tuple(signals), values, period, float(time[0]))


def _signals(
    fields: list[tuple[str, str | None]], place: str, process: Process | None
) -> tuple[list[Signal], list[float]]:
    """Return the signals and what one of their written units is in SI."""
    to_si(f"1 {fields[0][1]}", "s", f"{place}, column 'time'")
    known = {}
    if process is not None:
        groups = (process.state, process.inputs, process.disturbances, process.measurements)
        known = {signal.name: signal for group in groups for signal in group}
    signals: list[Signal] = []
    factors = []
    for number, (name, written) in enumerate(fields[1:], 2):
        where = f"{place}, column '{name}'"
        if not name:
            raise InputError(
                f"{place}, column {number}", "", "a name", "name every column, as in pump_1 [V]"
            )
        if name in [signal.name for signal in signals]:
            raise InputError(where, name, "each signal once", "take one of the two columns out")
        of_process = known.get(name)
        if not written and not (of_process and of_process.unit == "1"):
            unit = of_process.shown_unit if of_process else "V"
            raise InputError(
                where, name, f"its unit in brackets, as in {name} [{unit}]",
                "write the unit of the numbers, [1] for a pure number",
            )  # fmt: skip
        unit = written or "1"
        signal = of_process or _signal(name, unit, where)
        plain = "" if unit == "1" else f" {unit}"
        factors.append(to_si(f"1{plain}", signal.unit, where))
        signals.append(signal)
    return signals, factors


def _signal(name: str, unit: str, place: str) -> Signal:
    """Return a signal that is known by its column only."""
    if unit == "1":
        return Signal(name)
    for si in _SI:
        if convertible(unit, si):
            return Signal(name, si, display_unit=unit)
    try:
        to_si(f"1 {unit}", unit, place)
    except InputError:
        raise InputError(
            place, unit, "a unit that is known", "write it as in [cm], [l/min] or [%]"
        ) from None
    return Signal(name, unit)
