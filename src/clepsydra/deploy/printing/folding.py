"""A block of single operations as the few, named statements that a person would write."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import (
    Expression,
    Notation,
    variable,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Branch,
    CountedLoop,
    Listing,
    ListingStatement,
    RingTurn,
    parts,
)
from clepsydra.deploy.printing.scope import Scope
from clepsydra.deploy.printing.whole_numbers import WholeRange
from clepsydra.program.needed import needed_body, needed_part, needed_values
from clepsydra.program.program import (
    COMPARISONS,
    Block,
    Call,
    Conditional,
    Loop,
    Operation,
    read_by,
)

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
    read: Callable[[Signal, str], Expression] | None = None,
    ranges: Mapping[int, WholeRange] | None = None,
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
    read : callable, optional
        Takes an output of a block and the text that names it, and returns the expression that
        reads it; for a program with calls.
    ranges : mapping, optional
        Bounds of the values that are whole numbers: where the notation has types for them,
        these are computed as integers.

    Examples
    --------
    A value that is read twice gets a variable, one that is read once is written in its place:

    >>> from clepsydra.deploy.c99.language import notation_of
    >>> from clepsydra.deploy.printing.expressions import render
    >>> notation = notation_of("double")
    >>> block = Block(1, (Operation(1, "multiply", (0, 0)), Operation(2, "add", (1, 1))), (2,))
    >>> listing = list_block(block, [variable("x")], notation, Identifiers([], ignore_case=False),
    ...                      labels={}, preferred={1: "square"})
    >>> [statement.name for statement in listing.statements], render(listing.results[0], notation)
    (['square'], 'square + square')
    """
    lister = _Lister(notation, names, read)
    statements, results = lister.block(block, arguments, labels, preferred, ranges or {})
    return Listing(tuple(statements), tuple(results), lister.tables)


