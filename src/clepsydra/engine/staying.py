"""What stays from sample to sample, or from turn to turn: what follows from what stays."""

from __future__ import annotations

from collections.abc import Iterable

from clepsydra.program.program import Block, ForLoop, Statement, read_by, written_by


def staying(block: Block, values: Iterable[int]) -> set[int]:
    """Return given values that stay, and all that follow from them; what a ring holds does not.

    Examples
    --------
    >>> from clepsydra.program.operation import Operation
    >>> half = Operation(2, "constant", (), 0.5), Operation(3, "multiply", (1, 2))
    >>> sorted(staying(Block(2, (*half, Operation(4, "add", (0, 3))), (4,)), [1]))
    [1, 2, 3]
    """
    found = set(values)
    for statement in block.statements:
        if not has_rings(statement) and found.issuperset(read_by(statement)):
            found.update(written_by(statement))
    return found


def has_rings(statement: Statement) -> bool:
    """Whether a statement is a loop with rings, which hold what was written before."""
    return isinstance(statement, ForLoop) and bool(statement.rings)
