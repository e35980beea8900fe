"""Statements of Structured Text: assignments, choices as IF, rounding, counted loops."""

from __future__ import annotations

from clepsydra.deploy.printing.entries import is_ring
from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.listing import (
    Assignment,
    Branch,
    CountedLoop,
    ListingStatement,
    RingTurn,
)
from clepsydra.deploy.structured_text.wording import Wording

#: Longest line where it can be helped [characters].
LINE = 100
_STEP = "  "
# A double of this size or above is a whole number already, and so is a single-precision number.
_WHOLE = {"double": 2.0**52, "single": 2.0**23}
# Quotient and rest by this divisor fit a DINT for every smaller double, and both are exact.
_SPLIT = 2.0**21


def statement(entry: ListingStatement, wording: Wording, depth: int = 0) -> list[str]:
    """Write a statement of a listing, one string a line.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> total = Expression("add", (variable("a"), variable("b")))
    >>> statement(Assignment("total", total), wording)
    ['total := a + b;']
    """
    if isinstance(entry, Assignment):
        return assign(entry.name, entry.expression, wording, depth)
    lines = [_STEP * depth + wording.dialect.commented(_title(entry))]
    for start in entry.start:
        lines += assign(start.name, start.expression, wording, depth)
    if isinstance(entry, CountedLoop) and entry.count == 1 and not wording.dialect.single_turns:
        return [*lines, *wrapped(entry.index, "0", depth), *_body(entry, wording, depth)]
    if isinstance(entry, CountedLoop):
        head, end = f"FOR {entry.index} := 0 TO {entry.count - 1} DO", "END_FOR;"
    else:
        head, end = f"IF {wording.expression(entry.condition)} THEN", "END_IF;"
    inside = _body(entry, wording, depth + 1)
    return [*lines, _STEP * depth + head, *inside, _STEP * depth + end]


def _title(entry: CountedLoop | Branch) -> str:
    if isinstance(entry, Branch):
        return entry.label
    return f"{entry.label}: {entry.count} turn{'s' if entry.count > 1 else ''}"


def _body(entry: CountedLoop | Branch, wording: Wording, depth: int) -> list[str]:
    """Write what a loop repeats or a branch does, up to the next values of what it carries."""
    turns = entry.rings if isinstance(entry, CountedLoop) else ()
    lines = []
    for turn in turns:
        if turn.oldest:
            signal = turn.ring.signal
            place = ring_place(signal.identifier, is_ring(turn.ring))
            lines += wrapped(turn.oldest, place, depth)
    for inner in entry.body:
        lines += statement(inner, wording, depth)
    for turn in turns:
        lines += _written(turn, wording, depth)
    for update in entry.update:
        lines += assign(update.name, update.expression, wording, depth)
    return lines


def _written(turn: RingTurn, wording: Wording, depth: int) -> list[str]:
    name, array = turn.ring.signal.identifier, is_ring(turn.ring)
    lines = assign(ring_place(name, array), turn.written, wording, depth)
    return lines + (advance(name, turn.ring.length, depth) if array else [])


def ring_place(name: str, array: bool = True) -> str:
    """Return where the oldest value of a ring stands.

    Examples
    --------
    >>> ring_place("flow")
    'flow[flow_position]'
    """
    return f"{name}[{name}_position]" if array else name


def advance(name: str, length: int, depth: int = 0) -> list[str]:
    """Write the advance of a ring.

    Examples
    --------
    >>> advance("flow", 5)
    ['flow_position := (flow_position + 1) MOD 5;']
    """
    position = f"{name}_position"
    return wrapped(position, f"({position} + 1) MOD {length}", depth)


def assign(name: str, expression: Expression, wording: Wording, depth: int = 0) -> list[str]:
    """Write ``name := expression``; a choice becomes IF, rounding a few statements.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> limited = Expression("minimum", (variable("a"), variable("b")))
    >>> print("\\n".join(assign("u", limited, wording)))
    IF a < b THEN
      u := a;
    ELSE
      u := b;
    END_IF;
    """
    code, operands = expression.code, expression.operands
    if code in ("floor", "ceiling"):
        return _whole(name, code, wording.expression(operands[0]), wording, depth)
    if code not in ("select", "maximum", "minimum", "number"):
        return wrapped(name, wording.expression(expression), depth)
    indent = _STEP * depth
    condition, first, second = _choice(expression, wording)
    lines = [f"{indent}IF {condition} THEN", *assign(name, first, wording, depth + 1)]
    while second.code == "select":
        condition, first, second = _choice(second, wording)
        lines.append(f"{indent}ELSIF {condition} THEN")
        lines += assign(name, first, wording, depth + 1)
    if second != variable(name):
        lines += [f"{indent}ELSE", *assign(name, second, wording, depth + 1)]
    return [*lines, f"{indent}END_IF;"]


def _choice(expression: Expression, wording: Wording) -> tuple[str, Expression, Expression]:
    """Return condition and both branches."""
    code, operands = expression.code, expression.operands
    if code == "select":
        return wording.expression(operands[0]), operands[1], operands[2]
    if code == "number":
        one, zero = Expression("constant", number=1.0), Expression("constant")
        return wording.expression(operands[0]), one, zero
    first, second = operands
    sign = ">" if code == "maximum" else "<"
    return f"{wording.expression(first)} {sign} {wording.expression(second)}", first, second


def _whole(name: str, code: str, text: str, wording: Wording, depth: int) -> list[str]:
    """Write the largest whole number not above, or the smallest not below, a value.

    The standard has a cut-off to a DINT only. A double is cut off in two parts that both fit; a
    single-precision number that is not whole fits at once. The product with zero keeps the sign
    of zero; not a number and infinity stay what they are.
    """
    beyond, correction = (">", "-") if code == "floor" else ("<", "+")
    what = "largest whole number not above" if code == "floor" else "smallest one not below"
    one, zero, split = map(wording.literal, (1.0, 0.0, _SPLIT))

    def cut(value: str) -> str:
        return f"DINT_TO_{wording.real}({wording.dialect.truncate}({value}))"

    if wording.precision == "double":
        parts = [
            f"  {name} := {split} * {cut(f'{text} / {split}')};",
            f"  {name} := {name} + {cut(f'{text} - {name}')};",
        ]
    else:
        parts = [f"  {name} := {cut(text)};"]
    lines = [
        wording.dialect.commented(f"{name} is the {what} {text}"),
        f"IF ABS({text}) < {wording.literal(_WHOLE[wording.precision])} THEN",
        *parts,
        f"  IF {name} {beyond} {text} THEN",
        f"    {name} := {name} {correction} {one};",
        "  END_IF;",
        f"  IF {name} = {zero} THEN",
        f"    {name} := {text} * {zero};",
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
