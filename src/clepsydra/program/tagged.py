"""A program whose signals have tags."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, ForLoop, Program, Statement


def tagged_program(program: Program, tagged: Callable[[str], str]) -> Program:
    """Return a program with other paths: of its signals, its instances and what they call.

    Parameters
    ----------
    program : Program
    tagged : callable
        See `clepsydra.base.tags.tagging`.

    Examples
    --------
    >>> from clepsydra.base.tags import tagging
    >>> ports = {"state": (), "inputs": (Signal("level.pv"),), "parameters": ()}
    >>> program = Program("same", outputs=(Signal("pump.out"),), block=Block(1, (), (0,)), **ports)
    >>> tagged_program(program, tagging({"level": "LIC101"}, ())).inputs[0].name
    'LIC101.pv'
    """

    def path(name: str) -> str:
        # What belongs to nothing is a port of a block, or one of the whole law.
        return tagged(name) if "." in name else name

    def signal(each: Signal) -> Signal:
        return replace(each, name=path(each.name))

    def ring(each: DelayRing) -> DelayRing:
        return replace(each, signal=signal(each.signal))

    def statement(each: Statement) -> Statement:
        if isinstance(each, Operation):
            return each
        if isinstance(each, Call):
            called = tagged_program(each.program, tagged)
            return replace(each, instance=path(each.instance), program=called)
        named = replace(each, name=path(each.name), body=block(each.body))
        if isinstance(named, ForLoop):
            return replace(named, rings=tuple(map(ring, named.rings)))
        return named

    def block(each: Block) -> Block:
        return replace(each, statements=tuple(map(statement, each.statements)))

    return replace(
        program,
        state=tuple(ring(e) if isinstance(e, DelayRing) else signal(e) for e in program.state),
        inputs=tuple(map(signal, program.inputs)),
        parameters=tuple(map(signal, program.parameters)),
        outputs=tuple(map(signal, program.outputs)),
        block=block(program.block),
        names={value: path(name) for value, name in program.names.items()},
    )
