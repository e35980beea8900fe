"""Statements of C99: declarations, assignments, counted loops, branches, tables."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.printing.expressions import Notation, decimal, render
from clepsydra.deploy.printing.listing import Assignment, CountedLoop, ListingStatement
from clepsydra.program.program import LIBRARY

FUNCTIONS = {
    "square_root": "sqrt", "absolute": "fabs", "floor": "floor", "ceiling": "ceil",
    **{name: name for name in LIBRARY},
}  # fmt: skip

NOTATION = Notation(
    language="C",
    operators={
        "add": "+", "subtract": "-", "multiply": "*", "divide": "/",
        "less": "<", "less_equal": "<=", "equal": "==", "not_equal": "!=",
        "and": "&&", "or": "||",
    },
    functions=FUNCTIONS,
    negation="!",
    statements=frozenset(),
    repeating=frozenset({"minimum", "maximum"}),
    infinity="HUGE_VAL",
)  # fmt: skip


_LINE = 100


def statement(entry: ListingStatement, depth: int) -> list[str]:
    """Write a statement of a listing, one string a line.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import Expression, variable
    >>> total = Expression("add", (variable("a"), variable("b")))
    >>> statement(Assignment("total", total), 1)
    ['  const double total = a + b;']
    """
    if isinstance(entry, Assignment):
        return _declare(entry, depth, "const ")
    indent = "  " * depth
    lines = [line for start in entry.start for line in _declare(start, depth, "")]
    if isinstance(entry, CountedLoop):
        index, count = entry.index, entry.count
        lines.append(f"{indent}for (int32_t {index} = 0; {index} < {count}; ++{index}) {{")
    else:
        lines.append(f"{indent}if ({render(entry.condition, NOTATION)}) {{")
    for inner in entry.body:
        lines += statement(inner, depth + 1)
    for update in entry.update:
        lines += assign(update.name, render(update.expression, NOTATION), depth + 1)
    return [*lines, f"{indent}}}"]


def _declare(assignment: Assignment, depth: int, qualifier: str) -> list[str]:
    kind = "bool" if assignment.expression.is_truth else "double"
    text = render(assignment.expression, NOTATION)
    return assign(f"{qualifier}{kind} {assignment.name}", text, depth)


def assign(left: str, right: str, depth: int) -> list[str]:
    """Write an assignment or a declaration on one line, or on two where one is too long.

    Examples
    --------
    >>> assign("state->level", "0.5 * level", 1)
    ['  state->level = 0.5 * level;']
    """
    indent = "  " * depth
    line = f"{indent}{left} = {right};"
    return [line] if len(line) <= _LINE else [f"{indent}{left} =", f"{indent}    {right};"]


def array(left: str, values: Sequence[float]) -> list[str]:
    """Write an array with its values, six on a line.

    Examples
    --------
    >>> array("static const double table[2]", [0.1, 3.0])
    ['static const double table[2] = {', '  0.1, 3.0,', '};', '']
    """
    texts = [decimal(value) for value in values]
    rows = [", ".join(texts[first : first + 6]) for first in range(0, len(texts), 6)]
    return [f"{left} = {{", *(f"  {row}," for row in rows), "};", ""]
