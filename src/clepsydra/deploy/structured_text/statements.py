"""Statements of Structured Text: assignments, choices as IF, rounding, counted loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clepsydra.deploy.printing.expressions import Expression
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Branch,
    CountedLoop,
    ListingStatement,
    RingTurn,
    parts,
)
from clepsydra.deploy.printing.typed_values import truth_form, whole_form
from clepsydra.deploy.structured_text.wording import Wording, as_select
from clepsydra.program.entries import is_ring
from clepsydra.program.program import COMPARISONS

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
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> total = Expression("add", (variable("a"), variable("b")))
    >>> statement(Assignment("total", total), wording)
    ['total := a + b;']
    """
    if isinstance(entry, Assignment):
        return assign(entry.name, entry.expression, wording, depth)
    if isinstance(entry, BlockCall):
        return [_STEP * depth + _call(entry, wording)]
    lines = [_STEP * depth + wording.dialect.commented(_title(entry))]
    for start in entry.start:
        lines += assign(start.name, start.expression, wording, depth)
    if isinstance(entry, CountedLoop) and entry.count == 1:
        return [*lines, *_body(entry, wording, depth)]
    if isinstance(entry, CountedLoop):
        head, end = f"FOR {entry.index} := 0 TO {entry.count - 1} DO", "END_FOR;"
    else:
        head, end = f"IF {wording.expression(entry.condition)} THEN", "END_IF;"
    inside = _body(entry, wording, depth + 1)
    return [*lines, _STEP * depth + head, *inside, _STEP * depth + end]


def _call(entry: BlockCall, wording: Wording) -> str:
    """Write the call of an instance, on one line however long it is.

    An input that is a constant stays what it is declared with where it is that.
    """
    given = []
    for signal, argument in zip(entry.program.inputs, entry.arguments, strict=True):
        value = of_kind(signal.kind, argument)
        declared = Expression("constant", number=signal.initial)
        # By their texts: equal numbers may be zeros of different sign.
        if repr(value) == repr(of_kind(signal.kind, declared)):
            continue
        text = wording.expression(value)
        if value.code in COMPARISONS:
            text = f"({text})"
        given.append(f"{signal.identifier} := {text}")
    return f"{entry.instance}({', '.join(given)});"


def of_kind(kind: str, number: Expression) -> Expression:
    """Return a number in the type of a signal; that it fits has been proved.

    Examples
    --------
    >>> of_kind("boolean", Expression("number", (Expression("flag", text="good"),))).text
    'good'
    """
    if kind == "boolean":
        return truth_form(number) or Expression("truth", (number,))
    if kind == "integer":
        return whole_form(number) or Expression("rounded", (number,))
    return number


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
    lines += statements(entry.body, wording, depth)
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


def assign(
    name: str,
    expression: Expression,
    wording: Wording,
    depth: int = 0,
    held: Expression | None = None,
) -> list[str]:
    """Write ``name := expression``; a choice becomes IF, rounding a few statements.

    Parameters
    ----------
    name : str
    expression : Expression
    wording : Wording
    depth : int
        Steps of indentation.
    held : Expression, optional
        What the variable is already.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> falls = Expression("less", (variable("level"), variable("limit")))
    >>> more = Expression("divide", (variable("gain"), variable("time")))
    >>> chosen = Expression("select", (falls, more, variable("rest")))
    >>> print("\\n".join(assign("u", chosen, wording)))
    u := rest;
    IF level < limit THEN
      u := gain / time;
    END_IF;
    """
    code, indent = expression.code, _STEP * depth
    if code in ("floor", "ceiling"):
        return _whole(name, code, wording.expression(expression.operands[0]), wording, depth)
    if not _branches(name, expression, wording):
        return wrapped(name, wording.expression(expression), depth)
    condition, first, second = _choice(expression)
    before: list[str] = []
    if held is None and second.is_atom and not name_in(name, expression):
        # What holds otherwise comes first.
        before, held = assign(name, second, wording, depth), second
    lines = [f"{indent}IF {wording.expression(condition)} THEN"]
    lines += assign(name, first, wording, depth + 1, held)
    while second.code == "select":
        condition, first, second = _choice(second)
        lines.append(f"{indent}ELSIF {wording.expression(condition)} THEN")
        lines += assign(name, first, wording, depth + 1, held)
    if second != held and not _keeps(name, second):
        lines += [f"{indent}ELSE", *assign(name, second, wording, depth + 1, held)]
    return [*before, *lines, f"{indent}END_IF;"]


