"""A fuzzy controller as a TOML file: sets, rules, and what they stand for in a process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.units import to_si
from clepsydra.controllers.fuzzy import membership
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import (
    FEWEST_POINTS,
    MOST_POINTS,
    FuzzySystem,
    LinguisticVariable,
)
from clepsydra.process.document import Document, parse
from clepsydra.process.table_reader import TableReader, checked_name, shown_value

_KEYS = ("title", "points", "inputs", "outputs", "rules")
INPUT_KEYS = ("of", "quantity", "unit", "gain", "range", "dead_zone", "filter_time", "sets")
OUTPUT_KEYS = ("moves", "action", "unit", "range", "gain", "rate_limit", "fading_time", "sets")
_RULE = 'write as in R1 = "if e is N and de is ZO then u is PS"'
_SETS = "write as in [inputs.e.sets] and N = { left_shoulder = [-1, 0] }"

#: Shape to its number of points, and what makes it.
_SHAPES: dict[str, tuple[int, Callable[..., membership.Membership]]] = {
    "left_shoulder": (2, membership.left_shoulder),
    "right_shoulder": (2, membership.right_shoulder),
    "triangle": (3, membership.triangle),
    "trapezoid": (4, membership.Trapezoid),
    "gaussian": (2, membership.Gaussian),
}


@dataclass(frozen=True, eq=False)
class FuzzyFile:
    """What a file of a fuzzy controller says.

    Parameters
    ----------
    system : FuzzySystem
        In the units of the file, after the input gains and before the output gains.
    inputs, outputs : dict
        Linguistic variable to its table, for what it stands for in a process.
    """

    title: str
    system: FuzzySystem
    inputs: dict[str, TableReader]
    outputs: dict[str, TableReader]


def load_fuzzy(path: str | Path) -> FuzzyFile:
    """Read a file of a fuzzy controller.

    Raises InputError: there is no such file, or something in it is wrong, told with its line.
    """
    content = read_input(Path(path), "a fuzzy file", inside="the .toml file")
    return read_fuzzy(parse(content, str(path), "fuzzy"))


def read_fuzzy(document: Document) -> FuzzyFile:
    """Read a fuzzy controller from a document.

    Raises InputError: something is wrong, told with its line.
    """
    general = TableReader(document, (), _KEYS)
    inputs = _tables(general, "inputs", INPUT_KEYS)
    outputs = _tables(general, "outputs", OUTPUT_KEYS)
    read = _variables(document, "inputs", inputs, (-1.0, 1.0))
    moved = _variables(document, "outputs", outputs, None)
    with _placed(document):
        rows = general.table("rules", "a table of rules", _RULE)
        rules = [parse_rule(name, rows.text(name, "a rule", _RULE)) for name in rows.present]
        system = FuzzySystem(read, moved, tuple(rules), _points(general))
    title = general.text("title", "one line of text", "leave it out for none", default="")
    return FuzzyFile(title, system, inputs, outputs)


@contextmanager
def _placed(document: Document, above: str = "") -> Iterator[None]:
    """Give an error whose place is a path in the system its line in the file."""
    try:
        yield
    except InputError as error:
        if error.place.startswith(f"{document.file}, line "):
            raise
        place = document.place(*f"{above}{error.place}".split("."))
        raise InputError(place, error.value, error.expected, error.remedy) from None


def _tables(general: TableReader, kind: str, keys: tuple[str, ...]) -> dict[str, TableReader]:
    remedy = f"write [{kind}.{'e' if kind == 'inputs' else 'u'}]"
    expected = f"a table for each of the {kind}"
    rows = general.table(kind, expected, remedy)
    if not rows.present:
        raise general.refused(kind, "none", expected, remedy)
    return {
        checked_name(name, rows.place(name)): rows.table(name, "a table", remedy, keys)
        for name in rows.present
    }


def _variables(
    document: Document,
    kind: str,
    tables: dict[str, TableReader],
    default: tuple[float, float] | None,
) -> tuple[LinguisticVariable, ...]:
    found = []
    for name, table in tables.items():
        low, high = default if default and not table.has("range") else table.range("range", "1")
        rows = table.table("sets", "a table of sets", _SETS)
        sets = {checked_name(label, rows.place(label)): _set(rows, label) for label in rows.present}
        with _placed(document, f"{kind}."):
            found.append(LinguisticVariable(name, low, high, sets))
    return tuple(found)


def _set(rows: TableReader, label: str) -> membership.Membership:
    shapes = ", ".join(_SHAPES)
    table = rows.table(label, "a table with one shape", _SETS, tuple(_SHAPES))
    if len(table.present) != 1:
        shown = ", ".join(table.present) or "no shape"
        raise rows.refused(label, shown, f"one shape of {shapes}", _SETS)
    (shape,) = table.present
    count, make = _SHAPES[shape]
    written = table.raw(shape)
    if not isinstance(written, list) or len(written) != count:
        remedy = f"write as in {shape} = {list(range(count))}"
        raise table.wrong(shape, f"a list of {count} numbers", remedy)
    numbers = [to_si(shown_value(number), "1", table.place(shape)) for number in written]
    try:
        return make(*numbers)
    except InputError as error:
        raise table.wrong(shape, error.expected, error.remedy) from None


def _points(general: TableReader) -> int:
    written = general.raw("points") if general.has("points") else 101
    if not isinstance(written, int) or isinstance(written, bool):
        shown = str(written).lower() if isinstance(written, bool) else shown_value(written)
        raise general.refused(
            "points", shown, f"a whole number from {FEWEST_POINTS} to {MOST_POINTS}", "101 is usual"
        )
    return written
