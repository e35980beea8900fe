"""Profiles of inputs and disturbances from a CSV file."""

from __future__ import annotations

import math
from pathlib import Path

from clepsydra.base.csv_table import csv_head, csv_numbers, csv_rows
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import to_si
from clepsydra.loop.profile import Change, check_range, outside_signal
from clepsydra.process.process import Process

#: Each row becomes a change of each signal; of so many, this takes seconds.
_MOST_ROWS = 200_000
_GAP = "fill the gap; a value is held until the next row"


def read_profile_csv(path: str | Path, process: Process) -> list[Change]:
    """Read the values of signals over time; each is held until the next row.

    The head names time and signals with their units: ``time [min],pump_1 [V]``. Columns are
    separated by commas or semicolons; numbers have a decimal point.

    Parameters
    ----------
    path : str or Path
    process : Process

    Returns
    -------
    list of Change
        Steps in order of time, for each signal one a row.

    Raises
    ------
    InputError
        The file cannot be read, or one of its cells cannot be used: its line and column are
        named.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.process.reader import load_process
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "pump.csv")
    ...     _ = path.write_text("time [min],pump_1 [V]\\n0,3\\n1,3.5\\n")
    ...     changes = read_profile_csv(path, load_process("quadruple-tank"))
    >>> changes[1].start, changes[1].value
    (60.0, 3.5)
    """
    file = Path(path)
    head, *rows = csv_rows(file, _MOST_ROWS)
    signals, units = _head(file, *head, process)
    names = ["time", *(signal.name for signal in signals)]
    factors = [
        to_si(f"1 {unit}", to, str(file))
        for unit, to in zip(units, ["s", *(signal.unit for signal in signals)], strict=True)
    ]
    numbers = csv_numbers(rows, names, file, _GAP) * factors
    changes: list[Change] = []
    last = -math.inf
    for (line, cells), (time, *values) in zip(rows, numbers.tolist(), strict=True):
        if time < 0.0 or time <= last:
            expected = "a time from 0 s on" if time < 0.0 else "a time after that of the last row"
            raise InputError(
                f"{file}, line {line}, column 'time'",
                f"{cells[0].strip()} {units[0]}",
                expected,
                "sort the rows by time, with one row for each time",
            )
        last = time
        for signal, value in zip(signals, values, strict=True):
            place = f"{file}, line {line}, column '{signal.name}'"
            check_range(signal, value, place)
            changes.append(Change(signal.name, value, time, time, place))
    return changes


def _head(
    file: Path, line: int, cells: list[str], process: Process
) -> tuple[list[Signal], list[str]]:
    """Return the signals, and the unit of every column."""
    place = f"{file}, line {line}"
    (_, time_unit), *others = csv_head(cells, place)
    units = [time_unit or ""]
    to_si(f"1 {time_unit}", "s", f"{place}, column 'time'")
    signals: list[Signal] = []
    for number, (name, unit) in enumerate(others, 2):
        signal = outside_signal(name, process, f"{place}, column {number}")
        where = f"{place}, column '{name}'"
        if signal in signals:
            raise InputError(where, name, "each signal once", "take one of the two columns out")
        if not unit and signal.unit != "1":
            raise InputError(
                where, name, f"its unit in brackets, as in {name} [{signal.shown_unit}]",
                "write the unit of the numbers",
            )  # fmt: skip
        units.append("" if unit is None or unit == "1" else unit)
        to_si(f"1 {units[-1]}", signal.unit, where)
        signals.append(signal)
    return signals, units
