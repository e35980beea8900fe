"""A program whose values are counted without gaps, so that what was left out leaves no trace."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from clepsydra.program.operation import Operation
from clepsydra.program.program import (
    Block,
    Call,
    Conditional,
    Program,
    Statement,
    read_by,
    written_by,
)
from clepsydra.program.routine import RoutineCall


def renumbered(program: Program) -> Program:
    """Return the same program with its values counted in the order in which they are computed.

    Statements that nobody reads leave gaps in the numbers of a block, and how many there were is
    no part of what it computes; nor is where a constant stands, which comes where it is read.

    Examples
    --------
    >>> block = Block(1, (Operation(7, "add", (0, 0)), Operation(9, "negate", (7,))), (9,))
    >>> renumbered(Program("law", (), (), (), (), block, {7: "twice", 8: "unread"})).names
    {1: 'twice'}
    """
    block, numbers = _block(program.block)
    names = {numbers[value]: name for value, name in program.names.items() if value in numbers}
    return replace(program, block=block, names=names)


def _block(block: Block) -> tuple[Block, dict[int, int]]:
    """Return a block that is counted anew, and the new number of each of its values."""
    numbers = {value: value for value in range(block.arguments)}

    def new(values: Iterable[int]) -> tuple[int, ...]:
        return tuple(numbers[value] for value in values)

    def counted(each: Statement) -> Statement:
        if isinstance(each, Operation):
            return replace(each, target=numbers[each.target], arguments=new(each.arguments))
        if isinstance(each, Call):
            called = renumbered(each.program)
            targets, given = new(each.targets), new(each.arguments)
            return replace(each, targets=targets, program=called, arguments=given)
        if isinstance(each, RoutineCall):
            return replace(each, targets=new(each.targets), arguments=new(each.arguments))
        changed = replace(
            each,
            targets=new(each.targets),
            carried=new(each.carried),
            invariants=new(each.invariants),
            body=_block(each.body)[0],
        )
        if isinstance(changed, Conditional):
            return replace(changed, condition=numbers[changed.condition])
        return changed

    statements: list[Statement] = []
    constants: dict[int, Operation] = {}

    def add(each: Statement) -> None:
        for value in written_by(each):
            numbers[value] = len(numbers)
        statements.append(counted(each))

    def read(values: Iterable[int]) -> None:
        for value in values:
            if value in constants:
                add(constants.pop(value))

    for each in block.statements:
        if isinstance(each, Operation) and each.code == "constant":
            constants[each.target] = each
        else:
            read(read_by(each))
            add(each)
    read(block.results)
    truths = frozenset(numbers[value] for value in block.truths if value in numbers)
    results = new(block.results)
    return replace(block, statements=tuple(statements), results=results, truths=truths), numbers
