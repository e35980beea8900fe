"""A block of single operations as the few, named statements that a person would write."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from clepsydra.base.signal import Kind
from clepsydra.deploy.printing.computed_tables import read_tables
from clepsydra.deploy.printing.expressions import Expression, constant, reading, variable
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Compound,
    ListingStatement,
    RingTurn,
    Scope,
)
from clepsydra.deploy.printing.routines import RoutineListing
from clepsydra.deploy.printing.typed_values import in_own_type
from clepsydra.deploy.printing.whole_numbers import INTEGERS, WholeRange
from clepsydra.program.needed import needed_body, needed_part, needed_values
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, Conditional, ForLoop, read_by
from clepsydra.program.routine import RoutineCall

#: A truth value up to this width is written wherever it is read [characters].
_SHORT = 32
_CONVERTED: dict[str, Kind] = {"truth": "boolean", "number": "real"}
#: A number is no larger than one above this.
_LARGE = 1e37
#: A folded expression grows no wider than this: two lines at the most [characters].
_WIDTH = 150
#: A sum reads well on several lines, and so does the largest or any of many things.
_WIDEST = {"add": 4 * _WIDTH, "or": 8 * _WIDTH, "maximum": 2 * _WIDTH}
#: What a result is called that the law gives no name, by its operation.
_RESULTS = {
    "add": "sum",
    "subtract": "difference",
    "multiply": "product",
    "divide": "quotient",
    "negate": "opposite",
    "square_root": "root",
    "absolute": "magnitude",
    "minimum": "limited",
    "maximum": "limited",
    "select": "chosen",
    "pow": "power",
}
#: And up to this many characters in all.
_OFTEN = 90
#: What stands for an argument that its block does not read.
_UNREAD = variable("")
#: Choices are folded into choices no deeper than this, so that a chain of ELSIF stays readable.
_DEPTH = 4


class FoldedBlock:
    """The statements of a block, with its operations folded into where they are read.

    A value that is read once is written where it is read; since every value is assigned once
    and depends on nothing but its operands, no bit changes. A value that is read more often,
    or that a label names, gets a variable.

    Parameters
    ----------
    block : Block
    arguments : sequence of Expression
        What is written for each argument.
    scope : Scope
    labels : mapping, optional
        Value to the variable that it is assigned to in any case; these names belong to the
        scope already.
    preferred : mapping, optional
        Value to the name that it gets if it needs a variable.
    ranges : mapping, optional
        Bounds of the values that are whole numbers, which are computed as integers.
    kinds : mapping, optional
        Types of the labels that are declared already; a value of another type gets none of them.
    depth : int
        How many loops are around; those beside each other share an index.

    Examples
    --------
    A value that is read twice gets a variable, one that is read once is written in its place:

    >>> from clepsydra.deploy.c99.statements import C99
    >>> from clepsydra.deploy.printing.identifiers import Identifiers
    >>> scope = Scope(C99("law", "double"), Identifiers([], ignore_case=False))
    >>> block = Block(1, (Operation(1, "multiply", (0, 0)), Operation(2, "add", (1, 1))), (2,))
    >>> folded = FoldedBlock(block, [variable("x")], scope, preferred={1: "square"})
    >>> [each.name for each in folded.statements], scope.notation.render(folded.results[0])
    (['square'], 'square + square')
    """

    def __init__(
        self,
        block: Block,
        arguments: Sequence[Expression],
        scope: Scope,
        labels: Mapping[int, str] | None = None,
        preferred: Mapping[int, str] | None = None,
        ranges: Mapping[int, WholeRange] | None = None,
        kinds: Mapping[str, Kind] | None = None,
        depth: int = 0,
    ) -> None:
        self._scope, self._notation, self._names = scope, scope.notation, scope.names
        self._labels, self._kinds, self._depth = labels or {}, kinds or {}, depth
        self._preferred = dict(preferred or {})
        self._ranges, self._integers = ranges or {}, INTEGERS[scope.notation.precision][:2]
        self._arguments = dict(enumerate(arguments))
        #: Value to the expression that reads it.
        self._values = dict(self._arguments)
        #: Variables of loops and branches, which a later one may go on with.
        self._carried: set[str] = set()
        self.statements: list[ListingStatement] = []
        block, self._uses = needed_part(block)
        self._look_ahead(block)
        for statement in block.statements:
            if isinstance(statement, Operation):
                self._fold(statement)
            elif isinstance(statement, Call):
                self._call(statement)
            elif isinstance(statement, RoutineCall):
                self._routine(statement)
            else:
                self._compound(statement)
        #: The expressions of its results.
        self.results = [self._values[value] for value in block.results]

    def _look_ahead(self, block: Block) -> None:
        #: The values that something reads as a number, not as an integer.
        self._as_number = {*block.results}
        for each in block.statements:
            if isinstance(each, Operation):
                self._as_number.update(() if each.target in self._ranges else each.arguments)
                continue
            if not isinstance(each, Call):
                self._as_number.update(read_by(each))
                continue
            for signal, value in each.ports():
                # A variable that a call reads is named after the port that it goes to.
                free = self._names.is_free(signal.identifier)
                name = signal.identifier if free else f"{each.identifier}_{signal.identifier}"
                self._preferred.setdefault(value, name)
                self._as_number.update(() if signal.kind == "integer" else [value])
        for each in (s for s in block.statements if isinstance(s, Operation)):
            if each.code in _CONVERTED and each.target in self._preferred:
                self._preferred.setdefault(each.arguments[0], self._preferred[each.target])

    def _assign(self, value: int, name: str = "") -> Expression:
        """Give a value a variable, and return the expression that reads it."""
        expression = self._values[value]
        if not name:
            name = self._names.new(self._preferred.get(value) or _name_for(expression))
        if expression.code == "select" and value not in self._as_number:
            expression = expression.known_as("integer") or expression
        typed = expression.typed_part
        self.statements.append(Assignment(name, typed))
        read = variable(name, typed.kind)
        self._values[value] = read if expression.kind == "boolean" else read.to("real")
        return self._values[value]

    def _atom(self, value: int) -> Expression:
        """Return a value as something that can be written more than once."""
        expression = self._values[value]
        return expression if expression.typed_part.is_atom else self._assign(value)

    def _fold(self, operation: Operation) -> None:
        """Write an operation where it is read, or give it a variable."""
        target = operation.target
        expression = self._values[target] = self._operation(operation)
        if expression.is_atom:
            return
        often = self._uses[target] > 1 and not self._is_short(expression, self._uses[target])
        name = self._label(target, expression.typed_part.kind)
        if name or often:
            self._assign(target, name)

    def _label(self, value: int, kind: Kind) -> str:
        """Return the variable that a value of a type is assigned to in any case, if any."""
        name = self._labels.get(value, "")
        return name if self._kinds.get(name, kind) == kind else ""

    def _call(self, call: Call) -> None:
        """Call an instance, of which the outputs are read afterwards."""
        program, states = call.program, len(call.program.state)
        name = self._names.new(call.identifier)
        arguments = []
        for signal, value in call.ports():
            given = self._values[value]
            typed = given.typed_part if signal.kind == "boolean" else given
            arguments.append(given if self._notation.writes(typed) else self._atom(value))
        self.statements.append(BlockCall(name, program, tuple(arguments), call.identifier))
        # The next state stays in the instance.
        self._values |= dict.fromkeys(call.targets[:states], _UNREAD)
        for signal, target in zip(program.outputs, call.targets[states:], strict=True):
            self._values[target] = reading(signal.kind, f"{name}.{signal.identifier}")

    def _routine(self, call: RoutineCall) -> None:
        """Compute a routine, whose results are read as elements of its arrays."""
        call = call.needed(self._uses)
        listing = RoutineListing(call, self._scope, self._depth, self._of_step)
        self.statements += listing.statements(self._values)
        for array, targets in call.told:
            read = (place for place, target in enumerate(targets) if target in self._uses)
            for place in read:
                self._values[targets[place]] = variable(listing.element(array, place))

    def _of_step(
        self, block: Block, read: Sequence[Expression]
    ) -> tuple[list[ListingStatement], Expression]:
        folded = FoldedBlock(block, read, self._scope, depth=self._depth)
        return folded.statements, folded.results[0]

    def _carry(self, statement: ForLoop | Conditional, live: Sequence[int]) -> dict[int, str]:
        """Name the variables of those carried values that need one, by their position.

        What was carried by a statement before, and is read by this one alone, is carried on.
        """
        carried: dict[int, str] = {}
        for k in live:
            target, start = statement.targets[k], statement.carried[k]
            name, kept = self._label(target, "real"), self._values[start].text
            if not name and kept in self._carried and self._uses[start] == 1:
                name = kept
            wanted = self._preferred.get(target) or f"{statement.name}_value"
            carried[k] = name or self._names.new(wanted)
            self._values[target] = variable(carried[k])
        self._carried.update(carried.values())
        return carried

    def _is_short(self, expression: Expression, uses: int) -> bool:
        """Whether an expression may be written as often as it is read."""
        expression = expression.typed_part
        read = (each.operands[0] if each.code == "not" else each for each in expression.operands)
        plain = all(each.is_atom for each in read)
        width = self._width(expression)
        short = width <= _SHORT and width * uses <= _OFTEN
        # A number in another unit is as easily read where it is needed.
        scaled = expression.code in ("multiply", "divide") and uses == 2
        scaled = scaled and any(each.code == "constant" for each in expression.operands)
        return plain and (scaled or (short and expression.kind == "boolean"))

    def _operation(self, operation: Operation) -> Expression:
        """Return an operation over the expressions of its arguments."""
        code = operation.code
        if code == "constant":
            return constant(operation.constant)
        if code == "truth":
            # The number of a truth value is 0 or 1: its truth is that value itself. A boolean
            # argument stays one, whether or not its number has a variable by now.
            value = operation.arguments[0]
            number = self._arguments.get(value, self._values[value])
            if number.operation == "boolean to real":
                return number.operands[0]
        wanted = self._made(operation).typed_part
        for position, value in enumerate(operation.arguments):
            if not self._fits(wanted, position, self._values[value]):
                self._atom(value)
        widest = _WIDEST.get(code, _WIDTH)
        while True:
            expression = self._made(operation)
            folded = [value for value in operation.arguments if not self._values[value].is_atom]
            if self._width(expression) <= widest or not folded:
                return expression
            # What is too wide has variables for its widest operands.
            self._atom(max(folded, key=lambda value: self._width(self._values[value])))

    def _made(self, operation: Operation) -> Expression:
        """Return an operation over the expressions of its arguments, in their own type."""
        operands = tuple(self._values[value] for value in operation.arguments)
        bounds = [self._ranges.get(value) for value in operation.arguments]
        found = self._ranges.get(operation.target)
        if kind := _CONVERTED.get(operation.code):
            return Expression("convert", operands, held=kind)
        typed = in_own_type(operation.code, operands, bounds, found, self._integers)
        return typed or Expression(operation.code, operands).simplified()

    def _fits(self, wanted: Expression, position: int, operand: Expression) -> bool:
        """Whether the language can write an operand in that place."""
        if operand.is_atom or self._notation.repeats(wanted):
            return operand.is_atom
        limits = wanted.kind == "integer" and wanted.code in ("maximum", "minimum")
        if limits and operand.typed_part.code == "select":
            # STruC++ finds no type for a choice among whole numbers there.
            return False
        branch = wanted.code == "select" and position > 0 and not self._notation.chooses
        nested = branch and operand.code == "select" and _depth(operand) < _DEPTH
        return nested or self._notation.writes(operand)

    def _width(self, expression: Expression) -> int:
        if not self._notation.writes(expression):
            return max(self._width(operand) for operand in expression.operands)
        return len(self._notation.render(expression))

    def _compound(self, statement: ForLoop | Conditional) -> None:
        before, live = dict(self._values), needed_values(statement, self._uses)
        needed, read = needed_body(statement, live)
        loop = statement if isinstance(statement, ForLoop) else None
        index, rings = "", loop.rings if loop else ()
        turns, inside, counted = range(1), list[Expression](), list[Assignment]()
        if loop:
            index = self._names.shared("i", self._depth)
            turns, inside, counted = read_tables(loop, index, read, self._scope)
        first, of_rings = len(inside), len(inside) + len(statement.targets)
        carried = self._carry(statement, live)
        starts = (Assignment(name, before[statement.carried[k]]) for k, name in carried.items())
        start = tuple(each for each in starts if each.expression != variable(each.name))
        oldest = [
            self._names.new(f"oldest_{ring.signal.identifier}") if argument in read else ""
            for argument, ring in enumerate(rings, of_rings)
        ]
        given = {first + k: variable(name) for k, name in carried.items()}
        given |= {k: variable(name) for k, name in enumerate(oldest, of_rings)}
        values = (*statement.carried, *(-1 for _ in rings), *statement.invariants)
        # What only the body reads, it reads as it was before.
        inside += [
            given.get(argument) or (self._atom(value) if argument in read else _UNREAD)
            for argument, value in enumerate(values, first)
        ]
        made = FoldedBlock(needed, inside, self._scope, depth=self._depth + (loop is not None))
        body: list[ListingStatement] = [*counted, *made.statements]
        results = made.results
        update = self._update(list(carried.values()), results[: len(live)], body)
        if not (loop or body or update):
            # Neither is its condition needed.
            self.statements += start
            return
        condition = None if isinstance(statement, ForLoop) else self._values[statement.condition]
        turned = tuple(map(RingTurn, rings, oldest, results[len(live) :]))
        inner = tuple(body), update
        self.statements.append(
            Compound(statement.name, start, *inner, condition, index, turns, turned)
        )

    def _update(
        self, carried: Sequence[str], results: Sequence[Expression], body: list[ListingStatement]
    ) -> tuple[Assignment, ...]:
        """Return the next values; none of them may read a carried value already overwritten."""
        update = []
        for position, (name, result) in enumerate(zip(carried, results, strict=True)):
            if result == variable(name):
                continue
            if any(part.text in carried[:position] for part in result.parts):
                kept = self._names.new(f"next_{name}")
                body.append(Assignment(kept, result))
                result = variable(kept)
            update.append(Assignment(name, result))
        return tuple(update)


def _name_for(expression: Expression) -> str:
    """Return a name that says what an expression is."""
    expression = expression.typed_part
    code, operands = expression.code, expression.operands
    if code == "less_equal" and operands[0].code == "absolute" and operands[1].number > _LARGE:
        return _last_name(operands[0].operands[0], "_is_number")
    if code == "select" and operands[2].code == "constant" and expression.kind == "real":
        return _last_name(operands[1], "_used")
    if code in ("less", "less_equal") and "constant" in (operands[0].code, operands[1].code):
        first = operands[0].code == "constant"
        read = operands[1] if first else operands[0]
        return _last_name(read, "_above" if first else "_below") if read.is_atom else "condition"
    if expression.kind == "boolean":
        return "condition"
    return _RESULTS.get(code, "intermediate")


def _last_name(read: Expression, end: str) -> str:
    """Return the name of a variable, without what it is a member of, and an end."""
    return (re.split(r"\W+", read.text.rstrip("]"))[-1] if read.text else "value") + end


def _depth(expression: Expression) -> int:
    choices = expression.operands[1:] if expression.code == "select" else ()
    return max((1 + _depth(each) for each in choices), default=0)
