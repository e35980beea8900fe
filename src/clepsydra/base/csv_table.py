"""A table of numbers over time as CSV: its rows, its head, and what is wrong with a cell."""

from __future__ import annotations

import csv
import io
import math
import re
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.units import split_quantity

_HEADER = re.compile(r"\s*(.*?)\s*(?:\[\s*(.*?)\s*\]\s*)?")
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+\s*")
_HEAD_EXAMPLE = "write a head such as time [s],pump_1 [V]"


def csv_rows(file: Path) -> list[tuple[int, list[str]]]:
    """Return the line number and the cells of each row; there are at least a head and a row.

    Columns are separated by commas, or by semicolons where the head has one.

    Raises
    ------
    InputError
        The file cannot be read, is no text, is empty or has only a head.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "pump.csv")
    ...     _ = file.write_text("time [s],pump_1 [V]\\n0,3\\n\\n")
    ...     csv_rows(file)
    [(1, ['time [s]', 'pump_1 [V]']), (2, ['0', '3'])]
    """
    text = _text(file)
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
        There are too few columns, or the first is not the time with its unit.

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
    first, unit = fields[0]
    if first.lower() != "time" or not unit:
        raise InputError(
            f"{place}, column 1", cells[0].strip()[:60], "the time with its unit", _HEAD_EXAMPLE
        )
    return [(name, unit) for name, unit in fields]


def checked_width(cells: list[str], width: int, place: str) -> None:
    """Refuse a row that has not as many cells as the head.

    Examples
    --------
    >>> checked_width(["0", "3"], 2, "pump.csv, line 2")
    """
    if len(cells) != width:
        raise InputError(
            place,
            f"{len(cells)} fields",
            f"{width} fields, as in the head",
            "fill every column; a decimal comma has to be a point",
        )


def number_text(cell: str, place: str, gap: str) -> str:
    """Return the number in a cell as text.

    Parameters
    ----------
    cell : str
    place : str
        File, line and column, for messages.
    gap : str
        What to do about an empty cell.

    Raises
    ------
    InputError
        The cell is empty, has a decimal comma or a unit, or is no finite number.

    Examples
    --------
    >>> number_text(" 3.50", "pump.csv, line 2, column 'pump_1'", "fill the gap")
    '3.50'
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
    if not math.isfinite(float(parts[0])):
        raise InputError(place, cell.strip(), "a finite number", "replace it by a measured value")
    return parts[0]


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
