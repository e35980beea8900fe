"""Blocks whose instances keep different states, told apart by their names."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from clepsydra.program.program import Call, Program, Statement


def told_apart(program: Program, original: Program) -> Program:
    """Return a program in which the variants of a block have names of their own.

    Where one instance of a block keeps a state and the caller of another one that state of it,
    the block has two variants: the second in the order of the calls is named "NAME_2".

    Parameters
    ----------
    program : Program
        Whose calls own their state.
    original : Program
        What it was made from. A name that stands for two different blocks already stays, so that
        a printer refuses it.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> one, two = (Program("b", (), (), (), (), Block(0, (), ()), {}, (t,)) for t in ("x", "y"))
    >>> law = Program("law", (), (), (), (), Block(0, (Call((), one, "first", ()),), ()))
    >>> both = Block(0, (*law.block.statements, Call((), two, "second", ())), ())
    >>> [call.program.name for call in told_apart(replace(law, block=both), law).calls]
    ['b', 'b_2']
    """
    blocks: dict[str, list[Program]] = {}
    for block in _called(original):
        if block not in blocks.setdefault(block.name, []):
            blocks[block.name].append(block)
    return _renamed(program, {name: [] for name, found in blocks.items() if len(found) == 1})


def _called(program: Program) -> Iterator[Program]:
    for call in program.calls:
        yield from _called(call.program)
        yield call.program


def _renamed(program: Program, variants: dict[str, list[Program]]) -> Program:
    statements: list[Statement] = []
    for each in program.block.statements:
        if isinstance(each, Call):
            block = _renamed(each.program, variants)
            found = variants.get(block.name, [block])
            if block not in found:
                found.append(block)
            number = 1 + found.index(block)
            name = f"{block.name}_{number}" if number > 1 else block.name
            statements.append(replace(each, program=replace(block, name=name)))
        else:
            statements.append(each)
    return replace(program, block=replace(program.block, statements=tuple(statements)))
