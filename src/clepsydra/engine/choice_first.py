"""One quotient of what is chosen, in place of a choice of two quotients: the divider is slow."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from clepsydra.engine.staying import staying
from clepsydra.program.operation import Operation
from clepsydra.program.program import (
    Block,
    Conditional,
    ForLoop,
    Program,
    Statement,
)

#: Operations that take several times as long as a choice.
_SLOW = "divide", "square_root"


def choosing_first(program: Program) -> Program:
    """Return a program in which ``c ? a/b : d/e`` is ``(c ? a : d) / (c ? b : e)``, and so a root.

    It is the same operation on the same numbers, so no bit changes. A quotient of what stays from
    sample to sample, or from turn to turn, is left alone: it is computed once.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> statements = (
    ...     Operation(2, "square_root", (0,)), Operation(3, "square_root", (1,)),
    ...     Operation(4, "less", (0, 1)), Operation(5, "select", (4, 2, 3)),
    ... )
    >>> block = Block(2, statements, (5,), frozenset([4]))
    >>> inputs = Signal("a"), Signal("b")
    >>> program = Program("root", (), inputs, (), (Signal("y"),), block)
    >>> [each.code for each in choosing_first(program).block.statements]
    ['less', 'select', 'square_root']
    """
    block = _choosing_first(program.block, program.parameter_arguments)
    return program if block is program.block else replace(program, block=block)


def _choosing_first(block: Block, constant: Collection[int]) -> Block:
    """Return the block with its bodies, or itself where nothing changes; `constant` stays."""
    stays, uses = staying(block, constant), block.uses()
    made: dict[int, Operation] = {}
    found: list[list[Statement]] = []
    places: dict[int, int] = {}
    for place, each in enumerate(block.statements):
        found.append([_with_body(each)])
        if not isinstance(each, Operation):
            continue
        made[each.target], places[each.target] = each, place
        if each.code != "select":
            continue
        one, other = (made.get(value) for value in each.arguments[1:])
        if one is None or other is None or one.target == other.target:
            continue
        alone = all(uses[q.target] == 1 and q.target not in stays for q in (one, other))
        if alone and one.code == other.code and one.code in _SLOW:
            chosen = [*_chosen(each, one, other)]
            found[place], made[each.target] = [*chosen], chosen[-1]
            for quotient in one, other:
                found[places[quotient.target]].pop()
    statements = tuple(each for group in found for each in group)
    return block if statements == block.statements else replace(block, statements=statements)


def _chosen(select: Operation, one: Operation, other: Operation) -> Iterator[Operation]:
    """Yield the choices of operands, named as the quotients were, and the quotient of them."""
    given = []
    for target, a, b in zip(
        (one.target, other.target), one.arguments, other.arguments, strict=False
    ):
        if a != b:
            yield Operation(target, "select", (select.arguments[0], a, b))
        given.append(a if a == b else target)
    yield replace(one, target=select.target, arguments=tuple(given))


def _with_body(statement: Statement) -> Statement:
    if isinstance(statement, ForLoop):
        turning = len(statement.tables) + len(statement.carried) + len(statement.rings)
        constant = range(turning, statement.body.arguments)
        return replace(statement, body=_choosing_first(statement.body, constant))
    if isinstance(statement, Conditional):
        return replace(statement, body=_choosing_first(statement.body, ()))
    return statement
