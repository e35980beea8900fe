"""Lists of numbers that a printed program computes: shorter, and what they mean stands there."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from functools import reduce
from itertools import combinations

import numpy as np

from clepsydra.deploy.printing.expressions import Expression, constant, variable
from clepsydra.deploy.printing.listing import Assignment, Scope
from clepsydra.program.counted_loop import Table
from clepsydra.program.precision import Precision
from clepsydra.program.program import ForLoop

_REAL = {"double": np.float64, "single": np.float32}
#: A shorter list is as easily read.
_LONG = 12


def equal_steps(values: Sequence[float], index: str, precision: Precision) -> Expression | None:
    """Return the entry at an index, if many numbers lie at equal distances in every bit.

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import C99
    >>> entry = equal_steps([0.25 * k - 1.0 for k in range(20)], "i", "double")
    >>> C99("law", "double").render(entry)
    '0.25 * (double)i - 1.0'
    """
    real = _REAL[precision]
    numbers, places = np.array(values, real), np.arange(len(values), dtype=real)
    if len(values) < _LONG:
        return None
    step = (numbers[-1] - numbers[0]) / places[-1]
    steps = step * places if numbers[0] == 0.0 else numbers[0] + step * places
    if steps.tobytes() != numbers.tobytes():
        return None
    product = (constant(float(step)), variable(index, "integer").to("real"))
    return _moved(Expression("multiply", product), values[0])


def _moved(place: Expression, way: float) -> Expression:
    """Return a place so far on."""
    if way == 0.0:
        return place
    return Expression("subtract" if way < 0.0 else "add", (place, constant(abs(way))))


def on_lines(
    table: Table,
    values: Sequence[float],
    known: Mapping[str, tuple[Sequence[float], Expression]],
    precision: Precision,
) -> Expression | None:
    """Return an entry of a stretch of a table, if few of its lines have every bit of it.

    Parameters
    ----------
    table : Table
    values : sequence of float
        The stretch.
    known : mapping
        Table of places to those of the stretch, and to what reads one of them.
    precision : {"double", "single"}

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import C99
    >>> table = Table("degree", (0.5, 0.0), over="x", lines=((1.0, 0.0), (-0.5, 4.0)))
    >>> found = on_lines(table, (0.5, 0.0), {"x": ([3.0, 4.0], variable("x"))}, "double")
    >>> C99("law", "double").render(found)
    '0.5 * (4.0 - x)'
    """
    if table.over not in known:
        return None
    real, (places, place) = _REAL[precision], known[table.over]
    x, expected = np.array(places, real), np.array(values, real).tobytes()
    parts = [_line(x, place, *each) for each in table.lines]
    parts.append((np.ones_like(x), constant(1.0)))
    for some in (each for n in (1, 2) for each in combinations(parts, n)):
        least = reduce(np.minimum, [numbers for numbers, _ in some])
        entry = reduce(lambda a, b: Expression("minimum", (a, b)), [each for _, each in some])
        if least.tobytes() == expected:
            return entry
        if np.maximum(np.zeros_like(x), least).tobytes() == expected:
            return Expression("maximum", (constant(0.0), entry))
    return None


def _line(
    x: np.ndarray, place: Expression, slope: float, zero: float
) -> tuple[np.ndarray, Expression]:
    """Return slope · (x - zero) as numbers, and as it is written: an entry of 0 is no -0."""
    way, inside = x - x.dtype.type(zero), _moved(place, -zero)
    if slope < 0.0:
        way, inside = x.dtype.type(zero) - x, Expression("subtract", (constant(zero), place))
    return x.dtype.type(abs(slope)) * way, Expression("multiply", (constant(abs(slope)), inside))


def read_tables(
    loop: ForLoop, index: str, read: Container[int], scope: Scope
) -> tuple[range, list[Expression], list[Assignment]]:
    """Return the values of a loop's index, what reads its tables, and what a turn begins with.

    Where the tables are stretches of named ones at one place, the index counts in these.

    Parameters
    ----------
    loop : ForLoop
    index : str
    read : container of int
        The tables that the body reads.
    scope : Scope
    """
    notation, names = scope.notation, scope.names
    # Where numbers stand in several tables, they are read in the first.
    known = scope.known[::-1]
    places = {
        number: {first: table for table in known for first in table.stretches(values)}
        for number, values in enumerate(loop.tables)
        if number in read and loop.count > 1
    }
    common = set.intersection(*map(set, places.values())) if places else set()
    begin = min(common, default=0)
    entries: list[Expression] = []
    counted: list[Assignment] = []
    over: dict[str, tuple[Sequence[float], Expression]] = {}
    for number, values in enumerate(loop.tables):
        if number not in places:
            entries.append(constant(values[0]))
            continue
        table = places[number][begin] if common else Table(f"{loop.name}_table", values)
        if common and table.name in over:
            entries.append(over[table.name][1])
            continue
        steps = equal_steps(table.values, index, notation.precision) if notation.computes else None
        if steps:
            counted.append(Assignment(names.shared(table.name, index), steps))
            entries.append(variable(counted[-1].name))
        elif found := on_lines(table, values, over, notation.precision):
            entries.append(found)
        else:
            name = scope.table(table)
            behind = f" - {table.first}" if table.first else ""
            entries.append(variable(f"{name}[{index}{behind}]"))
        if notation.computes:
            over[table.name] = values, entries[-1]
    return range(begin, begin + loop.count), entries, counted