def _branches(name: str, expression: Expression, wording: Wording) -> bool:
    """Whether an assignment is written with IF."""
    if expression.code == "real":
        expression = expression.operands[0]
    if not expression.is_choice:
        return False
    kept = _keeps(name, _choice(expression)[2])
    return kept or not wording.notation.writes(expression)


def _choice(expression: Expression) -> tuple[Expression, Expression, Expression]:
    """Return condition and both branches, in which the condition is known."""
    inner = expression.operands[0] if expression.code == "real" else as_select(expression)
    condition, first, second = inner.operands
    first, second = _known(first, condition, True), _known(second, condition, False)
    if expression.code == "real":
        first, second = Expression("real", (first,)), Expression("real", (second,))
    return condition, first, second


def _known(expression: Expression, condition: Expression, holds: bool) -> Expression:
    """Return an expression where a condition holds, or does not."""
    if expression.code == "select" and expression.operands[0] == condition:
        return _known(expression.operands[1 if holds else 2], condition, holds)
    operands = tuple(_known(each, condition, holds) for each in expression.operands)
    return replace(expression, operands=operands)


def _keeps(name: str, expression: Expression) -> bool:
    """Whether an expression is what a variable holds already."""
    return expression.code in ("variable", "integer", "flag") and expression.text == name


def name_in(name: str, expression: Expression) -> bool:
    """Whether an expression reads a variable.

    Examples
    --------
    >>> name_in("a", Expression("negate", (Expression("variable", text="a"),)))
    True
    """
    return any(part.text == name for part in parts(expression))


def statements(entries: Sequence[ListingStatement], wording: Wording, depth: int = 0) -> list[str]:
    """Write the statements of a listing; what one condition decides stands in one IF.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.deploy.printing.expressions import flag, variable
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> begun = [Assignment(n, Expression("select", (flag("cold"), variable("u"), variable(n))))
    ...          for n in ("a", "b")]
    >>> print("\\n".join(statements(begun, wording)))
    IF cold THEN
      a := u;
      b := u;
    END_IF;
    """
    lines: list[str] = []
    rest = list(entries)
    while rest:
        group = _decided_by_one(rest, wording)
        del rest[: max(len(group), 1)]
        if len(group) < 2:
            lines += statement(entries[len(entries) - len(rest) - 1], wording, depth)
            continue
        indent = _STEP * depth
        choices = [(each.name, *_choice(each.expression)) for each in group]
        lines.append(f"{indent}IF {wording.expression(choices[0][1])} THEN")
        for name, _, first, _ in choices:
            lines += assign(name, first, wording, depth + 1)
        others = [(name, second) for name, _, _, second in choices if not _keeps(name, second)]
        lines += [f"{indent}ELSE"] if others else []
        for name, second in others:
            lines += assign(name, second, wording, depth + 1)
        lines.append(f"{indent}END_IF;")
    return lines


def _decided_by_one(entries: Sequence[ListingStatement], wording: Wording) -> list[Assignment]:
    """Return the assignments at the beginning that the same condition decides."""
    found: list[Assignment] = []
    for each in entries:
        if not isinstance(each, Assignment) or not _branches(each.name, each.expression, wording):
            break
        condition = _choice(each.expression)[0]
        if found and condition != _choice(found[0].expression)[0]:
            break
        found.append(each)
        if name_in(each.name, condition):
            break
    return found


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
    """Write an assignment, however long it is.

    Examples
    --------
    >>> wrapped("total", "a + b", depth=1)
    ['  total := a + b;']
    """
    return [f"{_STEP * depth}{name} := {text};"]
