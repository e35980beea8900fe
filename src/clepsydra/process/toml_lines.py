"""Where the keys of a TOML file stand, which the standard library does not keep."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import NamedTuple

Path = tuple[str, ...]

# No file of ours nests deeper: variants, name, table, element, key and two tables in it. A deeper
# key is found at the line of its first parts.
_DEEPEST = 7

_BLANK = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*+")
_KEY_PART = re.compile(r"""[ \t]*([A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*""")
_VALUE_TOKEN = re.compile(
    r'''"""(?:[^\\]|\\.)*?"""(?:"{0,2})'''
    r"""|'''.*?'''(?:'{0,2})"""
    r'''|"(?:[^"\\\n]|\\.)*"'''
    r"""|'[^'\n]*'"""
    r"""|\#[^\n]*"""
    r"""|[\[{]|[\]}]|\n|[^"'\#\[\]{}\n]+""",
    re.DOTALL,
)


class Entry(NamedTuple):
    """A key with its value, or the heading of a table, in a TOML text.

    Parameters
    ----------
    path : tuple of str
        The tables of an array are numbered from 1: the second ``[[step]]`` is ("step", "2").
    start, value, end : int
        Where the entry and its value begin and where its last line ends; a heading has no value
        and begins where it ends.
    """

    path: Path
    is_table: bool
    start: int
    value: int
    end: int


def entries(text: str) -> Iterator[Entry]:
    """Yield the keys and headings of a text that `tomllib` has accepted, in its order.

    A key inside an inline table is none of its own.

    Examples
    --------
    >>> [entry.path for entry in entries("[tanks.tank_1]\\narea = '28 cm^2'")]
    [('tanks', 'tank_1'), ('tanks', 'tank_1', 'area')]
    """
    counts: dict[Path, int] = {}
    table: Path = ()
    position = 0
    while (position := _end_of_blank(text, position)) < len(text):
        start = position
        is_table = text[position] == "["
        if is_table:
            repeated = text.startswith("[[", position)
            table, position = _key(text, position + 1 + repeated)
            table = _numbered(table, counts)
            if repeated:
                counts[table] = counts.get(table, 0) + 1
                table = (*table, str(counts[table]))
            path, position = table, text.find("]", position)
        else:
            path, position = _key(text, position)
            path = table + path
            position += 1  # the equals sign
        value, position = position, _end_of_value(text, position)
        yield Entry(path, is_table, start, value, position)


def key_lines(text: str) -> dict[Path, int]:
    """Return the line on which each key and each table of a valid TOML text begins.

    A key inside an inline table is not listed: it stands on the line of the table's own key,
    which `line_of` finds.

    Parameters
    ----------
    text : str
        Text that `tomllib` has accepted.

    Examples
    --------
    >>> lines = key_lines("title = 'plant'\\n\\n[tanks.tank_1]  # left\\narea = '28 cm^2'\\n")
    >>> lines[("title",)], lines[("tanks", "tank_1")], lines[("tanks", "tank_1", "area")]
    (1, 3, 4)
    """
    lines: dict[Path, int] = {}
    position, line = 0, 1
    for entry in entries(text):
        line += text.count("\n", position, entry.start)
        position = entry.start
        for length in range(1, min(len(entry.path), _DEEPEST) + 1):
            lines.setdefault(entry.path[:length], line)
    return lines


def line_of(lines: dict[Path, int], path: Path) -> int:
    """Return the line of a key, or of the innermost table around it that has one.

    Examples
    --------
    >>> line_of({("tanks",): 7}, ("tanks", "tank_1", "area"))
    7
    """
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return 1


def _numbered(path: Path, counts: dict[Path, int]) -> Path:
    """Return the path of a table with the number of the last table of every array around it."""
    found: Path = ()
    for part in path:
        if found in counts:
            found = (*found, str(counts[found]))
        found = (*found, part)
    return found


def _end_of_blank(text: str, position: int) -> int:
    match = _BLANK.match(text, position)
    return match.end() if match else position


def _key(text: str, position: int) -> tuple[Path, int]:
    """Read a dotted key; return its parts and the place after it."""
    parts: list[str] = []
    while match := _KEY_PART.match(text, position):
        part, position = match[1], match.end()
        parts.append(tomllib.loads(f"key = {part}")["key"] if part[0] in "\"'" else part)
        if not text.startswith(".", position):
            break
        position += 1
    return tuple(parts), position


def _end_of_value(text: str, position: int) -> int:
    """Return the place of the line break that ends a value, brackets and strings skipped."""
    depth = 0
    while match := _VALUE_TOKEN.match(text, position):
        token = match[0]
        if token == "\n" and depth <= 0:
            return position
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(token, 0)
        position = match.end()
    return len(text)
