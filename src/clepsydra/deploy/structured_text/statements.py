"""Statements of Structured Text: assignments, choices as IF, rounding, counted loops."""

from __future__ import annotations

from clepsydra.deploy.printing.expressions import Expression, Notation, decimal, render, variable
from clepsydra.deploy.printing.listing import Assignment, CountedLoop, ListingStatement

NOTATION = Notation(
    language="Structured Text",
    operators={
        "add": "+", "subtract": "-", "multiply": "*", "divide": "/",
        "less": "<", "less_equal": "<=", "equal": "=", "not_equal": "<>",
        "and": "AND", "or": "OR",
    },
    functions={
        "square_root": "SQRT", "absolute": "ABS", "exp": "EXP", "log": "LN", "pow": "EXPT",
        "sin": "SIN", "cos": "COS", "tan": "TAN", "asin": "ASIN", "acos": "ACOS",
        "atan": "ATAN", "atan2": "ATAN2",
    },
    negation="NOT ",
    statements=frozenset({"select", "maximum", "minimum", "number", "floor", "ceiling"}),
    repeating=frozenset({"maximum", "minimum", "floor", "ceiling"}),
    rounding=frozenset({"floor", "ceiling"}),
)  # fmt: skip

#: Longest line where it can be helped [characters].
LINE = 100
_STEP = "  "
# A double of this size or above is a whole number already.
_WHOLE = decimal(2.0**52)
# Quotient and rest by this divisor fit a DINT for every smaller double, and both are exact.
_SPLIT = decimal(2.0**21)


def statement(entry: ListingStatement, depth: int = 0) -> list[str]:
    """Write a statement of a listing, one string a line.

    Examples
    --------
    >>> statement(Assignment("total", Expression("add", (variable("a"), variable("b")))))
    ['total := a + b;']
    """
    if isinstance(entry, Assignment):
        return assign(entry.name, entry.expression, depth)
    indent = _STEP * depth
    if isinstance(entry, CountedLoop):
        title = f"{entry.label}: {entry.count} turns"
        head, end = f"FOR {entry.index} := 0 TO {entry.count - 1} DO", "END_FOR;"
    else:
        title = entry.label
        head, end = f"IF {render(entry.condition, NOTATION)} THEN", "END_IF;"
    lines = [f"{indent}(* {title} *)"]
    for start in entry.start:
        lines += assign(start.name, start.expression, depth)
    lines.append(f"{indent}{head}")
    for inner in entry.body:
        lines += statement(inner, depth + 1)
    for update in entry.update:
        lines += assign(update.name, update.expression, depth + 1)
    return [*lines, f"{indent}{end}"]


def assign(name: str, expression: Expression, depth: int = 0) -> list[str]:
    """Write ``name := expression``; a choice becomes IF, rounding a few statements.

    Examples
    --------
    >>> limited = Expression("minimum", (variable("a"), variable("b")))
    >>> print("\\n".join(assign("u", limited)))
    IF a < b THEN
      u := a;
    ELSE
      u := b;
    END_IF;
    """
    code, operands = expression.code, expression.operands
    if code in ("floor", "ceiling"):
        return _whole(name, code, render(operands[0], NOTATION), depth)
    if code not in ("select", "maximum", "minimum", "number"):
        return wrapped(name, render(expression, NOTATION), depth)
    indent = _STEP * depth
    condition, first, second = _choice(expression)
    lines = [f"{indent}IF {condition} THEN", *assign(name, first, depth + 1)]
    while second.code == "select":
        condition, first, second = _choice(second)
        lines.append(f"{indent}ELSIF {condition} THEN")
        lines += assign(name, first, depth + 1)
    if second != variable(name):
        lines += [f"{indent}ELSE", *assign(name, second, depth + 1)]
    return [*lines, f"{indent}END_IF;"]


def _choice(expression: Expression) -> tuple[str, Expression, Expression]:
    """Return condition and both branches."""
    code, operands = expression.code, expression.operands
    if code == "select":
        return render(operands[0], NOTATION), operands[1], operands[2]
    if code == "number":
        one, zero = Expression("constant", number=1.0), Expression("constant")
        return render(operands[0], NOTATION), one, zero
    sign = ">" if code == "maximum" else "<"
    first, second = operands
    return f"{render(first, NOTATION)} {sign} {render(second, NOTATION)}", first, second


def _whole(name: str, code: str, text: str, depth: int) -> list[str]:
    """Write the largest whole number not above, or the smallest not below, a value.

    The standard has TRUNC, to a DINT, only: so the value is cut off in two parts that both fit.
    The product with zero keeps the sign of zero; not a number and infinity stay what they are.
    """
    beyond, correction = (">", "-") if code == "floor" else ("<", "+")
    what = "largest whole number not above" if code == "floor" else "smallest one not below"
    lines = [
        f"(* {name} is the {what} {text} *)",
        f"IF ABS({text}) < {_WHOLE} THEN",
        f"  {name} := {_SPLIT} * DINT_TO_LREAL(TRUNC({text} / {_SPLIT}));",
        f"  {name} := {name} + DINT_TO_LREAL(TRUNC({text} - {name}));",
        f"  IF {name} {beyond} {text} THEN",
        f"    {name} := {name} {correction} 1.0;",
        "  END_IF;",
        f"  IF {name} = 0.0 THEN",
        f"    {name} := {text} * 0.0;",
        "  END_IF;",
        "ELSE",
        f"  {name} := {text};",
        "END_IF;",
    ]
    return [_STEP * depth + line for line in lines]


def wrapped(name: str, text: str, depth: int = 0) -> list[str]:
    """Write an assignment on one line, or on two where one is too long.

    Examples
    --------
    >>> wrapped("total", "a + b", depth=1)
    ['  total := a + b;']
    """
    indent = _STEP * depth
    line = f"{indent}{name} := {text};"
    return [line] if len(line) <= LINE else [f"{indent}{name} :=", f"{indent}{_STEP * 2}{text};"]
