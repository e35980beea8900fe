"""What the values of a block are written as: folded into where they are read, or variables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.deploy.printing.expressions import (
    Expression,
    Notation,
    flag,
    reading,
    render,
    simplified,
    variable,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import Assignment, ListingStatement
from clepsydra.deploy.printing.typed_values import in_own_type, whole_form
from clepsydra.deploy.printing.whole_numbers import INTEGERS, WholeRange
from clepsydra.program.program import Block, Call, Operation, read_by

#: A truth value up to this width is written wherever it is read [characters].
_SHORT = 32
#: What a variable is called that nothing gives a name.
_CALLED = {"maximum": "larger", "minimum": "smaller", "greatest": "larger", "least": "smaller",
           "limit": "limited"}  # fmt: skip
#: A number is no larger than one above this.
_LARGE = 1e37
#: And up to this many characters in all.
_OFTEN = 90
#: Choices are folded into choices no deeper than this, so that a chain of ELSIF stays readable.
_DEPTH = 4


@dataclass
class Scope:
    """The values of one block while its statements are written.

    Parameters
    ----------
    notation : Notation
    names : Identifiers
    values : dict
        Value to the expression that reads it; the arguments at first.
    preferred : mapping
        Value to the name that it gets if it needs a variable.
    ranges : mapping
        Bounds of the values that are whole numbers.

    Examples
    --------
    See `clepsydra.deploy.printing.folding.list_block`.
    """

    notation: Notation
    names: Identifiers
    values: dict[int, Expression]
    preferred: dict[int, str]
    ranges: Mapping[int, WholeRange]
    statements: list[ListingStatement] = field(default_factory=list)
    #: Variables of loops and branches, which a later one may go on with.
    carried: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._integers = INTEGERS["single" if self.notation.single else "double"][:2]
        self._arguments = dict(self.values)
        self._read_as_number: set[int] = set()

    def assign(self, value: int, name: str = "") -> Expression:
        """Give a value a variable, and return the expression that reads it."""
        expression = self.values[value]
        if not name:
            wanted = self.preferred.get(value) or _name_for(expression)
            name = self.names.new(wanted) if wanted else self.names.temporary()
        read = flag(name) if expression.is_truth else variable(name)
        if expression.code == "select" and value not in self._read_as_number:
            integers = whole_form(expression)
            expression = expression if integers is None else Expression("real", (integers,))
        if expression.code in ("real", "number"):
            read = reading("integer" if expression.code == "real" else "boolean", name)
            expression = expression.operands[0]
        self.statements.append(Assignment(name, expression))
        self.values[value] = read
        return read

    def atom(self, value: int) -> Expression:
        """Return a value as something that can be written more than once."""
        expression = self.values[value]
        read = expression.code == "number" and expression.operands[0].is_atom
        if expression.is_atom or read:
            return expression
        return self.assign(value)

    def name_by_ports(self, block: Block) -> None:
        """Let a variable that a call reads be named after the port that it goes to."""
        for call in (each for each in block.statements if isinstance(each, Call)):
            for signal, value in call.ports():
                free = self.names.is_free(signal.identifier)
                name = signal.identifier if free else f"{call.identifier}_{signal.identifier}"
                self.preferred.setdefault(value, name)

    def count_by_readers(self, block: Block) -> None:
        """Find the values that something reads as a number, not as an integer."""
        others = set(block.results)
        for each in block.statements:
            if isinstance(each, Operation):
                others.update(() if each.target in self.ranges else each.arguments)
            elif isinstance(each, Call):
                others.update(value for signal, value in each.ports() if signal.kind != "integer")
            else:
                others.update(read_by(each))
        self._read_as_number = others

    def is_short(self, expression: Expression, uses: int) -> bool:
        """Whether an expression may be written as often as it is read."""
        if expression.code == "number":
            expression = expression.operands[0]
        read = (each.operands[0] if each.code == "not" else each for each in expression.operands)
        plain = all(each.is_atom for each in read)
        width = self._width(expression)
        return expression.is_truth and plain and width <= _SHORT and width * uses <= _OFTEN

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
        typed = self._made(operation)
        wanted = typed.operands[0].code if typed.code in ("real", "number") else typed.code
        for position, value in enumerate(operation.arguments):
            if not self._fits(wanted, position, self.values[value]):
                self.atom(value)
        # A long sum reads well on several lines.
        widest = self.notation.width * (3 if code == "add" else 1)
        while True:
            expression = self._made(operation)
            folded = [value for value in operation.arguments if not self.values[value].is_atom]
            if self._width(expression) <= widest or not folded:
                return expression
            # What is too wide has variables for its widest operands.
            self.atom(max(folded, key=lambda value: self._width(self.values[value])))

    def _made(self, operation: Operation) -> Expression:
        """Return an operation over the expressions of its arguments, in their own type."""
        operands = tuple(self.values[value] for value in operation.arguments)
        bounds = [self.ranges.get(value) for value in operation.arguments]
        found = self.ranges.get(operation.target)
        typed = in_own_type(operation.code, operands, bounds, found, self._integers)
        return typed or simplified(Expression(operation.code, operands))

    def _fits(self, code: str, position: int, operand: Expression) -> bool:
        """Whether the language can write an operand in that place."""
        if operand.is_atom or code in self.notation.repeating:
            return operand.is_atom
        branch = code == "select" and position > 0 and code in self.notation.statements
        nested = branch and operand.code == "select" and _depth(operand) < _DEPTH
        return nested or self.notation.writes(operand)

    def _width(self, expression: Expression) -> int:
        if not self.notation.writes(expression):
            return max(self._width(operand) for operand in expression.operands)
        return len(render(expression, self.notation))


def _name_for(expression: Expression) -> str:
    """Return a name that says what an expression is; empty where it says too little."""
    code, operands = expression.code, expression.operands
    if code in ("real", "number"):
        return _name_for(operands[0])
    if code == "less_equal" and operands[0].code == "absolute" and operands[1].number > _LARGE:
        return _last_name(operands[0].operands[0], "_is_number")
    if code == "select" and operands[2].code == "constant":
        return _last_name(operands[1], "_used")
    other = {"maximum": "minimum", "minimum": "maximum"}.get(code)
    if other and [each.code for each in operands] == ["variable", other]:
        return "limited"
    return _CALLED.get(code, "")


def _last_name(read: Expression, end: str) -> str:
    """Return the name of a variable, without what it is a member of, and an end."""
    return re.split(r"\W+", read.text.rstrip("]"))[-1] + end if read.text else ""


def _depth(expression: Expression) -> int:
    choices = expression.operands[1:] if expression.code == "select" else ()
    return max((1 + _depth(each) for each in choices), default=0)
