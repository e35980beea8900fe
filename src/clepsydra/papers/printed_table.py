"""What a document prints: the table of its numbers and words."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from importlib import resources
from typing import Any

from clepsydra.papers.printed import Printed
from clepsydra.papers.rational_function import RationalFunction
from clepsydra.papers.row import Row


class PrintedTable(dict[tuple[str, str], Printed]):
    """The lines of a document by place and name.

    Examples
    --------
    >>> table = printed_table("clepsydra.papers.three_tanks")
    >>> table["Ziegler-Nichols", "Kc"].text
    '0.0012'
    >>> table.numbers("Ziegler-Nichols", "Kc", "Kd")
    [0.0012, 0.028]
    """

    def numbers(self, place: str, *names: str) -> list[float]:
        """Return the numbers of a place by their names."""
        return [self[place, name].value for name in names]

    def compared(self, place: str, computed: Mapping[str, float]) -> list[Row]:
        """Compare the numbers of a place by name, whose notes say what they come from."""
        return [self[place, name].compared(float(value)) for name, value in computed.items()]

    def formulas(self, place: str, computed: Mapping[str, RationalFunction | int]) -> list[Row]:
        """Compare the formulas of a place by name, whose notes say what they follow from."""
        return [self[place, name].formula(value) for name, value in computed.items()]


def printed_table(package: str) -> PrintedTable:
    """Return ``printed.csv`` of the package of a document by place and name."""
    with resources.files(package).joinpath("printed.csv").open(encoding="utf-8") as file:
        lines = [_printed(cells) for cells in csv.DictReader(file)]
    table = PrintedTable({(line.place, line.name): line for line in lines})
    assert len(table) == len(lines), f"printed.csv of {package} has a line of one name twice"
    return table


def _printed(cells: dict[str, Any]) -> Printed:
    """Return a line of cells, whose columns are the parameters of `Printed`."""
    numbers = {"line": int(cells["line"]), "digits": int(cells["digits"] or 0) or None}
    return Printed(**(cells | numbers | {"is_given": bool(cells["is_given"])}))


def entries(name: str, matrix: Any) -> dict[str, Any]:
    """Return the entries of a matrix by name, or by a pattern of it, row by row.

    Examples
    --------
    >>> import numpy as np
    >>> list(entries("A", np.eye(2))), list(entries("row {}, column {}", np.eye(1)))
    (['A11', 'A12', 'A21', 'A22'], ['row 1, column 1'])
    """
    rows, columns = matrix.shape
    pattern = name if "{}" in name else f"{name}{{}}{{}}"
    return {pattern.format(i + 1, j + 1): matrix[i, j] for i in range(rows) for j in range(columns)}
