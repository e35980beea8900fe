"""The statements of a listing, in any language: assignments, choices as IF, counted loops."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from clepsydra.deploy.printing.expressions import Expression, as_select, variable
from clepsydra.deploy.printing.language import Language
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Compound,
    ListingStatement,
    parts,
)
from clepsydra.program.entries import is_ring


def indented(lines: Iterable[str]) -> list[str]:
    """Return lines a step further in.

    Examples
    --------
    >>> indented(["u := 0.0;"])
    ['  u := 0.0;']
    """
    return [f"  {line}" for line in lines]


def statements(entries: Sequence[ListingStatement], language: Language) -> list[str]:
    """Write the statements of a listing; what one condition decides stands in one IF.

    Each statement stands on one line, however long it is.

    Examples
    --------
    >>> from clepsydra.deploy.c99.language import C99
    >>> from clepsydra.deploy.printing.expressions import flag, variable
    >>> begun = [Assignment(n, Expression("select", (flag("cold"), variable("u"), variable(n))))
    ...          for n in ("a", "b")]
    >>> print("\\n".join(statements(begun, C99("law", "double"))))
    if (cold) {
      a = u;
      b = u;
    }
    """
    lines: list[str] = []
    rest = list(entries)
    while rest:
        group = _decided_by_one(rest, language)
        if len(group) < 2:
            lines += _statement(rest.pop(0), language)
            continue
        del rest[: len(group)]
        choices = [(each.name, *_choice(each.expression)) for each in group]
        lines.append(language.syntax.opened.format(language.expression(choices[0][1])))
        for name, _, first, _ in choices:
            lines += indented(assign(name, first, language))
        others = [(name, second) for name, _, _, second in choices if not _keeps(name, second)]
        lines += [language.syntax.otherwise] if others else []
        for name, second in others:
            lines += indented(assign(name, second, language))
        lines.append(language.syntax.closed)
    return lines


def _statement(entry: ListingStatement, language: Language) -> list[str]:
    if isinstance(entry, Assignment):
        return assign(entry.name, entry.expression, language)
    if isinstance(entry, BlockCall):
        return language.call(entry)
    title = entry.label
    if entry.condition is None:
        title += f": {entry.count} turn{'s' if entry.count > 1 else ''}"
    lines = [language.syntax.comment.format(title), *_assigned(entry.start, language)]
    inside = _body(entry, language)
    if entry.condition is not None:
        head = language.syntax.opened.format(language.expression(entry.condition))
        return [*lines, head, *indented(inside), language.syntax.closed]
    if entry.count == 1:
        return [*lines, *inside]
    head = language.syntax.counted.format(entry.index, entry.count, entry.count - 1)
    return [*lines, head, *indented(inside), language.syntax.loop_closed]


def _assigned(entries: Iterable[Assignment], language: Language) -> list[str]:
    return [line for each in entries for line in assign(each.name, each.expression, language)]


def _body(entry: Compound, language: Language) -> list[str]:
    """Write what a loop repeats or a branch does, up to the next values of what it carries."""
    places = [f"{language.syntax.states}{turn.ring.signal.identifier}" for turn in entry.rings]
    turns = [
        (turn, place, ring_place(place, is_ring(turn.ring)))
        for turn, place in zip(entry.rings, places, strict=True)
    ]
    read = [Assignment(turn.oldest, variable(at)) for turn, _, at in turns if turn.oldest]
    lines = [*_assigned(read, language), *statements(entry.body, language)]
    for turn, place, at in turns:
        lines += assign(at, turn.written, language)
        lines += advance(place, turn.ring.length, language) if is_ring(turn.ring) else []
    return [*lines, *_assigned(entry.update, language)]


def ring_place(name: str, array: bool = True) -> str:
    """Return where the oldest value of a ring stands.

    Examples
    --------
    >>> ring_place("flow")
    'flow[flow_position]'
    """
    return f"{name}[{name}_position]" if array else name


def advance(name: str, length: int, language: Language) -> list[str]:
    """Write the advance of a ring to the place of its next oldest value.

    Examples
    --------
    >>> from clepsydra.deploy.c99.language import C99
    >>> advance("flow", 5, C99("law", "double"))
    ['flow_position = flow_position + 1 < 5 ? flow_position + 1 : 0;']
    """
    position = f"{name}_position"
    following = language.syntax.advanced.format(position, length)
    return [language.syntax.assignment.format(position, following)]


def assign(
    name: str, expression: Expression, language: Language, held: Expression | None = None
) -> list[str]:
    """Write an assignment; a choice that the language has no expression for becomes IF.

    Parameters
    ----------
    name : str
    expression : Expression
    language : Language
    held : Expression, optional
        What the variable is already.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.deploy.structured_text.wording import Wording
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> falls = Expression("less", (variable("level"), variable("limit")))
    >>> more = Expression("divide", (variable("gain"), variable("time")))
    >>> chosen = Expression("select", (falls, more, variable("rest")))
    >>> print("\\n".join(assign("u", chosen, wording)))
    u := rest;
    IF level < limit THEN
      u := gain / time;
    END_IF;
    """
    syntax = language.syntax
    if not _branches(name, expression, language):
        return [syntax.assignment.format(name, language.expression(expression))]
    condition, first, second = _choice(expression)
    before: list[str] = []
    if held is None and second.is_atom and not name_in(name, expression):
        # What holds otherwise comes first.
        before, held = assign(name, second, language), second
    head = syntax.opened.format(language.expression(condition))
    lines = [head, *indented(assign(name, first, language, held))]
    while second.code == "select":
        condition, first, second = _choice(second)
        lines.append(syntax.another.format(language.expression(condition)))
        lines += indented(assign(name, first, language, held))
    if second != held and not _keeps(name, second):
        lines += [syntax.otherwise, *indented(assign(name, second, language, held))]
    return [*before, *lines, syntax.closed]


def _branches(name: str, expression: Expression, language: Language) -> bool:
    """Whether an assignment is written with IF."""
    if expression.code == "real":
        expression = expression.operands[0]
    if not expression.is_choice:
        return False
    kept = _keeps(name, _choice(expression)[2])
    return kept or not language.notation.writes(expression)


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


def _decided_by_one(entries: Sequence[ListingStatement], language: Language) -> list[Assignment]:
    """Return the assignments at the beginning that the same condition decides."""
    found: list[Assignment] = []
    for each in entries:
        if not isinstance(each, Assignment) or not _branches(each.name, each.expression, language):
            break
        condition = _choice(each.expression)[0]
        if found and condition != _choice(found[0].expression)[0]:
            break
        found.append(each)
        if name_in(each.name, condition):
            break
    return found
