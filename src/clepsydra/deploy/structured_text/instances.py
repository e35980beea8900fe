"""The calls of a printed program as instances of function blocks: names, and a first scan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.entries import signal_of
from clepsydra.program.inlined import append, renamed
from clepsydra.program.owned_state import RESTART, RESTARTS, has_starts
from clepsydra.program.program import Call, Program

#: The state that tells the first scan from the others.
BEGUN = "begun"
_ABOUT = "has run; else the blocks begin with their start values"


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


def beginning(program: Program) -> Program:
    """Return a program whose instances begin in its first scan with what they are told.

    Their start values are inputs: a retained state says whether the program has run. It lives in
    the block that tells all instances when to begin anew, if there is one, or else in the program.
    """
    block, states = program.block, len(program.state)
    if not any(has_starts(call.program) for call in program.calls):
        return program
    teller = _teller(program)
    begun = Signal(_names_of(program).new(BEGUN), kind="boolean", description=_ABOUT)
    builder = BlockBuilder(block.arguments + 1)
    told: list[int] = []

    def called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> Sequence[int]:
        given = [place[value] for value in call.arguments]
        if teller and call.instance == teller[0].instance:
            kept = len(call.program.state)
            given.insert(kept, states)
            *targets, restart = builder.call(_telling(*teller), call.instance, given)
            told.extend((targets.pop(kept), restart))
            return targets
        for k, signal in enumerate(call.program.inputs, len(call.program.state)):
            if signal.name == RESTART and has_starts(call.program):
                first = told[1] if told else builder.operation("not", states)
                given[k] = first if told else builder.operation("or", first, given[k])
        return builder.call(call.program, call.instance, given)

    given = [*range(states), *range(states + 1, block.arguments + 1)]
    values, place = append(builder, block, given, called)
    runs = told[0] if told else builder.constant(1.0)
    results = [*values[:states], runs, *values[states:]]
    state, names = (*program.state, begun), renamed(program, place)
    return replace(program, state=state, block=builder.finish(results), names=names)


def _names_of(program: Program) -> Identifiers:
    """Return the scope of a program, with the names of its signals and instances."""
    taken = [signal.identifier for signal in (*program.given, *program.outputs)]
    return Identifiers([*taken, *(call.identifier for call in program.calls)], ignore_case=True)


def _teller(program: Program) -> tuple[Call, int] | None:
    """Return the call of whose outputs one tells all instances when to begin, and which one.

    No other call is of its block, whose own names leave room for what it is to tell.
    """
    made = program.block.made
    restarts = set()
    for call in (each for each in program.calls if has_starts(each.program)):
        value = {signal.name: value for signal, value in call.ports()}[RESTART]
        truth = value in made and made[value].code == "truth"
        restarts.add(made[value].arguments[0] if truth else value)
    blocks = [call.program.name for call in program.calls]
    for call in program.calls:
        block = call.program
        outputs = call.targets[len(block.state) :]
        entries = (*block.state, *block.inputs, *block.outputs)
        free = {BEGUN, RESTART}.isdisjoint(signal_of(entry).name for entry in entries)
        if len(restarts) == 1 and restarts <= {*outputs} and free and blocks.count(block.name) == 1:
            return call, outputs.index(*restarts)
    return None


def _telling(call: Call, output: int) -> Program:
    """Return a block that also tells its caller, by its last output, when instances begin anew."""
    block, states = call.program.block, len(call.program.state)
    builder = BlockBuilder(block.arguments + 1)
    given = [*range(states), *range(states + 1, block.arguments + 1)]

    def called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> Sequence[int]:
        arguments = [place[value] for value in call.arguments]
        return builder.call(call.program, call.instance, arguments)

    values, place = append(builder, block, given, called)
    first = builder.operation("not", states)
    restart = builder.operation("or", first, values[states + output])
    results = [*values[:states], builder.constant(1.0), *values[states:]]
    return replace(
        call.program,
        state=(*call.program.state, Signal(BEGUN, kind="boolean", description=_ABOUT)),
        outputs=(*call.program.outputs, RESTARTS),
        block=builder.finish([*results, builder.operation("number", restart)]),
        names=renamed(call.program, place),
    )
