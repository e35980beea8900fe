"""A number that the reader of a lesson finds: typed, or measured by the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from clepsydra.base.quantity import quantity
from clepsydra.base.units import convertible, from_si
from clepsydra.laboratory.lessons import answers
from clepsydra.laboratory.lessons.answers import Answer, read_answer
from clepsydra.laboratory.lessons.measure import Measure, read_measure
from clepsydra.laboratory.lessons.told_text import line
from clepsydra.process import told
from clepsydra.process.declared import keys_of, part, read_fields, table_schema
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader


def _unit(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
    remedy = f'write as in {key} = "cm", or leave it out for a number'
    unit = table.text(key, "a unit", remedy, default="1")
    if unit != "1" and not convertible(unit, unit):
        raise table.refused(key, unit[:40], "a unit", remedy)
    return unit


def _answer(table: TableReader, key: str, known: Mapping[str, Any]) -> Answer | None:
    return read_answer(table, key, known["process"], known["unit"])


def _measure(table: TableReader, key: str, known: Mapping[str, Any]) -> Measure | None:
    found = read_measure(table, key, process=known["process"], steps=known["steps"])
    if found is None:
        return None
    own, unit = known["unit"], found.unit(known["process"])
    if own != unit and not convertible(own, unit):
        expected = f"a unit of what is measured, [{unit}]"
        raise table.refused("unit", own, expected, f'write as in unit = "{unit}"')
    return found


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A number to find.

    Parameters
    ----------
    words : str
    symbol : str
        What stands before its field, "a₁"; may be empty.
    unit : str
        In which it is told; "1" for a number.
    answer : Answer or None
        None where any number is taken.
    measure : Measure or None
        None where it is typed.
    tolerance : float
        By which it may be off, as a share of the answer.
    """

    words: str = line("what it is")
    symbol: str = line("its symbol, in front of its field", default="")
    unit: str = part(_unit, **told.text("in which it is told; a number if left out"))
    answer: Answer | None = part(
        _answer, description="what is right; any number if left out", **answers.TOLD
    )
    measure: Measure | None = part(
        _measure,
        {
            "measure": {
                "description": "what the page measures; typed if left out",
                **table_schema(Measure),
            }
        },
    )
    tolerance: float = quantity(
        "1",
        "a share",
        above=0.0,
        at_most=1.0,
        default=0.05,
        remedy="leave it out for 5 %",
    )

    def shown(self, value: float, unit: str) -> float:
        """Return a value [unit] in the unit of the figure."""
        return from_si(value, unit, self.unit)

    def of_measured(self, process: Process) -> float:
        """Return how many of its units are one SI unit of what it measures; 1 if it is typed."""
        return 1.0 if self.measure is None else self.shown(1.0, self.measure.unit(process))


def read_figures(table: TableReader, **known: Any) -> tuple[Figure, ...]:
    """Read the figures of a task.

    Raises
    ------
    InputError
        Something in one of them is wrong.
    """
    expected, remedy = "figures to find, a table each", "write [[tasks.figures]]"
    rows = table.tables("figures", expected, remedy, keys_of(Figure))
    return tuple(Figure(**read_fields(Figure, row, **known)) for row in rows)
