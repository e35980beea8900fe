"""The calls of a printed program as instances of function blocks: names, and a first scan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.inlined import append, renamed
from clepsydra.program.owned_state import RESTART, has_starts
from clepsydra.program.program import Call, Program


def with_block_names(program: Program, words: frozenset[str]) -> Program:
    """Return a program whose calls, and what they call, have names of a system.

    No instance has the name of a signal of its caller, and no signal of a block that is called
    is a word of the system: that block comes from us, not from its user.

    Parameters
    ----------
    program : Program
    words : frozenset of str
        Of the system, in upper case.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> twice = Program("twice", (), (Signal("ramp"),), (), (Signal("b"),),
    ...                 Block(1, (Operation(1, "add", (0, 0)),), (1,)))
    >>> calls = Block(1, (Call((1,), twice, "flow", (0,)),), (1,))
    >>> law = Program("law", (), (Signal("flow"),), (), (Signal("y"),), calls)
    >>> (call,) = with_block_names(law, frozenset({"RAMP"})).calls
    >>> call.instance, call.program.inputs[0].name
    ('flow_block', 'ramp_value')
    """
    taken = {signal.identifier.lower() for signal in (*program.given, *program.outputs)}

    def no_word(signal: Signal) -> Signal:
        is_word = signal.identifier.upper() in words
        return replace(signal, name=f"{signal.name}_value") if is_word else signal

    def named(call: Call) -> Call:
        block = with_block_names(call.program, words).with_signals(no_word)
        # All of them are wired, so none begins with a value of its own.
        inputs = tuple(replace(signal, initial=0.0) for signal in block.inputs)
        told = {f"{name}_value": text for name, text in block.words.items()} | {**block.words}
        clash = "_block" if call.identifier.lower() in taken else ""
        named = replace(block, words=told, inputs=inputs)
        return replace(call, instance=call.identifier + clash, program=named)

    return program.with_calls(named)


def remembering(block: Program) -> Program:
    """Return a block that in its first scan, too, begins with the start values that it is told."""
    if not has_starts(block):
        return block
    inside, states = block.block, len(block.state)
    taken = [signal.identifier for signal in (*block.given, *block.outputs)]
    taken += [call.identifier for call in block.calls]
    name = Identifiers(taken, ignore_case=True).new("begun")
    begun = Signal(name, kind="boolean", description="has run; else it begins with start values")
    builder = BlockBuilder(inside.arguments + 1)
    given = [*range(states), *range(states + 1, inside.arguments + 1)]
    restart = states + [signal.name for signal in block.inputs].index(RESTART)
    first = builder.operation("not", states)
    given[restart] = builder.operation("number", builder.operation("or", given[restart], first))

    def called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> Sequence[int]:
        arguments = [place[value] for value in call.arguments]
        return builder.call(call.program, call.instance, arguments)

    values, place = append(builder, inside, given, called)
    results = [*values[:states], builder.constant(1.0), *values[states:]]
    state, names = (*block.state, begun), renamed(block, place)
    return replace(block, state=state, block=builder.finish(results), names=names)
