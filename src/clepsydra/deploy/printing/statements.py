"""What the printers of statements ask of a language, and how every language writes them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Self

from clepsydra.base.signal import Kind, Signal
from clepsydra.deploy.printing.expressions import Expression, Notation, constant, variable
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.listing import Assignment, BlockCall, Compound, ListingStatement
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
            return variable(name) if name else expression
        if operation == "real to boolean":
            return self.worded(Expression("not_equal", (expression.operands[0], constant())))
        if operation == "boolean to real" and not self.chooses:
            return self.worded(expression.as_select)
        if code == "select" and expression.kind == "boolean":
            expression = _logical(expression)
            code = expression.code
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

    def statements(self, entries: Sequence[ListingStatement]) -> list[str]:
        """Write the statements of a listing; what one condition decides stands in one IF.

        Each statement stands on one line, however long it is.

        Examples
        --------
        >>> from clepsydra.deploy.c99.statements import C99
        >>> from clepsydra.deploy.printing.expressions import flag
        >>> begun = [Assignment(n, Expression("select", (flag("cold"), variable("u"), variable(n))))
        ...          for n in ("a", "b")]
        >>> print("\\n".join(C99("law", "double").statements(begun)))
        if (cold) {
          a = u;
          b = u;
        }

        What holds otherwise comes first, where nothing that is assigned is read:

        >>> from clepsydra.deploy.structured_text.dialect import dialect_of
        >>> from clepsydra.deploy.structured_text.statements import StructuredText
        >>> share = Expression("divide", (variable("gain"), variable("time")))
        >>> chosen = Expression("select", (flag("acts"), share, variable("rest")))
        >>> both = [Assignment(name, chosen) for name in ("low", "high")]
        >>> StructuredText(dialect_of("codesys"), "double").statements(both)[:3]
        ['low := rest;', 'high := rest;', 'IF acts THEN']
        """
        lines: list[str] = []
        rest = list(entries)
        while rest:
            group = self._decided_by_one(rest)
            if len(group) < 2:
                lines += self._statement(rest.pop(0))
                continue
            del rest[: len(group)]
            choices = [(each.name, *_choice(each.expression)) for each in group]
            first = [Assignment(name, value) for name, _, value, _ in choices]
            last = [Assignment(name, v) for name, _, _, v in choices if not _keeps(name, v)]
            branches = [(self.expression(choices[0][1]), self._assigned(first))]
            read = {part.text for each in group for part in each.expression.parts}
            free = read.isdisjoint(each.name for each in group)
            if free and all(value.is_atom for *_, value in choices):
                # What holds otherwise comes first.
                lines += [*self._assigned(last), *self._decided(branches)]
                continue
            lines += self._decided([*branches, ("", self._assigned(last))])
        return lines

    def _decided(self, branches: Sequence[tuple[str, Sequence[str]]]) -> list[str]:
        """Write an IF: what each condition decides, the others behind the empty one."""
        lines: list[str] = []
        for condition, inside in branches:
            opening = self.another if lines else self.opened
            head = opening.format(condition) if condition else self.otherwise
            lines += [head, *indented(inside)] if inside else []
        return [*lines, self.closed]

    def _statement(self, entry: ListingStatement) -> list[str]:
        if isinstance(entry, Assignment):
            return self.assign(entry.name, entry.expression)
        if isinstance(entry, BlockCall):
            return self.call(entry)
        title, lines, turns = entry.label, self._body(entry), entry.turns
        if entry.condition is not None:
            lines = self._decided([(self.expression(entry.condition), lines)])
        else:
            title += f": {len(turns)} turn{'s' if len(turns) > 1 else ''}"
            # What runs once needs no loop.
            if len(turns) > 1:
                begin = self.repeated.format(entry.index, turns.start, turns[-1], turns.stop)
                lines = [begin, *indented(lines), self.repeated_end]
        return [self.comment.format(title), *self._assigned(entry.start), *lines]

    def _assigned(self, entries: Iterable[Assignment]) -> list[str]:
        return [line for each in entries for line in self.assign(each.name, each.expression)]

    def _body(self, entry: Compound) -> list[str]:
        """Write what a loop repeats or a branch does, up to the next values of what it carries."""
        places = [f"{self.states}{turn.ring.signal.identifier}" for turn in entry.rings]
        read, written = [], []
        for turn, place in zip(entry.rings, places, strict=True):
            length = turn.ring.length if is_ring(turn.ring) else 0
            if turn.oldest:
                read.append(Assignment(turn.oldest, variable(ring_place(place, length))))
            written += self.write_ring(place, turn.written, length)
        return [
            *self._assigned(read), *self.statements(entry.body), *written,
            *self._assigned(entry.update),
        ]  # fmt: skip

    def write_ring(self, name: str, written: Expression, length: int) -> list[str]:
        """Write a value over the oldest one of a ring, and go on to the place of the next one.

        >>> from clepsydra.deploy.c99.statements import C99
        >>> print("\\n".join(C99("law", "double").write_ring("flow", variable("inflow"), 5)))
        flow[flow_position] = inflow;
        flow_position = flow_position + 1 < 5 ? flow_position + 1 : 0;
        """
        lines, position = self.assign(ring_place(name, length), written), f"{name}_position"
        if length:
            following = self.advanced.format(position, length)
            lines.append(self.assignment.format(position, following))
        return lines

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
        IF level < limit THEN
          u := gain / time;
        END_IF;
        """
        if not self._branches(name, expression):
            return [self.assignment.format(name, self.expression(expression))]
        condition, first, second = _choice(expression)
        lines: list[str] = []
        if held is None and second.is_atom and not expression.reads(name):
            # What holds otherwise comes first.
            lines, held = self.assign(name, second), second
        branches = [(self.expression(condition), self.assign(name, first, held))]
        while second.code == "select":
            condition, first, second = _choice(second)
            branches.append((self.expression(condition), self.assign(name, first, held)))
        if second != held and not _keeps(name, second):
            branches.append(("", self.assign(name, second, held)))
        return [*lines, *self._decided(branches)]

    def _branches(self, name: str, expression: Expression) -> bool:
        """Whether an assignment is written with IF."""
        if expression.as_select.code != "select":
            return False
        return _keeps(name, _choice(expression)[2]) or not self.writes(expression)

    def _decided_by_one(self, entries: Sequence[ListingStatement]) -> list[Assignment]:
        """Return the assignments at the beginning that the same condition decides."""
        found: list[Assignment] = []
        for each in entries:
            if not isinstance(each, Assignment) or not self._branches(each.name, each.expression):
                break
            condition = _choice(each.expression)[0]
            if found and condition != _choice(found[0].expression)[0]:
                break
            found.append(each)
            if condition.reads(each.name):
                break
        return found


