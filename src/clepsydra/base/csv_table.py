"""A table of numbers over time as CSV: its rows, its head, and what is wrong with a cell."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import input_text, read_input
from clepsydra.base.signal import Signal
from clepsydra.base.units import split_quantity, to_si

_EXPECTED = "a CSV file"
_LARGEST, _LONGEST_LINE = 200_000_000, 100_000
#: What no table holds, and a terminal would obey.
_CONTROL = re.compile(r"[^\t\n\r -~\xa0-\U0010ffff]")
_HEADER = re.compile(r"\s*(.*?)\s*(?:\[\s*(.*?)\s*\]\s*)?")
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+\s*")
_HEAD_EXAMPLE = "write a head such as time [s],pump_1 [V]"

#: Takes a name, its unit, where the head stands and the number of the column.
SignalOf = Callable[[str, str | None, str, int], Signal]


class CsvTable(NamedTuple):
    """Signals over time as a file has them, with the line and the cells of each row."""

    file: Path
    rows: list[tuple[int, list[str]]]
    time_unit: str
    time: np.ndarray  # [s]
    signals: list[Signal]
    values: np.ndarray  # [rows, signals], SI

    def place(self, row: int, column: str = "time") -> str:
        """Return where a cell stands, for messages."""
        return f"{self.file}, line {self.rows[row][0]}, column '{column}'"


def read_csv(file: Path, most_rows: int, gap: str, signal_of: SignalOf) -> CsvTable:
    """Read a file whose head names time and signals with their units.

    Parameters
    ----------
    most_rows : int
        Without the head.
    gap : str
        What to do about an empty cell.
    signal_of : callable
        Takes name and unit of a column, the place of the head and the number of the column, and
        returns the signal or refuses the column.

    Raises
    ------
    InputError
        As by `csv_rows`, `csv_head` and `csv_numbers`; or a column has no unit or one of something
        else, or names a signal again.
    """
    (line, cells), *rows = csv_rows(file, most_rows)
    head = f"{file}, line {line}"
    (time, time_unit), *columns = csv_head(cells, head)
    factors = [to_si(f"1 {time_unit}", "s", f"{head}, column 'time'")]
    signals: list[Signal] = []
    for number, (name, unit) in enumerate(columns, 2):
        where = f"{head}, column '{name}'"
        if name in [signal.name for signal in signals]:
            raise InputError(where, name, "each signal once", "take one of the two columns out")
        signal = signal_of(name, unit, head, number)
        if not unit and signal.unit != "1":
            raise InputError(
                where, name, f"its unit in brackets, as in {name} [{signal.shown_unit}]",
                "write the unit of the numbers",
            )  # fmt: skip
        factors.append(to_si(f"1 {unit}" if unit and unit != "1" else "1", signal.unit, where))
        signals.append(signal)
    names = [time, *(signal.name for signal in signals)]
    numbers = csv_numbers(rows, names, file, gap) * factors
    return CsvTable(file, rows, time_unit or "", numbers[:, 0], signals, numbers[:, 1:])


def csv_rows(file: Path, most_rows: int) -> list[tuple[int, list[str]]]:
    """Return the line number and the cells of each row; there are at least a head and a row.

    Columns are separated by commas, or by semicolons where the head has one.

    Parameters
    ----------
    most_rows : int
        Without the head.

    Raises
    ------
    InputError
        The file is no regular one, cannot be read, is too large, is no text, is empty or has only
        a head, or a quote is never closed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "pump.csv")
    ...     _ = file.write_text("time [s],pump_1 [V]\\n0,3\\n\\n")
    ...     csv_rows(file, most_rows=100)
    [(1, ['time [s]', 'pump_1 [V]']), (2, ['0', '3'])]
    """
    content = read_input(file, _EXPECTED, _LARGEST, inside="the .csv file")
    text = input_text(content, str(file), _EXPECTED, _LONGEST_LINE).replace("\r", "\n").rstrip()
    if not text:
        raise InputError(
            str(file), Finding("an empty file"), "a head and rows of numbers", _HEAD_EXAMPLE
        )
    odd = _CONTROL.search(text)
    if odd:
        raise InputError(
            f"{file}, line {text.count(chr(10), 0, odd.start()) + 1}",
            f"the control character U+{ord(odd[0]):04X}", "text", "save it as CSV in UTF-8",
        )  # fmt: skip
    count = text.count("\n")
    if count == 0:
        raise InputError(
            str(file), "a head without rows", "at least one row of numbers", "add the values"
        )
    if count > most_rows:
        raise InputError(
            str(file), f"{count:,} rows", f"at most {most_rows:,} rows",
            f"keep one row of {-(-count // most_rows)}, or cut the file into parts",
        )  # fmt: skip
    separator = ";" if ";" in text.partition("\n")[0] else ","
    reader = csv.reader(io.StringIO(text), delimiter=separator, strict=True)
    rows: list[tuple[int, list[str]]] = []
    begun = 1
    try:
        for cells in reader:
            rows.append((begun, cells))
            begun = reader.line_num + 1
    except csv.Error as error:
        raise InputError(
            f"{file}, line {begun}", str(error), "a row of CSV", "check the quotes"
        ) from None
    while len(rows) > 1 and not any(cell.strip() for cell in rows[-1][1]):
        rows.pop()
    return rows


def csv_head(cells: list[str], place: str) -> list[tuple[str, str | None]]:
    """Return name and unit of each column: time with its unit first, then at least one more.

    Parameters
    ----------
    cells : list of str
        "time [s]", "pump_1 [V]"
    place : str
        File and line, for messages.

    Raises
    ------
    InputError
        There are too few columns, the first is not the time with its unit, or a name cannot be
        printed.

    Examples
    --------
    >>> csv_head(["time [min]", "pump_1 [V]", "share"], "pump.csv, line 1")
    [('time', 'min'), ('pump_1', 'V'), ('share', None)]
    """
    fields = [match.groups() for cell in cells if (match := _HEADER.fullmatch(cell))]
    if len(fields) != len(cells) or len(fields) < 2:
        raise InputError(
            place, ", ".join(cells)[:60], "a time and at least one signal, separated by , or ;",
            _HEAD_EXAMPLE,
        )  # fmt: skip
    odd = next((cell for cell in cells if not cell.isprintable()), None)
    if odd is not None:
        raise InputError(place, odd[:60], "names that can be printed", "rename the column")
    first, unit = fields[0]
    if first.lower() != "time" or not unit:
        raise InputError(
            f"{place}, column 1", cells[0].strip()[:60], "the time with its unit", _HEAD_EXAMPLE
        )
    return [(name, unit) for name, unit in fields]


def csv_numbers(
    rows: list[tuple[int, list[str]]], names: list[str], file: Path, gap: str
) -> np.ndarray:
    """Return all cells below the head as numbers [rows, columns]; none is left out.

    Parameters
    ----------
    names : list of str
        Of the columns.
    file : Path
        For messages.
    gap : str
        What to do about an empty cell.

    Raises
    ------
    InputError
        A row has not as many cells as the head, or a cell is no finite number: line and column
        are named.
    """
    for line, cells in rows:
        if len(cells) != len(names):
            raise InputError(
                f"{file}, line {line}", f"{len(cells)} fields",
                f"{len(names)} fields, as in the head",
                "fill every column; a decimal comma has to be a point",
            )  # fmt: skip
    try:
        numbers = np.array([cells for _, cells in rows], dtype=float)
        if np.all(np.isfinite(numbers)):
            return numbers
    except ValueError:
        pass
    return np.array(
        [
            [
                _number(cell, f"{file}, line {line}, column '{name}'", gap)
                for name, cell in zip(names, cells, strict=True)
            ]
            for line, cells in rows
        ]
    )


def _number(cell: str, place: str, gap: str) -> float:
    """Return the number in a cell.

    Parameters
    ----------
    place : str
        File, line and column, for messages.
    gap : str
        What to do about an empty cell.

    Raises
    ------
    InputError
        The cell is empty, has a decimal comma or a unit, or is no finite number.
    """
    parts = split_quantity(cell)
    if not cell.strip():
        raise InputError(place, "", "a number", gap)
    if _DECIMAL_COMMA.fullmatch(cell):
        raise InputError(
            place, cell.strip(), "a decimal point", "write 3.5 instead of 3,5 throughout the file"
        )
    if parts is None or parts[1]:
        remedy = "the unit stands in the head only" if parts else "correct the cell"
        raise InputError(place, cell.strip()[:40], "a number", remedy)
    number = float(parts[0])
    if not math.isfinite(number):
        raise InputError(place, cell.strip(), "a finite number", "replace it by a measured value")
    return number
