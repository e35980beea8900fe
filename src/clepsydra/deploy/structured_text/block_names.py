"""Names within blocks that a system cannot take as they are."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.owned_state import with_owned_state
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
        block, instance = with_block_names(statement.program, words), statement.instance
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


def state_paths(program: Program, words: frozenset[str]) -> list[tuple[str, ...]]:
    """Return where each state of a program stands in the text: instances, then its own name.

    Parameters
    ----------
    program : Program
        As it is given to the printer.
    words : frozenset of str
        Of the system, in upper case.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("flow_total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "feed", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> state_paths(law, frozenset())
    [('feed', 'sum')]
    """
    printed = with_block_names(with_owned_state(program), words)
    return [_path(printed, place) for place in range(len(program.state))]


def _path(program: Program, place: int) -> tuple[str, ...]:
    for call in program.calls:
        if place in call.arguments[: len(call.program.state)]:
            return (call.instance, *_path(call.program, call.arguments.index(place)))
    return (signal_of(program.state[place]).identifier,)
