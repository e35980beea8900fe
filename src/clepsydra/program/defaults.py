"""A program with the values that a controller was designed with."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import ForLoop, Program, Statement


def with_defaults(program: Program, values: Mapping[str, float]) -> Program:
    """Return a program whose parameters, inputs and state start from the given values.

    Parameters
    ----------
    program : Program
    values : mapping
        Name of a parameter, input or state to its value in the signal's unit; the other
        signals keep theirs. For a delay ring, of the state or of a loop, it is the whole
        initial content.

    Raises
    ------
    InputError
        The program has no signal of that name.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> program = Program("nothing", (), (), (Signal("gain"),), (), Block(1, (), ()))
    >>> with_defaults(program, {"gain": 2.5}).parameters[0].initial
    2.5
    """
    known = {
        entry.name
        for entry in (*program.state, *program.rings, *program.inputs, *program.parameters)
    }
    for name, value in values.items():
        if name not in known:
            raise InputError(
                f"program {program.name}, {name}",
                value,
                f"a value for one of {sorted(known)}",
                "use the name of a parameter, input or state of the law",
            )

    def started(signal: Signal) -> Signal:
        if signal.name not in values:
            return signal
        return dataclasses.replace(signal, initial=float(values[signal.name]))

    def started_ring(ring: DelayRing) -> DelayRing:
        return dataclasses.replace(ring, signal=started(ring.signal))

    def started_state(entry: Signal | DelayRing) -> Signal | DelayRing:
        return started_ring(entry) if isinstance(entry, DelayRing) else started(entry)

    def started_loop(statement: Statement) -> Statement:
        if not isinstance(statement, ForLoop):
            return statement
        return dataclasses.replace(statement, rings=tuple(map(started_ring, statement.rings)))

    statements = tuple(map(started_loop, program.block.statements))
    return dataclasses.replace(
        program,
        state=tuple(started_state(entry) for entry in program.state),
        inputs=tuple(started(entry) for entry in program.inputs),
        parameters=tuple(started(entry) for entry in program.parameters),
        block=dataclasses.replace(program.block, statements=statements),
    )
