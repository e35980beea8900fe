"""Which inputs, states and parameters a result of a program is computed from."""

from __future__ import annotations

from clepsydra.program.program import Block, Program, read_by, written_by


def output_dependencies(program: Program) -> list[tuple[str, ...]]:
    """Return for each output the states, inputs and parameters that it is computed from.

    What a loop or a conditional carries is taken to depend on everything that it reads.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Operation
    >>> block = Block(3, (Operation(3, "add", (0, 2)),), (0, 3))
    >>> program = Program("law", (Signal("x"),), (Signal("u"),), (Signal("p"),),
    ...                   (Signal("y"),), block)
    >>> output_dependencies(program)
    [('x', 'p')]
    """
    names = [s.name for s in (*program.state, *program.inputs, *program.parameters)]
    found = _arguments_of_results(program.block)[len(program.state) :]
    return [tuple(names[value] for value in sorted(each)) for each in found]


def _arguments_of_results(block: Block) -> list[frozenset[int]]:
    known = {value: frozenset((value,)) for value in range(block.arguments)}
    for statement in block.statements:
        depends = frozenset().union(*(known[value] for value in read_by(statement)))
        known |= dict.fromkeys(written_by(statement), depends)
    return [known[value] for value in block.results]
