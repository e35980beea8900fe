"""A register map as a CSV file: written from tags, edited to meet a PLC, and read back."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from enum import Enum
from pathlib import Path
from typing import TypeVar

from clepsydra.base.csv_table import csv_rows
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.files import whole_file
from clepsydra.base.suggestion import suggestion
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.register_map import COLUMNS, RegisterMap, Server
from clepsydra.rig.doors.modbus.table import Table
from clepsydra.rig.tag import Tag

#: What each row has to say; the other columns are for its reader.
_NEEDED = COLUMNS[:4]
#: All four tables, full.
_MOST_ROWS = 4 * 65536

_Choice = TypeVar("_Choice", bound=Enum)


def write_map(register_map: RegisterMap, path: Path) -> None:
    """Write a map as CSV, an entry a row.

    Parameters
    ----------
    register_map : RegisterMap
    path : Path

    Raises
    ------
    InputError
        The file cannot be written.
    """
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(register_map.rows())


def read_map(path: Path, tags: Iterable[Tag], server: Server = Server.RIG) -> RegisterMap:
    """Read a map from CSV.

    Its head names the columns tag, table, address and encoding, in any order; what else it has,
    such as references, units and words, is not read. A tag may be left out, or stand in several
    rows.

    Parameters
    ----------
    path : Path
    tags : iterable of Tag
        All that there are.
    server : Server
        Whose registers they are.

    Raises
    ------
    InputError
        With the line: a column is missing, a tag, a table or an encoding is unknown, an address
        is none, entries overlap, or a tag cannot stand there.

    Examples
    --------
    >>> import tempfile
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "map.csv")
    ...     _ = file.write_text("tag,table,address,encoding\\n"
    ...                         "level_1.pv,input register,8,counts-27648\\n")
    ...     read_map(file, tags).entries[0].reference
    '30009'
    """
    (line, head), *rows = csv_rows(path, _MOST_ROWS)
    places = _columns(f"{path}, line {line}", head)
    known = {tag.name: tag for tag in tags}
    entries = []
    for line, cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        place = f"{path}, line {line}"
        if len(cells) != len(head):
            raise InputError(
                place, f"{len(cells)} fields", f"{len(head)} fields, as in the head",
                "give each column its field; words with a comma stand in quotation marks",
            )  # fmt: skip
        given = {column: cells[number].strip() for column, number in places.items()}
        entries.append(_entry(place, given, known))
    return RegisterMap(tuple(entries), server)


def _columns(place: str, head: list[str]) -> dict[str, int]:
    """Return where the columns that are read stand."""
    names = [cell.strip().lower() for cell in head]
    for column in _NEEDED:
        if names.count(column) != 1:
            found = "several columns" if column in names else "no column"
            raise InputError(
                place, Finding(f"{found} '{column}'"), f"the columns {', '.join(_NEEDED)}",
                "write the head as `clepsydra rig --map` writes it",
            )  # fmt: skip
    return {column: names.index(column) for column in _NEEDED}


def _entry(place: str, given: dict[str, str], known: dict[str, Tag]) -> Entry:
    tag = known.get(given["tag"])
    if tag is None:
        raise InputError(
            f"{place}, column 'tag'", given["tag"], "a tag of the process",
            suggestion(given["tag"], known, "`clepsydra rig --map` lists them"),
        )  # fmt: skip
    address = given["address"]
    if not (address.isascii() and address.isdigit() and len(address) <= 5):
        raise InputError(
            f"{place}, column 'address'", address, "a whole number from 0 to 65535",
            "give the address of the request, counted from 0, without the digit of its table",
        )  # fmt: skip
    return Entry(
        tag, _choice(Table, f"{place}, column 'table'", given["table"]), int(address),
        _choice(Encoding, f"{place}, column 'encoding'", given["encoding"]), place,
    )  # fmt: skip


def _choice(kind: type[_Choice], place: str, text: str) -> _Choice:
    names = {each.value: each for each in kind}
    found = names.get(text.lower())
    if found is None:
        raise InputError(
            place, text, f"one of {', '.join(names)}", suggestion(text, names, "write one of them")
        )
    return found
