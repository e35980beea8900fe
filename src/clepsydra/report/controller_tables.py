"""The parameters of a controller as rows of text, indexed ones side by side."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.controllers.controller import Controller
from clepsydra.report.quantities import number_text, unit_text


@dataclass(frozen=True)
class ParameterTable:
    """Parameters that share their columns.

    Parameters
    ----------
    columns : tuple of str
        Last index of the parameters' names; one empty text for those without an index.
    rows : tuple of (name, unit, values)
        One value for each column.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, str, tuple[str, ...]], ...]


def parameter_tables(controller: Controller) -> list[ParameterTable]:
    """Return the parameters of a controller, grouped by what their last index counts.

    "integral_time_1" and "integral_time_2" become the row "integral_time" with columns 1 and 2;
    "feedback_2_3" stands in the row "feedback_2", column 3.
    """
    units = {signal.name: signal.unit for signal in controller.law.parameters}
    grouped: dict[tuple[str, str], dict[str, float]] = {}
    for name, value in controller.values.items():
        stem, _, index = name.rpartition("_")
        stem, index = (stem, index) if index.isdigit() else (name, "")
        grouped.setdefault((stem, units.get(name, "1")), {})[index] = value
    tables: dict[tuple[str, ...], list[tuple[str, str, tuple[str, ...]]]] = {}
    # Rows of one matrix, feedback_1 and feedback_2, follow each other.
    firsts: dict[str, int] = {}
    for stem, _ in grouped:
        firsts.setdefault(stem.rstrip("0123456789"), len(firsts))
    for stem, unit in sorted(grouped, key=lambda key: firsts[key[0].rstrip("0123456789")]):
        values = grouped[stem, unit]
        numbers = tuple(number_text(value, 4) for value in values.values())
        tables.setdefault(tuple(values), []).append((stem, unit_text(unit), numbers))
    return [ParameterTable(columns, tuple(rows)) for columns, rows in tables.items()]


def wiring(controller: Controller) -> list[tuple[str, str]]:
    """Return which signal of the process stands behind each index: (role, "1 = level_1, …")."""
    roles = (
        ("measurements", controller.measurements),
        ("setpoints", controller.setpoints),
        ("manipulated variables", controller.manipulated),
    )
    return [(role, _numbered(names)) for role, names in roles]


def _numbered(names: Iterable[str]) -> str:
    return ", ".join(f"{place} = {name}" for place, name in enumerate(names, start=1))
