"""A program without fused operations, for targets that have none."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, Program, Statement


def without_fused(program: Program) -> Program:
    """Return a program in which no multiplication is fused into an addition.

    It computes what CasADi computes, with a rounding after every operation, and every printer
    takes it.

    Examples
    --------
    >>> square = Block(1, (Operation(1, "multiply", (0, 0), fused=True),), (1,))
    >>> program = Program("square", (), (), (), (), square)
    >>> [operation.fused for operation in without_fused(program).block.operations()]
    [False]
    """
    return replace(program, block=_block(program.block))


def _block(block: Block) -> Block:
    return replace(block, statements=tuple(_statement(s) for s in block.statements))


def _statement(statement: Statement) -> Statement:
    if isinstance(statement, Operation):
        return replace(statement, fused=False)
    if isinstance(statement, Call):
        return replace(statement, program=without_fused(statement.program))
    return replace(statement, body=_block(statement.body))
