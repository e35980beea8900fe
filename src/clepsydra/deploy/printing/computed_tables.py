"""Lists of numbers that a printed program computes: shorter, and what they mean stands there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from itertools import combinations

import numpy as np

from clepsydra.deploy.printing.expressions import Expression, constant, variable
from clepsydra.program.counted_loop import Table
from clepsydra.program.precision import Precision

_REAL = {"double": np.float64, "single": np.float32}
#: A shorter list is as easily read.
_LONG = 12


def equal_steps(values: Sequence[float], index: str, precision: Precision) -> Expression | None:
    """Return the entry at an index, if many numbers lie at equal distances in every bit.

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import notation_of
    >>> entry = equal_steps([0.25 * k - 1.0 for k in range(20)], "i", "double")
    >>> notation_of("double").render(entry)
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
    >>> from clepsydra.deploy.c99.statements import notation_of
    >>> table = Table("degree", (0.5, 0.0), over="x", lines=((1.0, 0.0), (-0.5, 4.0)))
    >>> found = on_lines(table, (0.5, 0.0), {"x": ([3.0, 4.0], variable("x"))}, "double")
    >>> notation_of("double").render(found)
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