class _Lister:
    def __init__(
        self,
        notation: Notation,
        names: Identifiers,
        read: Callable[[Signal, str], Expression] | None,
    ) -> None:
        self._notation = notation
        self._names = names
        self._read = read
        self.tables: dict[str, tuple[float, ...]] = {}
        #: The indices of the loops, by how deep these stand.
        self._indices: list[str] = []
        self._depth = 0

    def block(
        self,
        block: Block,
        arguments: Sequence[Expression],
        labels: Mapping[int, str],
        preferred: Mapping[int, str],
        ranges: Mapping[int, WholeRange],
    ) -> tuple[list[ListingStatement], list[Expression]]:
        scope = Scope(self._notation, self._names, dict(enumerate(arguments)), preferred, ranges)
        block, uses = needed_part(block)
        scope.name_by_ports(block)
        scope.count_by_readers(block)
        compared = self._only_compared(block)
        for statement in block.statements:
            if isinstance(statement, Loop):
                self._loop(statement, scope, labels, uses)
                continue
            if isinstance(statement, Conditional):
                self._conditional(statement, scope, labels, uses)
                continue
            if isinstance(statement, Call):
                self._call(statement, scope)
                continue
            expression = scope.operation(statement)
            scope.values[statement.target] = expression
            if expression.is_atom:
                continue
            if statement.target in compared:
                continue
            if statement.target in labels:
                scope.assign(statement.target, labels[statement.target])
            elif uses[statement.target] > 1 and not scope.is_short(
                expression, uses[statement.target]
            ):
                scope.assign(statement.target)
        return scope.statements, [scope.values[value] for value in block.results]

    def _only_compared(self, block: Block) -> set[int]:
        """Return the rounded values that only comparisons read: these may do without."""
        rounded = {
            each.target
            for each in block.statements
            if isinstance(each, Operation) and each.code in ("floor", "ceiling")
        }
        for each in block.statements:
            if not (isinstance(each, Operation) and each.code in COMPARISONS):
                rounded.difference_update(read_by(each))
        return rounded.difference(block.results)

    def _loop(
        self, loop: Loop, scope: Scope, labels: Mapping[int, str], uses: Mapping[int, int]
    ) -> None:
        names, first = self._names, len(loop.tables)
        entries = []
        index = self._index()
        count, rings = len(loop.targets), len(loop.rings)
        live = needed_values(loop, uses)
        needed, read = needed_body(loop, live)
        for number, table in enumerate(loop.tables):
            if number not in read or loop.count == 1:
                entries.append(Expression("constant", number=table[0]))
                continue
            # By their texts: equal numbers may be zeros of different sign.
            known = (name for name, other in self.tables.items() if repr(other) == repr(table))
            name = next(known, "") or names.new(f"{loop.name}_table")
            self.tables[name] = table
            entries.append(variable(f"{name}[{index}]"))
        before = dict(scope.values)
        carried = self._carried(loop, live, scope, labels, uses)
        start = self._start(loop, carried, before)
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
        self._depth += 1
        body, results = self.block(needed, inside, {}, {}, {})
        self._depth -= 1
        update = self._update(list(carried.values()), results[: len(live)], body)
        turns = map(RingTurn, loop.rings, oldest, results[len(live) :])
        scope.statements.append(
            CountedLoop(index, loop.count, start, tuple(body), update, loop.name, tuple(turns))
        )

    def _conditional(
        self,
        conditional: Conditional,
        scope: Scope,
        labels: Mapping[int, str],
        uses: Mapping[int, int],
    ) -> None:
        live = needed_values(conditional, uses)
        before = dict(scope.values)
        carried = self._carried(conditional, live, scope, labels, uses)
        needed, read = needed_body(conditional, live)
        # What only the body reads, it reads as it was before.
        inside = [
            variable(carried[k]) if k in carried else scope.atom(value) if k in read else _UNREAD
            for k, value in enumerate(conditional.carried + conditional.invariants)
        ]
        start = self._start(conditional, carried, before)
        body, results = self.block(needed, inside, {}, {}, {})
        update = self._update(list(carried.values()), results, body)
        if body or update:
            condition = scope.values[conditional.condition]
            branch = Branch(condition, start, tuple(body), update, conditional.name)
            scope.statements.append(branch)
        else:
            scope.statements += start

    def _call(self, call: Call, scope: Scope) -> None:
        if self._read is None:
            raise ValueError(f"{call.instance}: say how its outputs are read")
        program, states = call.program, len(call.program.state)
        name = self._names.new(call.identifier)
        arguments = []
        for signal, value in zip(program.inputs, call.arguments[states:], strict=True):
            given = scope.values[value]
            truth = signal.kind == "boolean" and given.code == "number"
            given = given.operands[0] if truth else given
            written = self._notation.writes(given)
            arguments.append(scope.values[value] if written else scope.atom(value))
        scope.statements.append(BlockCall(name, program, tuple(arguments), call.identifier))
        # The next state stays in the instance.
        scope.values |= dict.fromkeys(call.targets[:states], _UNREAD)
        for signal, target in zip(program.outputs, call.targets[states:], strict=True):
            scope.values[target] = self._read(signal, f"{name}.{signal.identifier}")

    def _carried(
        self,
        statement: Loop | Conditional,
        live: Sequence[int],
        scope: Scope,
        labels: Mapping[int, str],
        uses: Mapping[int, int],
    ) -> dict[int, str]:
        """Name the variables of those carried values that need one, by their position.

        What was carried by a statement before, and is read by this one alone, is carried on.
        """
        carried: dict[int, str] = {}
        for k in live:
            target, start = statement.targets[k], statement.carried[k]
            name, kept = labels.get(target, ""), scope.values[start].text
            if not name and kept in scope.carried and uses[start] == 1:
                name = kept
            wanted = scope.preferred.get(target) or f"{statement.name}_value"
            carried[k] = name or self._names.new(wanted)
            scope.values[target] = variable(carried[k])
        scope.carried.update(carried.values())
        return carried

    def _start(
        self,
        statement: Loop | Conditional,
        carried: Mapping[int, str],
        values: Mapping[int, Expression],
    ) -> tuple[Assignment, ...]:
        starts = (Assignment(name, values[statement.carried[k]]) for k, name in carried.items())
        return tuple(each for each in starts if each.expression != variable(each.name))

    def _index(self) -> str:
        """Return the index of a loop; those beside each other have the same."""
        if len(self._indices) == self._depth:
            self._indices.append(self._names.new("i"))
        return self._indices[self._depth]

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
