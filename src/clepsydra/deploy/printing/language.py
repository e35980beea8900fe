"""What the printers of statements ask of a language."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from typing import Self

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import (
    Expression,
    Notation,
    as_select,
    flag,
    render,
    simplified,
    variable,
)
from clepsydra.deploy.printing.listing import BlockCall
from clepsydra.program.program import COMPARISONS

# A variable is compared with a number, not the other way round.
_TURNED = {"less": "greater", "less_equal": "greater_equal"}


@dataclass(frozen=True)
class Syntax:
    """How a language writes statements; what is filled in stands in braces.

    Parameters
    ----------
    comment, assignment : str
    opened, another, otherwise, closed : str
        A conditional: its first branch, each next one, the last one, its end.
    counted, loop_closed : str
        A loop: its beginning, with the index, the number of turns and one less, and its end.
    advanced : str
        The place behind a place in a ring of a length.
    states : str
        What stands before the name of a state.

    Examples
    --------
    >>> from clepsydra.deploy.c99.language import SYNTAX
    >>> SYNTAX.opened.format("late")
    'if (late) {'
    """

    comment: str
    assignment: str
    opened: str
    another: str
    otherwise: str
    closed: str
    counted: str
    loop_closed: str
    advanced: str
    states: str = ""


class Language(ABC):
    """How a language writes expressions and statements.

    Parameters
    ----------
    notation : Notation
    syntax : Syntax
    types : mapping
        Kind of a signal to the type of a variable.

    Examples
    --------
    >>> from clepsydra.deploy.c99.language import C99
    >>> from clepsydra.deploy.printing.expressions import flag
    >>> C99("law", "double").expression(Expression("not", (flag("cold"),)))
    '!cold'
    """

    def __init__(self, notation: Notation, syntax: Syntax, types: Mapping[str, str]) -> None:
        self.notation, self.syntax, self.types = notation, syntax, types
        #: Names of numbers, by whether these are integers and by what they are.
        self.constants: Mapping[tuple[bool, float], str] = {}

    @abstractmethod
    def record(self, name: str) -> str:
        """Return what the type of a structure is called."""

    def naming(self, constants: Mapping[tuple[bool, float], str]) -> Self:
        """Return this language where numbers have names."""
        named = copy(self)
        named.constants = {key: name for key, name in constants.items() if self.readable(key[1])}
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
        return render(self.worded(expression), self.notation)

    def worded(self, expression: Expression, *, compared: bool = False) -> Expression:
        """Return an expression as a person would write it; `compared` if it is an operand of <."""
        code = expression.code
        if code in ("constant", "whole"):
            name = self.constants.get((code == "whole", expression.number))
            return variable(name) if name else expression
        if code == "truth":
            zero = Expression("constant")
            return self.worded(Expression("not_equal", (expression.operands[0], zero)))
        if code == "number" and "select" in self.notation.functions:
            return self.worded(as_select(expression))
        if code == "select" and expression.is_truth:
            expression = _logical(expression)
            code = expression.code
        operands = tuple(
            self.worded(part, compared=code in COMPARISONS) for part in expression.operands
        )
        if code == "not" and operands[0].code in ("equal", "not_equal"):
            other = "equal" if operands[0].code == "not_equal" else "not_equal"
            return replace(operands[0], code=other)
        if code in _TURNED and expression.operands[0].code in ("constant", "whole"):
            return Expression(_TURNED[code], operands[::-1])
        return replace(expression, operands=operands)

    def number(self, value: float, place: str = "a number") -> str:
        """Write a number of a declaration; `place` is where it stands."""
        return render(Expression("constant", number=value), self.notation)

    def initial(self, signal: Signal) -> str:
        """Write the initial value of a signal in its type."""
        if signal.kind == "real":
            return self.number(signal.initial, f"initial value of {signal.name}")
        if signal.kind == "boolean":
            return self.expression(flag("TRUE" if signal.initial else "FALSE"))
        return str(int(signal.initial))

    @abstractmethod
    def call(self, entry: BlockCall) -> list[str]:
        """Write the call of an instance."""


def _logical(select: Expression) -> Expression:
    """Return a choice of truth values as logic where one of them is known."""
    condition, first, second = select.operands
    known = {"TRUE": True, "FALSE": False}
    for place, value in ((1, first), (0, second)):
        truth, other = known.get(value.text), second if place else first
        if truth is not None:
            # Where the known one is FALSE the other one counts under the opposite condition.
            opposite = Expression("not", (condition,))
            holds = condition if truth == bool(place) else opposite
            return simplified(Expression("or" if truth else "and", (simplified(holds), other)))
    return select
