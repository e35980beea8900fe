"""Where the states of a program stand in the structures of printed C."""

from __future__ import annotations

from clepsydra.program.owned_state import state_paths, with_owned_state
from clepsydra.program.program import Call, Program


def instances(program: Program) -> tuple[Call, ...]:
    """Return the calls of a printed program whose instances keep something.

    Examples
    --------
    See `Structures`.
    """
    return tuple(call for call in program.calls if call.program.state)


def state_names(program: Program) -> dict[str, str]:
    """Return for the name of each state the one with the instances that it lives in.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "flow", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> state_names(law)
    {'x': 'flow.sum'}
    """
    names = [entry.name for entry in program.state]
    paths = state_paths(with_owned_state(program))
    return {
        name: ".".join(path) if len(path) > 1 else name
        for name, path in zip(names, paths, strict=True)
    }
