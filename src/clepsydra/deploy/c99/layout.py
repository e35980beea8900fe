"""Where the states of a program stand in the structures of printed C."""

from __future__ import annotations

from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.owned_state import owned_by_calls, with_owned_state
from clepsydra.program.program import Call, Program


def printed_form(program: Program) -> Program:
    """Return the form that is printed: in it each instance of a block holds its own state.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> program = Program("law", (), (), (), (), Block(0, (), ()))
    >>> printed_form(program) is program
    True
    """
    return with_owned_state(program) if program.calls else program


def kept(program: Program) -> tuple[Entry, ...]:
    """Return what a printed program itself keeps: its states apart from instances, then rings.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> kept(Program("law", (Signal("x"),), (), (), (), Block(1, (), (0,))))[0].name
    'x'
    """
    owned = owned_by_calls(program)
    own = (entry for place, entry in enumerate(program.state) if place not in owned)
    return (*own, *program.rings)


def instances(program: Program) -> tuple[Call, ...]:
    """Return the calls of a printed program whose instances keep something.

    Examples
    --------
    See `state_paths`.
    """
    return tuple(call for call in program.calls if call.program.state)


def state_paths(program: Program) -> tuple[tuple[str, ...], ...]:
    """Return for each state of a printed program the members that lead to it.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "flow", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> state_paths(printed_form(law))
    (('flow', 'sum'),)
    """
    paths: list[tuple[str, ...]] = [(signal_of(entry).identifier,) for entry in program.state]
    for call in instances(program):
        for place, path in zip(call.arguments, state_paths(call.program), strict=False):
            paths[place] = (call.instance, *path)
    return tuple(paths)


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
    paths = state_paths(printed_form(program))
    return {
        name: ".".join(path) if len(path) > 1 else name
        for name, path in zip(names, paths, strict=True)
    }
