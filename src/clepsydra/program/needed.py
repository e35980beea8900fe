"""What a block really needs: what only feeds values that nobody reads does not count."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterator, Sequence
from dataclasses import replace

from clepsydra.program.operation import Operation
from clepsydra.program.program import (
    Block,
    Call,
    Conditional,
    ForLoop,
    Statement,
    read_by,
    written_by,
)
from clepsydra.program.routine import RoutineCall


def needed_part(block: Block) -> tuple[Block, Counter[int]]:
    """Return a block without what nothing needs, and how often each value is read.

    A loop or a conditional reads of its carried values and invariants only those that its body
    needs for what is read afterwards, or for a ring: a variable for any other would be set and
    never used, of which compilers warn.

    Examples
    --------
    Two turns add up u; the root is handed to them, and they do not look at it:

    >>> turn = Block(3, (Operation(3, "add", (0, 1)),), (3,))
    >>> root = Operation(1, "square_root", (0,))
    >>> block = Block(1, (root, ForLoop((2,), 2, turn, (), (0,), (0, 1), "sum")), (2,))
    >>> [type(statement).__name__ for statement in needed_part(block)[0].statements]
    ['ForLoop']
    """
    read = Counter(block.results)
    kept: list[Statement] = []
    for statement in reversed(block.statements):
        lasting = isinstance(statement, ForLoop) and statement.rings
        if lasting or any(target in read for target in written_by(statement)):
            read.update(list(_needed_by(statement, read)))
            kept.append(statement)
    kept.reverse()
    return replace(block, statements=tuple(kept), truths=block.truths & set(read)), read


def needed_values(statement: ForLoop | Conditional, read: Container[int]) -> list[int]:
    """Return which carried values count: those that are read after a statement, and in a loop
    those that a turn reads for what counts.

    Examples
    --------
    >>> turn = Block(2, (Operation(2, "add", (0, 1)),), (2, 1))
    >>> loop = ForLoop((2, 3), 2, turn, (), (0, 1), (), "sum")
    >>> needed_values(loop, {2}), needed_values(loop, {3})
    ([0, 1], [1])
    """
    live = [k for k, target in enumerate(statement.targets) if target in read]
    if isinstance(statement, Conditional):
        return live
    first = len(statement.tables)
    while True:
        inside = needed_body(statement, live)[1]
        found = [k for k in range(len(statement.targets)) if k in live or first + k in inside]
        if found == live:
            return live
        live = found


def needed_body(
    statement: ForLoop | Conditional, live: Sequence[int]
) -> tuple[Block, Counter[int]]:
    """Return the needed part of a body that computes some of its carried values only.

    Examples
    --------
    >>> turn = Block(2, (Operation(2, "add", (0, 1)),), (2, 1))
    >>> needed_body(ForLoop((2, 3), 2, turn, (), (0, 1), (), "sum"), [1])[0].results
    (1,)
    """
    count = len(statement.targets)
    rings = len(statement.rings) if isinstance(statement, ForLoop) else 0
    results = [statement.body.results[k] for k in (*live, *range(count, count + rings))]
    return needed_part(replace(statement.body, results=tuple(results)))


def _needed_by(statement: Statement, read: Container[int]) -> Iterator[int]:
    if isinstance(statement, (Operation, Call)):
        yield from read_by(statement)
        return
    if isinstance(statement, RoutineCall):
        yield from statement.needed(read).arguments_read
        return
    live = needed_values(statement, read)
    body, inside = needed_body(statement, live)
    first, last = 0, len(statement.targets)
    if isinstance(statement, Conditional):
        # A body that hands on what it gets is the same under any condition.
        if body.statements or list(body.results) != live:
            yield statement.condition
    else:
        first, last = len(statement.tables), len(statement.tables) + last + len(statement.rings)
    for k, value in enumerate(statement.carried):
        if k in live or first + k in inside:
            yield value
    for argument, value in enumerate(statement.invariants, last):
        if argument in inside:
            yield value
