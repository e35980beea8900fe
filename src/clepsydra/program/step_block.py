"""A step of a routine as a block, for who prints or changes blocks."""

from __future__ import annotations

from clepsydra.program.program import Block
from clepsydra.program.routine import Step


def block_of(step: Step) -> Block:
    """Return the block whose arguments are what a step reads, and whose result it writes."""
    return Block(len(step.read), step.operations, (step.result,), step.truths)
