"""Names within blocks that a system cannot take as they are."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.program import Call, Program, Statement


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
    groups = (*program.state, *program.inputs, *program.parameters, *program.outputs)
    taken = {signal_of(entry).identifier.lower() for entry in groups}

    def named(statement: Statement) -> Statement:
        if not isinstance(statement, Call):
            return statement
        block, instance = with_block_names(statement.program, words), statement.identifier
        block = replace(
            block,
            state=tuple(_state(entry, words) for entry in block.state),
            inputs=tuple(_not_a_word(signal, words) for signal in block.inputs),
            outputs=tuple(_not_a_word(signal, words) for signal in block.outputs),
        )
        name = f"{instance}_block" if instance.lower() in taken else instance
        return replace(statement, instance=name, program=block)

    block = replace(program.block, statements=tuple(map(named, program.block.statements)))
    return replace(program, block=block)


def _not_a_word(signal: Signal, words: frozenset[str]) -> Signal:
    taken = signal.identifier.upper() in words
    return replace(signal, name=f"{signal.name}_value") if taken else signal


def _state(entry: Entry, words: frozenset[str]) -> Entry:
    signal = _not_a_word(signal_of(entry), words)
    return replace(entry, signal=signal) if isinstance(entry, DelayRing) else signal
