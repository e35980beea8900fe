"""A program with the values that a controller was designed with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.program.program import Program


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
    entries = (*program.state, *program.rings, *program.inputs, *program.parameters)
    known = {entry.name for entry in entries}
    for name, value in values.items():
        if name not in known:
            expected = f"a value for one of {sorted(known)}"
            remedy = "use the name of a parameter, input or state of the law"
            raise InputError(f"program {program.name}, {name}", value, expected, remedy)

    def started(signal: Signal) -> Signal:
        if signal.name not in values:
            return signal
        return replace(signal, initial=float(values[signal.name]))

    changed = program.with_signals(started)
    return replace(changed, outputs=program.outputs, constants=program.constants)
