"""The blocks that a program calls, and what of their ports somebody reads."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import replace

from clepsydra.program.builder import BlockBuilder
from clepsydra.program.inlined import rewritten
from clepsydra.program.needed import needed_part
from clepsydra.program.program import Call, Program


def called_blocks(program: Program) -> tuple[Program, ...]:
    """Return every block that is called, each once, behind those that it calls itself.

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
    for call in program.calls:
        for block in (*called_blocks(call.program), call.program):
            if found.setdefault(block.name, block) != block:
                raise ValueError(f"{program.name}: two different blocks have the name {block.name}")
    return tuple(found.values())


def without_untold(program: Program) -> Program:
    """Return a program whose blocks tell only what some caller reads, of their optional outputs.

    Every other port stays, so that the blocks of two exports are the same.

    Raises
    ------
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> body = Block(1, (Operation(1, "negate", (0,)),), (1, 0))
    >>> outputs = (Signal("y"), Signal("pump.sound", optional=True))
    >>> turned = Program("turned", (), (Signal("u"),), (), outputs, body)
    >>> calls = Block(1, (Call((1, 2), turned, "sign", (0,)),), (1,))
    >>> law = Program("law", (), (Signal("u"),), (), (Signal("y"),), calls)
    >>> [signal.name for signal in without_untold(law).calls[0].program.outputs]
    ['y']
    """
    blocks = called_blocks(program)
    read = {
        block.name: {k for k, s in enumerate(block.outputs) if not s.optional} for block in blocks
    }
    for each in (program, *reversed(blocks)):
        needed, uses = needed_part(_results(each, read.get(each.name)).block)
        for call in (each for each in needed.statements if isinstance(each, Call)):
            outputs = call.targets[len(call.program.state) :]
            read[call.program.name].update(k for k, v in enumerate(outputs) if v in uses)
    done: dict[str, Program] = {}
    for block in blocks:
        done[block.name] = _rewired(_results(block, read[block.name]), done, read)
    return _rewired(program, done, read) if blocks else program


def _results(program: Program, outputs: Container[int] | None) -> Program:
    """Return a program with some of its outputs, all where none are named."""
    if outputs is None:
        return program
    kept = [k for k in range(len(program.outputs)) if k in outputs]
    results = (*program.next_state, *(program.output_values[k] for k in kept))
    return replace(
        program,
        outputs=tuple(program.outputs[k] for k in kept),
        block=replace(program.block, results=results),
    )


def _rewired(
    program: Program, done: Mapping[str, Program], read: Mapping[str, Container[int]]
) -> Program:
    """Return a program that calls blocks which tell less."""

    def called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> list[int]:
        states, outputs = len(call.program.state), range(len(call.program.outputs))
        given = [place[value] for value in call.arguments]
        targets = iter(builder.call(done[call.program.name], call.instance, given))
        kept = [True] * states + [k in read[call.program.name] for k in outputs]
        # Nothing reads the others.
        return [next(targets) if each else -1 for each in kept]

    return rewritten(program, called)
