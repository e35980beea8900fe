"""A block of single operations as the few, named statements that a person would write."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

from clepsydra.deploy.printing.expressions import (
    Expression,
    Notation,
    reading,
    variable,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Compound,
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


class Lister:
    """Folds the operations of a block into statements.

    A value that is read once is written where it is read; since every value is assigned once
    and depends on nothing but its operands, no bit changes. A value that is read more often,
    or that a label names, gets a variable.

    Parameters
    ----------
    notation : Notation
    names : Identifiers
        The scope that the variables are named in.

    Examples
    --------
    A value that is read twice gets a variable, one that is read once is written in its place:

    >>> from clepsydra.deploy.c99.language import notation_of
    >>> from clepsydra.deploy.printing.expressions import render
    >>> notation = notation_of("double")
    >>> block = Block(1, (Operation(1, "multiply", (0, 0)), Operation(2, "add", (1, 1))), (2,))
    >>> lister = Lister(notation, Identifiers([], ignore_case=False))
    >>> statements, results = lister.block(block, [variable("x")], preferred={1: "square"})
    >>> [statement.name for statement in statements], render(results[0], notation)
    (['square'], 'square + square')
    """

    def __init__(self, notation: Notation, names: Identifiers) -> None:
        self._notation, self._names = notation, names
        #: Tables of the loops by name.
        self.tables: dict[str, tuple[float, ...]] = {}
        #: The indices of the loops, by how deep these stand.
        self._indices: list[str] = []
        self._depth = 0

    def block(
        self,
        block: Block,
        arguments: Sequence[Expression],
        labels: Mapping[int, str] | None = None,
        preferred: Mapping[int, str] | None = None,
        ranges: Mapping[int, WholeRange] | None = None,
    ) -> tuple[list[ListingStatement], list[Expression]]:
        """Return the statements of a block, and the expressions of its results.

        Parameters
        ----------
        block : Block
        arguments : sequence of Expression
            What is written for each argument.
        labels : mapping, optional
            Value to the variable that it is assigned to in any case; these names belong to the
            scope already.
        preferred : mapping, optional
            Value to the name that it gets if it needs a variable.
        ranges : mapping, optional
            Bounds of the values that are whole numbers, which are computed as integers.
        """
        labels, given = labels or {}, dict(enumerate(arguments))
        scope = Scope(self._notation, self._names, given, dict(preferred or {}), ranges or {})
        block, uses = needed_part(block)
        scope.name_by_ports(block)
        scope.count_by_readers(block)
        compared = self._only_compared(block)
        for statement in block.statements:
            if isinstance(statement, (Loop, Conditional)):
                self._compound(statement, scope, labels, uses)
                continue
            if isinstance(statement, Call):
                self._call(statement, scope)
                continue
            target = statement.target
            expression = scope.values[target] = scope.operation(statement)
            if expression.is_atom or target in compared:
                continue
            often = uses[target] > 1 and not scope.is_short(expression, uses[target])
            if target in labels or often:
                scope.assign(target, labels.get(target, ""))
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

    def _compound(
        self,
        statement: Loop | Conditional,
        scope: Scope,
        labels: Mapping[int, str],
        uses: Mapping[int, int],
    ) -> None:
        names, count, before = self._names, len(statement.targets), dict(scope.values)
        live = needed_values(statement, uses)
        needed, read = needed_body(statement, live)
        loop = statement if isinstance(statement, Loop) else None
        index, rings = self._index() if loop else "", loop.rings if loop else ()
        inside = self._entries(loop, index, read) if loop else []
        first = len(inside)
        carried = self._carried(statement, live, scope, labels, uses)
        starts = (Assignment(name, before[statement.carried[k]]) for k, name in carried.items())
        start = tuple(each for each in starts if each.expression != variable(each.name))
        oldest = [
            names.new(f"oldest_{ring.signal.identifier}") if argument in read else ""
            for argument, ring in enumerate(rings, first + count)
        ]

        def held(argument: int, value: int) -> Expression:
            return scope.atom(value) if argument in read else _UNREAD

        # What only the body reads, it reads as it was before.
        inside += [
            variable(carried[k]) if k in carried else held(first + k, value)
            for k, value in enumerate(statement.carried)
        ]
        inside += map(variable, oldest)
        inside += [held(len(inside) + k, value) for k, value in enumerate(statement.invariants)]
        self._depth += 1 if loop else 0
        body, results = self.block(needed, inside)
        self._depth -= 1 if loop else 0
        update = self._update(list(carried.values()), results[: len(live)], body)
        turns = map(RingTurn, rings, oldest, results[len(live) :])
        if loop or body or update:
            condition = None if isinstance(statement, Loop) else scope.values[statement.condition]
            turned = index, loop.count if loop else 1, tuple(turns)
            made = Compound(statement.name, start, tuple(body), update, condition, *turned)
            scope.statements.append(made)
        else:
            scope.statements += start

    def _entries(self, loop: Loop, index: str, read: Container[int]) -> list[Expression]:
        """Return what reads the tables of a loop in a turn, and keep those that it reads."""
        entries = []
        for number, table in enumerate(loop.tables):
            if number not in read or loop.count == 1:
                entries.append(Expression("constant", number=table[0]))
                continue
            # By their texts: equal numbers may be zeros of different sign.
            known = (name for name, other in self.tables.items() if repr(other) == repr(table))
            name = next(known, "") or self._names.new(f"{loop.name}_table")
            self.tables[name] = table
            entries.append(variable(f"{name}[{index}]"))
        return entries

    def _call(self, call: Call, scope: Scope) -> None:
        program, states = call.program, len(call.program.state)
        name = self._names.new(call.identifier)
        arguments = []
        for signal, value in call.ports():
            given = scope.values[value]
            truth = signal.kind == "boolean" and given.code == "number"
            given = given.operands[0] if truth else given
            written = self._notation.writes(given)
            arguments.append(scope.values[value] if written else scope.atom(value))
        scope.statements.append(BlockCall(name, program, tuple(arguments), call.identifier))
        # The next state stays in the instance.
        scope.values |= dict.fromkeys(call.targets[:states], _UNREAD)
        for signal, target in zip(program.outputs, call.targets[states:], strict=True):
            scope.values[target] = reading(signal.kind, f"{name}.{signal.identifier}")

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
