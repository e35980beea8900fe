"""What the printers of statements ask of a language, and how every language writes them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Self

from clepsydra.base.signal import Kind, Signal
from clepsydra.deploy.printing.expressions import Expression, Notation, constant, variable
from clepsydra.deploy.printing.lines import LINE, indented
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Compound,
    ListingStatement,
    Remark,
    Repeated,
    assigned,
)
from clepsydra.program.entries import is_ring
from clepsydra.program.operation import COMPARISONS

# A variable is compared with a number, not the other way round.
_TURNED = {"less": "greater", "less_equal": "greater_equal"}


class Language(Notation, ABC):
    """How a language writes expressions and statements; what is filled in stands in braces.

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import C99
    >>> from clepsydra.deploy.printing.expressions import flag
    >>> C99("law", "double").expression(Expression("not", (flag("cold"),)))
    '!cold'
    """

    #: Kind of a signal to the type of a variable.
    types: Mapping[str, str]
    comment: str
    assignment: str
    #: A conditional: its first branch, each next one, the last one, its end.
    opened: str
    another: str
    otherwise: str
    closed: str
    #: A loop: its first line, with index, first and last value, and the one behind; its end.
    repeated: str
    repeated_end: str
    #: The place behind a place in a ring of a length.
    advanced: str
    #: What stands before the name of a state.
    states = ""
    #: How a call hands an output to a variable; empty where it cannot.
    told = ""
    #: Names of numbers, by their type and by what they are.
    constants: Mapping[tuple[Kind, float], str] = {}

    @abstractmethod
    def record(self, name: str) -> str:
        """Return what the type of a structure is called."""

    def naming(self, constants: Mapping[str, Signal]) -> Self:
        """Return this language where numbers have names."""
        named = copy(self)
        named.constants = {
            (each.kind, each.initial): name
            for name, each in constants.items()
            if self.readable(each.initial)
        }
        return named

    def readable(self, number: float) -> bool:
        """Whether the language can read a number at all."""
        return True

    def expression(self, expression: Expression) -> str:
        """Write an expression.

        Raises
        ------
        InputError
            The language has no such function, or a number is not finite.
        """
        return self.render(self.worded(expression))

    def worded(self, expression: Expression, *, compared: bool = False) -> Expression:
        """Return an expression as a person would write it; `compared` if it is an operand of <."""
        code, operation = expression.code, expression.operation
        if code == "constant":
            name = self.constants.get((expression.kind, expression.number))
            return variable(name, expression.kind) if name else expression
        if operation == "real to boolean":
            return self.worded(Expression("not_equal", (expression.operands[0], constant())))
        if operation == "boolean to real" and not self.chooses:
            return self.worded(expression.as_select)
        operands = tuple(
            self.worded(part, compared=code in COMPARISONS) for part in expression.operands
        )
        if code == "not" and operands[0].code in ("equal", "not_equal"):
            other = "equal" if operands[0].code == "not_equal" else "not_equal"
            return replace(operands[0], code=other)
        if code in _TURNED and expression.operands[0].code == "constant":
            return Expression(_TURNED[code], operands[::-1])
        return replace(expression, operands=operands)

    def number(self, value: float, place: str = "a number") -> str:
        """Write a number of a declaration; `place` is where it stands."""
        return self.render(constant(value))

    def initial(self, signal: Signal) -> str:
        """Write the initial value of a signal in its type."""
        if signal.kind == "real":
            return self.number(signal.initial, f"initial value of {signal.name}")
        return self.render(constant(signal.initial, signal.kind))

    @abstractmethod
    def call(self, entry: BlockCall) -> list[str]:
        """Write the call of an instance."""

    def statements(
        self, entries: Sequence[ListingStatement], told: Mapping[str, Sequence[str]] | None = None
    ) -> list[str]:
        """Write the statements of a listing, each on one line however long it is.

        Above the last one that assigns a variable stand the rows that tell what it is.
        """
        lines, told = list[str](), told or {}
        last = {name: k for k, each in enumerate(entries) for name in assigned(each)}
        for k, each in enumerate(entries):
            for name in assigned(each):
                lines += told.get(name, ()) if last[name] == k else ()
            lines += self._statement(each)
        return lines

    def _decided(self, branches: Sequence[tuple[str, Sequence[str]]]) -> list[str]:
        """Write an IF: what each condition decides, the others behind the empty one.

        What a branch does stands beside its condition, if that is one short statement.
        """
        lines: list[str] = []
        for condition, inside in branches:
            opening = self.another if lines else self.opened
            head = opening.format(condition) if condition else self.otherwise
            beside = len(inside) == 1 and not inside[0].startswith(self.opened[:2])
            whole = f"{head} {inside[0]}" if beside else ""
            if inside:
                lines += [whole] if 0 < len(whole) <= LINE else [head, *indented(inside)]
        alone = f"{lines[0]} {self.closed}"
        return [alone] if len(lines) == 1 and len(alone) <= LINE else [*lines, self.closed]

    def _statement(self, entry: ListingStatement) -> list[str]:
        if isinstance(entry, Assignment):
            return self.assign(entry.name, entry.expression)
        if isinstance(entry, BlockCall):
            return self.call(entry)
        if isinstance(entry, Remark):
            return [self.comment.format(entry.text)]
        if isinstance(entry, Repeated):
            return self.loop(entry, self.statements(entry.body))
        title, lines, turns = entry.label, self._body(entry), entry.turns
        if entry.condition is not None:
            lines = self._decided([(self.expression(entry.condition), lines)])
        else:
            title += f": {len(turns)} turn{'s' if len(turns) > 1 else ''}"
            # What runs once needs no loop.
            if len(turns) > 1:
                begin = self.repeated.format(entry.index, turns.start, turns[-1], turns.stop)
                lines = [begin, *indented(lines), self.repeated_end]
        return [self.comment.format(title), *self.statements(entry.start), *lines]

    def loop(self, entry: Repeated, body: Sequence[str]) -> list[str]:
        """Write a loop over arrays around the lines of its body."""
        begin = self.repeated.format(entry.index, entry.first, entry.last, entry.behind)
        return [begin, *indented(body), self.repeated_end]

    def _body(self, entry: Compound) -> list[str]:
        """Write what a loop repeats or a branch does, up to the next values of what it carries."""
        read, written, moved = list[Assignment](), list[Assignment](), list[str]()
        for turn in entry.rings:
            name = f"{self.states}{turn.ring.signal.identifier}"
            length = turn.ring.length if is_ring(turn.ring) else 0
            place = ring_place(name, length)
            read += [Assignment(turn.oldest, variable(place))] if turn.oldest else []
            written.append(Assignment(place, turn.written))
            moved += [self.moved_on(name, length)] if length else []
        before = self.statements([*read, *entry.body, *written])
        return [*before, *moved, *self.statements(entry.update)]

    def moved_on(self, name: str, length: int) -> str:
        """Write that a ring goes on to the place of what is now its oldest value.

        >>> from clepsydra.deploy.c99.statements import C99
        >>> C99("law", "double").moved_on("flow", 5)
        'flow_position = flow_position + 1 < 5 ? flow_position + 1 : 0;'
        """
        position = f"{name}_position"
        return self.assignment.format(position, self.advanced.format(position, length))

    def assign(
        self, name: str, expression: Expression, held: Expression | None = None
    ) -> list[str]:
        """Write an assignment; a choice that the language has no expression for becomes IF.

        Parameters
        ----------
        name : str
        expression : Expression
        held : Expression, optional
            What the variable is already.

        Examples
        --------
        >>> from clepsydra.deploy.structured_text.dialect import dialect_of
        >>> from clepsydra.deploy.structured_text.statements import StructuredText
        >>> wording = StructuredText(dialect_of("codesys"), "double")
        >>> falls = Expression("less", (variable("level"), variable("limit")))
        >>> more = Expression("divide", (variable("gain"), variable("time")))
        >>> chosen = Expression("select", (falls, more, variable("rest")))
        >>> print("\\n".join(wording.assign("u", chosen)))
        u := rest;
        IF level < limit THEN u := gain / time; END_IF;
        """
        if not self._branches(name, expression):
            return [self.assignment.format(name, self.expression(expression))]
        condition, first, second = expression.as_select.operands
        lines: list[str] = []
        if held is None and second.is_atom and not expression.reads(name):
            # What holds otherwise comes first.
            lines, held = self.assign(name, second), second
        branches = [(self.expression(condition), self.assign(name, first, held))]
        while second.code == "select":
            condition, first, second = second.operands
            branches.append((self.expression(condition), self.assign(name, first, held)))
        if second != held and not _keeps(name, second):
            branches.append(("", self.assign(name, second, held)))
        return [*lines, *self._decided(branches)]

    def _branches(self, name: str, expression: Expression) -> bool:
        """Whether an assignment is written with IF."""
        if expression.as_select.code != "select":
            return False
        return _keeps(name, expression.as_select.operands[2]) or not self.writes(expression)


def ring_place(name: str, length: int = 0) -> str:
    """Return where the oldest value of a ring stands, or a state that is no array.

    >>> ring_place("flow", 5), ring_place("level")
    ('flow[flow_position]', 'level')
    """
    return f"{name}[{name}_position]" if length else name


def _keeps(name: str, expression: Expression) -> bool:
    """Whether an expression is what a variable holds already."""
    return expression.code == "variable" and expression.text == name