def ring_place(name: str, length: int = 0) -> str:
    """Return where the oldest value of a ring stands, or a state that is no array.

    >>> ring_place("flow", 5), ring_place("level")
    ('flow[flow_position]', 'level')
    """
    return f"{name}[{name}_position]" if length else name


def _logical(select: Expression) -> Expression:
    """Return a choice of truth values as logic where one of them is known."""
    condition, first, second = select.operands
    for place, value in ((1, first), (0, second)):
        if value.code == "constant":
            truth, other = bool(value.number), second if place else first
            # Where the known one is FALSE the other one counts under the opposite condition.
            opposite = Expression("not", (condition,))
            holds = condition if truth == bool(place) else opposite
            return Expression("or" if truth else "and", (holds.simplified(), other)).simplified()
    return select


def _choice(expression: Expression) -> tuple[Expression, Expression, Expression]:
    """Return condition and both branches, in which the condition is known."""
    condition, first, second = expression.as_select.operands
    return condition, _known(first, condition, True), _known(second, condition, False)


def _known(expression: Expression, condition: Expression, holds: bool) -> Expression:
    """Return an expression where a condition holds, or does not."""
    if expression.code == "select" and expression.operands[0] == condition:
        return _known(expression.operands[1 if holds else 2], condition, holds)
    operands = tuple(_known(each, condition, holds) for each in expression.operands)
    return replace(expression, operands=operands)


def _keeps(name: str, expression: Expression) -> bool:
    """Whether an expression is what a variable holds already."""
    return expression.code == "variable" and expression.text == name
