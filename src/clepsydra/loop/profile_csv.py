"""Profiles of inputs and disturbances from a CSV file."""

from __future__ import annotations

import csv
import io
import math
import re
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import split_quantity, to_si
from clepsydra.loop.profile import Change, check_range, outside_signal
from clepsydra.process.process import Process

_HEADER = re.compile(r"\s*(.*?)\s*(?:\[\s*(.*?)\s*\]\s*)?")
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+\s*")
_HEAD_EXAMPLE = "write a head such as time [s],pump_1 [V]"


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
    rows = _rows(file, _text(file))
    signals, units = _head(file, *rows[0], process)
    changes: list[Change] = []
    last = -math.inf
    for line, cells in rows[1:]:
        if len(cells) != len(units):
            raise InputError(
                f"{file}, line {line}",
                f"{len(cells)} fields",
                f"{len(units)} fields, as in the head",
                "fill every column; a decimal comma has to be a point",
            )
        time = _number(cells[0], units[0], "s", f"{file}, line {line}, column 'time'")
        if time < 0.0 or time <= last:
            expected = "a time from 0 s on" if time < 0.0 else "a time after that of the last row"
            raise InputError(
                f"{file}, line {line}, column 'time'",
                f"{cells[0].strip()} {units[0]}",
                expected,
                "sort the rows by time, with one row for each time",
            )
        last = time
        for signal, unit, cell in zip(signals, units[1:], cells[1:], strict=True):
            place = f"{file}, line {line}, column '{signal.name}'"
            value = _number(cell, unit, signal.unit, place)
            check_range(signal, value, place)
            changes.append(Change(signal.name, value, time, time, place))
    return changes


def _text(file: Path) -> str:
    try:
        return file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            str(file), f"byte {error.start + 1} that is no UTF-8", "a text file in UTF-8",
            "save it as CSV in UTF-8",
        ) from None  # fmt: skip
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(str(file), reason.lower(), "a CSV file", "check the path") from None


def _rows(file: Path, text: str) -> list[tuple[int, list[str]]]:
    """Return the line number and the cells of each row; there are at least a head and a row."""
    head = text.partition("\n")[0]
    separator = ";" if ";" in head else ","
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    rows = []
    try:
        for cells in reader:
            rows.append((reader.line_num, cells))
    except csv.Error as error:
        raise InputError(
            f"{file}, line {reader.line_num}", str(error), "a row of CSV", "check the quotes"
        ) from None
    while rows and not any(cell.strip() for cell in rows[-1][1]):
        rows.pop()
    if not rows:
        raise InputError(str(file), "an empty file", "a head and rows of numbers", _HEAD_EXAMPLE)
    if len(rows) == 1:
        raise InputError(
            str(file), "a head without rows", "at least one row of numbers", "add the values"
        )
    return rows


def _head(
    file: Path, line: int, cells: list[str], process: Process
) -> tuple[list[Signal], list[str]]:
    """Return the signals, and the unit of every column."""
    place = f"{file}, line {line}"
    fields = [match.groups() for cell in cells if (match := _HEADER.fullmatch(cell))]
    if len(fields) != len(cells) or len(fields) < 2:
        raise InputError(
            place, ", ".join(cells)[:60], "a time and at least one signal, separated by , or ;",
            _HEAD_EXAMPLE,
        )  # fmt: skip
    (first, unit), *others = fields
    if first.lower() != "time" or not unit:
        raise InputError(
            f"{place}, column 1", cells[0].strip()[:60], "the time with its unit", _HEAD_EXAMPLE
        )
    units = [unit]
    to_si(f"1 {unit}", "s", f"{place}, column 'time'")
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
        units.append("" if unit in (None, "1") else unit)
        to_si(f"1 {units[-1]}", signal.unit, where)
        signals.append(signal)
    return signals, units


def _number(cell: str, unit: str, to: str, place: str) -> float:
    parts = split_quantity(cell)
    if not cell.strip():
        raise InputError(place, "", "a number", "fill the gap; a value is held until the next row")
    if _DECIMAL_COMMA.fullmatch(cell):
        raise InputError(
            place, cell.strip(), "a decimal point", "write 3.5 instead of 3,5 throughout the file"
        )
    if parts is None or parts[1]:
        remedy = "the unit stands in the head only" if parts else "correct the cell"
        raise InputError(place, cell.strip()[:40], "a number", remedy)
    if not math.isfinite(float(parts[0])):
        raise InputError(place, cell.strip(), "a finite number", "replace it by a measured value")
    return to_si(f"{parts[0]} {unit}", to, place)
