"""Statements of C99: declarations, assignments, counted loops, branches, rings, tables."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from clepsydra.deploy.c99.notation import real_type
from clepsydra.deploy.printing.expressions import Expression, Notation, render
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Branch,
    CountedLoop,
    ListingStatement,
    RingTurn,
)
from clepsydra.program.entries import is_ring

_LINE = 98


def statement(entry: ListingStatement, notation: Notation, depth: int) -> list[str]:
    """Write a statement of a listing, one string a line.

    Raises
    ------
    ValueError
        It is the call of a block, inside a loop or a branch.

    Examples
    --------
    >>> from clepsydra.deploy.c99.notation import notation_of
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> total = Expression("add", (variable("a"), variable("b")))
    >>> statement(Assignment("total", total), notation_of("single"), 1)
    ['  const float total = a + b;']
    """
    if isinstance(entry, Assignment):
        return _declare(entry, notation, depth, "const ")
    if isinstance(entry, BlockCall):
        raise ValueError(f"{entry.instance}: a block is called in the equations of a law only")
    indent = "  " * depth
    lines = [line for start in entry.start for line in _declare(start, notation, depth, "")]
    if isinstance(entry, CountedLoop) and entry.count == 1:
        return [*lines, *_body(entry, notation, depth)]
    if isinstance(entry, CountedLoop):
        index, count = entry.index, entry.count
        lines.append(f"{indent}for (int32_t {index} = 0; {index} < {count}; ++{index}) {{")
    else:
        lines.append(f"{indent}if ({render(entry.condition, notation)}) {{")
    return [*lines, *_body(entry, notation, depth + 1), f"{indent}}}"]


def _body(entry: CountedLoop | Branch, notation: Notation, depth: int) -> list[str]:
    """Write what a loop repeats or a branch does, up to the next values of what it carries."""
    turns: tuple[RingTurn, ...] = entry.rings if isinstance(entry, CountedLoop) else ()
    lines = []
    for turn in turns:
        if turn.oldest:
            kept = f"const {real_type(notation)} {turn.oldest}"
            lines += assign(kept, _place(turn), depth)
    for inner in entry.body:
        lines += statement(inner, notation, depth)
    for turn in turns:
        lines += assign(_place(turn), render(turn.written, notation), depth)
        if is_ring(turn.ring):
            lines += advance(f"state->{turn.ring.signal.identifier}", turn.ring.length, depth)
    for update in entry.update:
        lines += assign(update.name, render(update.expression, notation), depth)
    return lines


def _place(turn: RingTurn) -> str:
    member = f"state->{turn.ring.signal.identifier}"
    return f"{member}[{member}_position]" if is_ring(turn.ring) else member


def _declare(assignment: Assignment, notation: Notation, depth: int, qualifier: str) -> list[str]:
    kind = "bool" if assignment.expression.is_truth else real_type(notation)
    text = render(assignment.expression, notation)
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


def declare(kind: str, name: str, depth: int) -> list[str]:
    """Write the declaration of a variable on one line, or on two where one is too long.

    Examples
    --------
    >>> declare("law_filter_outputs", "first", 1)
    ['  law_filter_outputs first;']
    """
    indent = "  " * depth
    line = f"{indent}{kind} {name};"
    return [line] if len(line) <= _LINE else [f"{indent}{kind}", f"{indent}    {name};"]


def call(function: str, arguments: Sequence[str], depth: int) -> list[str]:
    """Write a call, with as many arguments on a line as fit.

    Examples
    --------
    >>> call("law_filter_step", ["&state->first", "u", "&first"], 1)
    ['  law_filter_step(&state->first, u, &first);']
    """
    indent = "  " * depth
    *others, last = arguments
    rows = [f"{indent}{function}("]
    for text in (*(f"{each}," for each in others), f"{last});"):
        joined = rows[-1] + (" " if rows[-1].endswith(",") else "") + text
        if len(joined) <= _LINE:
            rows[-1] = joined
        else:
            rows.append(f"{indent}    {text}")
    return rows


def advance(member: str, length: int, depth: int) -> list[str]:
    """Write the advance of a ring to the place of its next oldest value.

    Examples
    --------
    >>> advance("state->flow", 5, 0)
    ['state->flow_position = state->flow_position + 1 < 5 ? state->flow_position + 1 : 0;']
    """
    following = f"{member}_position + 1"
    return assign(f"{member}_position", f"{following} < {length} ? {following} : 0", depth)


def array(left: str, values: Sequence[float], notation: Notation) -> list[str]:
    """Write an array with its values, as many on a line as fit.

    Examples
    --------
    >>> from clepsydra.deploy.c99.notation import notation_of
    >>> array("static const double table[2]", [0.1, 3.0], notation_of("double"))
    ['static const double table[2] = {', '  0.1, 3.0,', '};', '']
    """
    texts = [render(Expression("constant", number=value), notation) for value in values]
    rows = textwrap.wrap(f"{', '.join(texts)},", _LINE - 2, break_on_hyphens=False)
    return [f"{left} = {{", *(f"  {row}" for row in rows), "};", ""]
