"""A block of single operations as the few, named statements that a person would write."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clepsydra.deploy.printing.expressions import (
    Expression,
    Notation,
    flag,
    render,
    simplified,
    variable,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import (
    Assignment,
    Branch,
    CountedLoop,
    Listing,
    ListingStatement,
    RingTurn,
    parts,
)
from clepsydra.deploy.printing.needed import needed_body, needed_part, needed_values
from clepsydra.program.program import Block, Conditional, Loop, Operation

#: A folded expression grows no wider than this [characters].
_WIDTH = 72
#: Choices are folded into choices no deeper than this, so that a chain of ELSIF stays readable.
_DEPTH = 4
#: What stands for an argument that its block does not read.
_UNREAD = variable("")


def list_block(
    block: Block,
    arguments: Sequence[Expression],
    notation: Notation,
    names: Identifiers,
    *,
    labels: Mapping[int, str],
    preferred: Mapping[int, str],
) -> Listing:
    """Fold the operations of a block into statements.

    A value that is read once is written where it is read; since every value is assigned once
    and depends on nothing but its operands, no bit changes. A value that is read more often,
    or that a label names, gets a variable.

    Parameters
    ----------
    block : Block
    arguments : sequence of Expression
        What is written for each argument.
    notation : Notation
    names : Identifiers
        The scope that the variables are named in.
    labels : mapping
        Value to the variable that it is assigned to in any case; these names belong to the
        scope already.
    preferred : mapping
        Value to the name that it gets if it needs a variable.

    Examples
    --------
    A value that is read twice gets a variable, one that is read once is written in its place:

    >>> from clepsydra.deploy.c99.notation import notation_of
    >>> notation = notation_of("double")
    >>> block = Block(1, (Operation(1, "multiply", (0, 0)), Operation(2, "add", (1, 1))), (2,))
    >>> listing = list_block(block, [variable("x")], notation, Identifiers([], ignore_case=False),
    ...                      labels={}, preferred={1: "square"})
    >>> [statement.name for statement in listing.statements], render(listing.results[0], notation)
    (['square'], 'square + square')
    """
    lister = _Lister(notation, names)
    statements, results = lister.block(block, arguments, labels, preferred)
    return Listing(tuple(statements), tuple(results), lister.tables)


class _Lister:
    def __init__(self, notation: Notation, names: Identifiers) -> None:
        self._notation = notation
        self._names = names
        self.tables: dict[str, tuple[float, ...]] = {}

    def block(
        self,
        block: Block,
        arguments: Sequence[Expression],
        labels: Mapping[int, str],
        preferred: Mapping[int, str],
    ) -> tuple[list[ListingStatement], list[Expression]]:
        scope = _Scope(self._notation, self._names, dict(enumerate(arguments)), preferred)
        block, uses = needed_part(block)
        for statement in block.statements:
            if isinstance(statement, Loop):
                self._loop(statement, scope, labels, uses)
                continue
            if isinstance(statement, Conditional):
                self._conditional(statement, scope, labels, uses)
                continue
            expression = scope.operation(statement)
            scope.values[statement.target] = expression
            if expression.is_atom:
                continue
            if statement.target in labels:
                scope.assign(statement.target, labels[statement.target])
            elif uses.get(statement.target, 0) > 1 or statement.code in self._notation.rounding:
                scope.assign(statement.target)
        return scope.statements, [scope.values[value] for value in block.results]

    def _loop(
        self, loop: Loop, scope: _Scope, labels: Mapping[int, str], uses: Mapping[int, int]
    ) -> None:
        names, first = self._names, len(loop.tables)
        entries = []
        index = names.new("i")
        count, rings = len(loop.targets), len(loop.rings)
        live = needed_values(loop, uses)
        needed, read = needed_body(loop, live)
        for number, table in enumerate(loop.tables):
            if number not in read:
                entries.append(_UNREAD)
                continue
            name = names.new(f"{loop.name}_table")
            self.tables[name] = table
            entries.append(variable(f"{name}[{index}]"))
        carried = self._carried(loop, live, scope, labels)
        start = tuple(Assignment(carried[k], scope.values[loop.carried[k]]) for k in live)
        oldest = [
            names.new(f"oldest_{ring.signal.identifier}") if argument in read else ""
            for argument, ring in enumerate(loop.rings, first + count)
        ]
        inside = [
            *entries,
            *(variable(carried[k]) if k in carried else _UNREAD for k in range(count)),
            *map(variable, oldest),
            *(
                scope.atom(value) if argument in read else _UNREAD
                for argument, value in enumerate(loop.invariants, first + count + rings)
            ),
        ]
        body, results = self.block(needed, inside, {}, {})
        update = self._update(list(carried.values()), results[: len(live)], body)
        turns = map(RingTurn, loop.rings, oldest, results[len(live) :])
        scope.statements.append(
            CountedLoop(index, loop.count, start, tuple(body), update, loop.name, tuple(turns))
        )

    def _conditional(
        self,
        conditional: Conditional,
        scope: _Scope,
        labels: Mapping[int, str],
        uses: Mapping[int, int],
    ) -> None:
        live = needed_values(conditional, uses)
        carried = self._carried(conditional, live, scope, labels)
        needed, read = needed_body(conditional, live)
        # What only the body reads, it reads as it was before.
        inside = [
            variable(carried[k]) if k in carried else scope.atom(value) if k in read else _UNREAD
            for k, value in enumerate(conditional.carried + conditional.invariants)
        ]
        start = tuple(Assignment(carried[k], scope.values[conditional.carried[k]]) for k in live)
        body, results = self.block(needed, inside, {}, {})
        update = self._update(list(carried.values()), results, body)
        if body or update:
            condition = scope.values[conditional.condition]
            branch = Branch(condition, start, tuple(body), update, conditional.name)
            scope.statements.append(branch)
        else:
            scope.statements += start

    def _carried(
        self,
        statement: Loop | Conditional,
        live: Sequence[int],
        scope: _Scope,
        labels: Mapping[int, str],
    ) -> dict[int, str]:
        """Name the variables of those carried values that need one, by their position."""
        carried: dict[int, str] = {}
        for k in live:
            target = statement.targets[k]
            wanted = scope.preferred.get(target) or f"{statement.name}_value"
            carried[k] = labels.get(target) or self._names.new(wanted)
            scope.values[target] = variable(carried[k])
        return carried

    def _update(
        self, carried: Sequence[str], results: Sequence[Expression], body: list[ListingStatement]
    ) -> tuple[Assignment, ...]:
        """Return the next values; none of them may read a carried value already overwritten."""
        update = []
        for position, (name, result) in enumerate(zip(carried, results, strict=True)):
            if result == variable(name):
                continue
            if any(part.text in carried[:position] for part in parts(result)):
                kept = self._names.new(f"next_{name}")
                body.append(Assignment(kept, result))
                result = variable(kept)
            update.append(Assignment(name, result))
        return tuple(update)


class _Scope:
    """The values of one block while its statements are written."""

    def __init__(
        self,
        notation: Notation,
        names: Identifiers,
        values: dict[int, Expression],
        preferred: Mapping[int, str],
    ) -> None:
        self._notation = notation
        self._names = names
        self._arguments = dict(values)
        self.values = values
        self.preferred = preferred
        self.statements: list[ListingStatement] = []

    def assign(self, value: int, name: str = "") -> Expression:
        """Give a value a variable, and return the expression that reads it."""
        expression = self.values[value]
        if not name:
            wanted = self.preferred.get(value)
            name = self._names.new(wanted) if wanted else self._names.temporary()
        self.statements.append(Assignment(name, expression))
        self.values[value] = flag(name) if expression.is_truth else variable(name)
        return self.values[value]

    def atom(self, value: int) -> Expression:
        """Return a value as something that can be written more than once."""
        expression = self.values[value]
        return expression if expression.is_atom else self.assign(value)

    def operation(self, operation: Operation) -> Expression:
        """Return an operation over the expressions of its arguments."""
        code = operation.code
        if code == "constant":
            return Expression("constant", number=operation.constant)
        if code == "truth":
            # The number of a truth value is 0 or 1: its truth is that value itself. A boolean
            # argument stays one, whether or not its number has a variable by now.
            value = operation.arguments[0]
            number = self._arguments.get(value, self.values[value])
            if number.code == "number":
                return number.operands[0]
        for position, value in enumerate(operation.arguments):
            if not self._fits(code, position, self.values[value]):
                self.atom(value)
        return self._narrowed(code, operation.arguments)

    def _fits(self, code: str, position: int, operand: Expression) -> bool:
        """Whether the language can write an operand in that place."""
        if operand.is_atom:
            return True
        if code in self._notation.repeating:
            return False
        if operand.code in self._notation.statements:
            branch = code == "select" and position > 0 and code in self._notation.statements
            return branch and operand.code == "select" and _depth(operand) < _DEPTH
        return True

    def _narrowed(self, code: str, arguments: tuple[int, ...]) -> Expression:
        """Return the operation, with the widest operands given variables while it is too wide."""
        while True:
            operands = tuple(self.values[value] for value in arguments)
            expression = simplified(Expression(code, operands))
            if self._width(expression) <= _WIDTH:
                return expression
            folded = [value for value in arguments if not self.values[value].is_atom]
            if not folded:
                return expression
            self.atom(max(folded, key=lambda value: self._width(self.values[value])))

    def _width(self, expression: Expression) -> int:
        if expression.code in self._notation.statements:
            return max(self._width(operand) for operand in expression.operands)
        return len(render(expression, self._notation))


def _depth(expression: Expression) -> int:
    if expression.code != "select":
        return 0
    return 1 + max(_depth(operand) for operand in expression.operands[1:])
