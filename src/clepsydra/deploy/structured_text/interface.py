"""The interface of a printed function block: names, and declared variables with comments."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.declarations import Variable, check_scope, declared
from clepsydra.deploy.printing.identifiers import check_identifier
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.pou import Section
from clepsydra.deploy.structured_text.wording import Wording, joined
from clepsydra.program.entries import signal_of
from clepsydra.program.owned_state import own_state
from clepsydra.program.program import Call, Program, Statement

_LANGUAGE = "Structured Text"


def check_names(program: Program, dialect: Dialect) -> None:
    """Refuse names that a dialect does not accept or cannot tell apart.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block
    >>> program = Program("law", (), (Signal("tank_1.level"),), (), (), Block(1, (), ()))
    >>> check_names(program, dialect_of("scl"))
    """
    place = f"program {program.name}"
    check = partial(_check_name, dialect=dialect)
    check(program.name, place)
    for call in program.calls:
        check(block_type(call.program), f"block {call.program.name}")
    signals = (*program.inputs, *program.parameters, *program.outputs, *own_state(program))
    entries = (Signal(program.name), *signals)
    check_scope(place, entries, program.calls, check, _LANGUAGE, ignore_case=True)


def _check_name(name: str, place: str, dialect: Dialect) -> None:
    check_identifier(name, place, _LANGUAGE, dialect.all_words, ignore_case=True)
    if 0 < dialect.longest_name < len(name):
        raise InputError(
            place, name, f"at most {dialect.longest_name} characters for {dialect.systems}",
            "give it a shorter name",
        )  # fmt: skip


def block_type(block: Program) -> str:
    """Return what a block that is called is named as a function block.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> block_type(Program("signal_check", (), (), (), (), Block(0, (), ())))
    'FB_SignalCheck'
    """
    return f"FB_{joined(block.name)}"


def sections(program: Program, wording: Wording, origin: Origin | None) -> list[Section]:
    """Return the declarations of inputs, parameters, outputs, instances and state of a program.

    Parameters
    ----------
    program : Program
    wording : Wording
    origin : Origin or None
        Where its numbers come from.

    Examples
    --------
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (), (Signal("u"),), (), (Signal("y"),), Block(1, (), (0,)))
    >>> wording = Wording(dialect_of("codesys"), "double", Identifiers([], ignore_case=True))
    >>> [(each.keyword, len(list(each.variables))) for each in sections(law, wording, None)]
    [('VAR_INPUT', 1), ('VAR_OUTPUT', 1), ('VAR', 0), ('VAR', 0)]
    """
    inputs = ("inputs of one sample", declared(program.inputs, wording))
    parameters = ("parameters", declared(program.parameters, wording, origin))
    instances = (
        Variable(call.identifier, block_type(call.program), is_block=True) for call in program.calls
    )
    blocks = tuple(sorted(instances, key=lambda instance: instance.type))
    state = declared(own_state(program), wording, origin, program.rings)
    return [
        Section("VAR_INPUT", "", (inputs, parameters)),
        Section("VAR_OUTPUT", "", (("outputs", declared(program.outputs, wording)),)),
        Section("VAR", "", (("blocks", blocks),)),
        Section("VAR", "RETAIN", (("state", state),)),
    ]


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

    def no_word(signal: Signal) -> Signal:
        is_word = signal.identifier.upper() in words
        return replace(signal, name=f"{signal.name}_value") if is_word else signal

    def named(statement: Statement) -> Statement:
        if not isinstance(statement, Call):
            return statement
        block = with_block_names(statement.program, words).with_signals(no_word)
        told = {f"{name}_value": text for name, text in block.words.items()} | {**block.words}
        instance = statement.identifier
        clash = "_block" if instance.lower() in taken else ""
        renamed = replace(block, words=told)
        return replace(statement, instance=instance + clash, program=renamed)

    block = replace(program.block, statements=tuple(map(named, program.block.statements)))
    return replace(program, block=block)
