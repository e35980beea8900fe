"""A process or study file as text: parsed, or the reason why not."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, field
from typing import Any, Literal

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import input_text
from clepsydra.process.toml_lines import key_lines, line_of

_LONGEST_LINE = 1_000
#: A quantity without quotation marks: key, number, unit.
_BARE_QUANTITY = re.compile(
    r"([\w.-]+) *= *([-+]?[\d.]+(?:e[-+]?\d+)?) *([A-Za-z%µ°(][^'\"#]*)", re.I
)

Kind = Literal["process", "study", "fuzzy", "lesson"]
#: Keys that only a study file has.
_ONLY_STUDY = ("process", "controllers", "scenario", "ranking")
#: How to begin with a file of each kind.
_BEGIN = {
    "process": "begin with one that clepsydra new NAME writes",
    "study": "begin with one that clepsydra new --study writes",
    "fuzzy": "begin with a copy of the example of docs/fuzzy-files.md",
    "lesson": "begin with a copy of the example of docs/lessons.md",
}


@dataclass(frozen=True)
class Document:
    """The tables of a file and where each key stands.

    Parameters
    ----------
    file : str
        As the user named it.
    tables : dict
        As `tomllib` reads them.
    lines : dict
        Key path, as it stands in the file, to line number.
    origins : dict
        Path of what a variant brought to the path at which it stands in the file.
    """

    file: str
    tables: dict[str, Any]
    lines: dict[tuple[str, ...], int]
    origins: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)

    def place(self, *path: str) -> str:
        """Return file, line and path of a key, for a message."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.origins:
                path = (*self.origins[path[:length]], *path[length:])
                break
        where = f"{self.file}, line {line_of(self.lines, path)}"
        parts = [key[:60] if key.isprintable() else ascii(key[:60]) for key in path]
        return f"{where}, {'.'.join(parts)}" if path else where


def parse(content: bytes, file: str, kind: Kind = "process") -> Document:
    """Parse the content of a file.

    Parameters
    ----------
    file : str
        Its name, for messages.
    kind : {"process", "study", "fuzzy", "lesson"}
        What it should be, for messages.

    Examples
    --------
    >>> parse(b"[tanks.a]\\narea = '28 cm^2'\\n", "plant.toml").place("tanks", "a", "area")
    'plant.toml, line 2, tanks.a.area'
    """
    text = input_text(content, file, f"a {kind} file", _LONGEST_LINE)
    if not text.strip():
        raise InputError(file, Finding("an empty file"), f"a {kind}", _BEGIN[kind])
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise InputError(
            file,
            Finding("brackets in brackets without end"),
            f"a {kind} file",
            "check the brackets",
        ) from None
    except ValueError as error:
        raise _syntax_error(error, text, file) from None
    return Document(file, tables, key_lines(text))


def kind_of(document: Document) -> Kind:
    """Return whether a file is a process, which has tanks, a study, which names its process, or a
    lesson, which has tasks.

    Examples
    --------
    >>> kind_of(parse(b"process = 'three-tanks'", "a.toml")), kind_of(parse(b"[tanks.a]", "b.toml"))
    ('study', 'process')
    """
    tables = document.tables
    if "tasks" in tables:
        return "lesson"
    is_study = "tanks" not in tables and any(key in tables for key in _ONLY_STUDY)
    return "study" if is_study else "process"


def _syntax_error(error: ValueError, text: str, file: str) -> InputError:
    """Turn the parser's message into place, value, expectation and remedy."""
    message = str(error)
    found = re.search(r"\(at line (\d+), column \d+\)", message)
    lines = text.rstrip().split("\n")
    number = min(int(found[1]) if found else len(lines), len(lines))
    value = lines[number - 1].strip()
    value = value[:60] + "…" if len(value) > 60 else value
    place = f"{file}, line {number}"
    if message.startswith(("Cannot declare", "Cannot overwrite", "Duplicate")):
        return InputError(place, value, "every name once", "rename or remove one of the two")
    if "limit" in message:
        return InputError(
            file, Finding("a number of thousands of digits"), "a number", "shorten it"
        )
    bare = _BARE_QUANTITY.fullmatch(value)
    if bare is not None:
        key, amount, unit = bare.groups()
        return InputError(
            place,
            value,
            "a quantity in quotation marks",
            f'write {key} = "{amount} {unit.strip()}"',
        )
    words = re.sub(r" \(at .*\)$", "", message)
    return InputError(
        place,
        value,
        f"valid TOML ({words[:1].lower()}{words[1:]})",
        "correct the line, or see whether the file is cut off",
    )
