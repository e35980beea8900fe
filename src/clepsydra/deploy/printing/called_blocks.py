"""The blocks that a printed program consists of, in the order in which they are printed."""

from __future__ import annotations

from clepsydra.deploy.printing.needed import needed_part
from clepsydra.program.program import Call, Program


def called_blocks(program: Program) -> tuple[Program, ...]:
    """Return every block whose calls are printed, each once, behind those that it calls itself.

    Raises
    ------
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Call, Operation
    >>> ports = {"state": (), "inputs": (Signal("a"),), "parameters": (), "outputs": (Signal("b"),)}
    >>> twice = Program("twice", block=Block(1, (Operation(1, "add", (0, 0)),), (1,)), **ports)
    >>> calls = Call((1,), twice, "first", (0,)), Call((2,), twice, "second", (1,))
    >>> four = Program("four", block=Block(1, calls, (2,)), **ports)
    >>> law = Program("law", block=Block(1, (Call((1,), four, "four", (0,)),), (1,)), **ports)
    >>> [block.name for block in called_blocks(law)]
    ['twice', 'four']
    """
    found: dict[str, Program] = {}
    for call in needed_calls(program):
        for block in (*called_blocks(call.program), call.program):
            if found.setdefault(block.name, block) != block:
                raise ValueError(f"{program.name}: two different blocks have the name {block.name}")
    return tuple(found.values())


def needed_calls(program: Program) -> tuple[Call, ...]:
    """Return the calls that are printed: those whose results something reads.

    Examples
    --------
    See `called_blocks`.
    """
    statements = needed_part(program.block)[0].statements
    return tuple(each for each in statements if isinstance(each, Call))
