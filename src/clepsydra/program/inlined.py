"""A program without calls: every block computed where it is called."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, ForLoop, Program
from clepsydra.program.routine import RoutineCall


def inlined(program: Program) -> Program:
    """Return a program in which the blocks are computed in place, with the same bits.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> body = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> double = Program("double", (), (Signal("a"),), (), (Signal("b"),), body)
    >>> twice = Block(1, (Call((1,), double, "x", (0,)), Call((2,), double, "y", (1,))), (2,))
    >>> program = Program("four", (), (Signal("a"),), (), (Signal("b"),), twice)
    >>> [operation.code for operation in inlined(program).block.statements]
    ['add', 'add']
    """
    return rewritten(program, _called) if program.calls else program


#: Appends what stands in the place of a call, given where the values before it now stand;
#: returns the values of its targets.
Called = Callable[[BlockBuilder, Call, Mapping[int, int]], Sequence[int]]


def rewritten(program: Program, called: Called) -> Program:
    """Return a program with something else in the place of its calls."""
    builder = BlockBuilder(program.block.arguments)
    values, place = append(builder, program.block, range(program.block.arguments), called)
    return replace(program, block=builder.finish(values), names=renamed(program, place))


def append(
    builder: BlockBuilder, block: Block, arguments: Sequence[int], called: Called
) -> tuple[list[int], dict[int, int]]:
    """Append the statements of a block to another one.

    Parameters
    ----------
    builder : BlockBuilder
    block : Block
    arguments : sequence of int
        What its arguments are there.
    called : callable
        Takes the builder, a call and what its values are there, and appends the call; returns
        what its targets are there.

    Returns
    -------
    values, place : list of int, dict
        The results, and for each value of the block what it is there.
    """
    place = dict(enumerate(arguments))

    def at(values: Sequence[int]) -> list[int]:
        return [place[value] for value in values]

    found: Sequence[int]
    for each in block.statements:
        if isinstance(each, Operation):
            if each.code == "constant":
                place[each.target] = builder.constant(each.constant)
            else:
                given = at(each.arguments)
                place[each.target] = builder.operation(each.code, *given, fused=each.fused)
            continue
        if isinstance(each, Call):
            found = called(builder, each, place)
        elif isinstance(each, RoutineCall):
            found = builder.routine(each.routine, at(each.arguments), each.tables)
        elif isinstance(each, ForLoop):
            found = builder.loop(
                each.name, each.body, each.count, each.tables, at(each.carried),
                at(each.invariants), each.rings, adjustable=each.adjustable,
            )  # fmt: skip
        else:
            found = builder.conditional(
                each.name, place[each.condition], each.body, at(each.carried), at(each.invariants)
            )
        place.update(zip(each.targets, found, strict=True))
    return at(block.results), place


def append_in_place(builder: BlockBuilder, block: Block, arguments: Sequence[int]) -> list[int]:
    """Append a block whose calls are computed in place, and return what its results are there.

    Examples
    --------
    >>> builder = BlockBuilder(1)
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> append_in_place(builder, double, [builder.constant(1.5)])
    [2]
    >>> builder.finish([2]).statements[0].constant
    3.0
    """
    return append(builder, block, arguments, _called)[0]


def renamed(program: Program, place: Mapping[int, int]) -> dict[int, str]:
    """Return the names of a program's values where they now stand.

    Examples
    --------
    >>> program = Program("p", (), (), (), (), Block(1, (), ()), {1: "level"})
    >>> renamed(program, {0: 0, 1: 4})
    {4: 'level'}
    """
    names: dict[int, str] = {}
    for value, name in program.names.items():
        if value in place:
            names.setdefault(place[value], name)
    return names


def _called(builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> Sequence[int]:
    given = [place[value] for value in call.arguments]
    return append_in_place(builder, call.program.block, given)
