"""Which variables a statement of a listing touches, and the same statement over other names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from clepsydra.deploy.printing.expressions import Expression
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Branch,
    CountedLoop,
    ListingStatement,
    parts,
)


def touched(statement: ListingStatement) -> set[str]:
    """Return the names of the variables that a statement reads or assigns.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> sorted(touched(Assignment("u", Expression("add", (variable("a"), variable("b"))))))
    ['a', 'b', 'u']
    """
    return set(_touched(statement))


def _touched(statement: ListingStatement) -> Iterator[str]:
    if isinstance(statement, Assignment):
        yield statement.name
        yield from (part.text for part in parts(statement.expression) if part.text)
    elif isinstance(statement, BlockCall):
        for argument in statement.arguments:
            yield from (part.text for part in parts(argument) if part.text)
    else:
        for inner in (*statement.start, *statement.body, *statement.update):
            yield from _touched(inner)
        given = (
            [turn.written for turn in statement.rings]
            if isinstance(statement, CountedLoop)
            else [statement.condition]
        )
        for expression in given:
            yield from (part.text for part in parts(expression) if part.text)


def renamed(statement: ListingStatement, names: Mapping[str, str]) -> ListingStatement:
    """Return a statement over variables of other names.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> renamed(Assignment("t1", variable("t2")), {"t1": "u"}).name
    'u'
    """
    if isinstance(statement, Assignment):
        return _assignment(statement, names)
    if isinstance(statement, BlockCall):
        arguments = tuple(renamed_expression(each, names) for each in statement.arguments)
        return replace(statement, arguments=arguments)
    start, update = (
        tuple(_assignment(each, names) for each in group)
        for group in (statement.start, statement.update)
    )
    body = tuple(renamed(each, names) for each in statement.body)
    if isinstance(statement, Branch):
        condition = renamed_expression(statement.condition, names)
        return replace(statement, condition=condition, start=start, body=body, update=update)
    rings = tuple(
        replace(turn, written=renamed_expression(turn.written, names)) for turn in statement.rings
    )
    return replace(statement, start=start, body=body, update=update, rings=rings)


def renamed_expression(expression: Expression, names: Mapping[str, str]) -> Expression:
    """Return an expression over variables of other names.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> renamed_expression(variable("t1"), {"t1": "u"}).text
    'u'
    """
    operands = tuple(renamed_expression(each, names) for each in expression.operands)
    return replace(expression, operands=operands, text=names.get(expression.text, expression.text))


def _assignment(statement: Assignment, names: Mapping[str, str]) -> Assignment:
    name = names.get(statement.name, statement.name)
    return Assignment(name, renamed_expression(statement.expression, names))
