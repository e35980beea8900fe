"""The blocks that a program calls, and what of their ports somebody reads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from clepsydra.program.builder import BlockBuilder
from clepsydra.program.inlined import append, renamed
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


def without_unread_ports(program: Program) -> Program:
    """Return a program whose blocks have no output that no caller reads, and no input unread.

    Raises
    ------
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    Nobody reads the sum, so nobody has to give b:

    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> a, b, y = map(Signal, "aby")
    >>> body = Block(2, (Operation(2, "add", (0, 1)), Operation(3, "negate", (0,))), (2, 3))
    >>> both = Program("both", (), (a, b), (), (Signal("sum"), y), body)
    >>> calls = Block(2, (Call((2, 3), both, "pair", (0, 1)),), (3,))
    >>> (call,) = without_unread_ports(Program("law", (), (a, b), (), (y,), calls)).calls
    >>> [signal.name for signal in (*call.program.inputs, *call.program.outputs)]
    ['a', 'y']
    """
    while program.calls:
        found = _reduced(program)
        if found == program:
            break
        program = found
    return program


@dataclass(frozen=True)
class _Reduced:
    """A block, and which of its inputs and outputs are left."""

    block: Program
    inputs: Sequence[int]
    outputs: Sequence[int]


def _reduced(program: Program) -> Program:
    blocks = called_blocks(program)
    read: dict[str, set[int]] = {block.name: set() for block in blocks}
    for each in (program, *reversed(blocks)):
        left = None if each is program else read[each.name]
        needed, uses = needed_part(_results(each, left).block)
        for call in (each for each in needed.statements if isinstance(each, Call)):
            outputs = call.targets[len(call.program.state) :]
            read[call.program.name].update(k for k, v in enumerate(outputs) if v in uses)
    done: dict[str, _Reduced] = {}
    for block in blocks:
        done[block.name] = _with_reduced(block, done, read[block.name])
    return _with_reduced(program, done).block


def _results(program: Program, outputs: set[int] | None) -> Program:
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


def _with_reduced(
    program: Program, done: Mapping[str, _Reduced], outputs: set[int] | None = None
) -> _Reduced:
    """Return a program without what nobody reads, that calls blocks without that too."""
    given = _results(program, outputs)
    uses = needed_part(given.block)[1]
    inputs = [k for k, v in enumerate(program.input_arguments) if outputs is None or v in uses]
    left = [*program.state_arguments, *(program.input_arguments[k] for k in inputs)]
    left += program.parameter_arguments
    arguments = [_UNREAD] * given.block.arguments
    for k, value in enumerate(left):
        arguments[value] = k

    def called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> list[int]:
        reduced, states = done[call.program.name], len(call.program.state)
        values = [place[value] for value in call.arguments]
        values[states:] = [values[states + k] for k in reduced.inputs]
        targets = builder.call(reduced.block, call.instance, values)
        found = [_UNREAD] * len(call.targets)
        left = [*range(states), *(states + k for k in reduced.outputs)]
        for k, target in zip(left, targets, strict=True):
            found[k] = target
        return found

    builder = BlockBuilder(len(left))
    values, place = append(builder, given.block, arguments, called)
    block = replace(
        given,
        inputs=tuple(program.inputs[k] for k in inputs),
        block=builder.finish(values),
        names=renamed(given, place),
    )
    return _Reduced(block, inputs, sorted(outputs or ()))


#: Stands for a value that nothing reads.
_UNREAD = -1
