"""Expressions of a printed program, and how one is written so that its tree survives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Kind
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.whole_numbers import INTEGER_HIGH, INTEGER_LOW
from clepsydra.program.operation import COMPARISONS, LOGIC
from clepsydra.program.precision import Precision

# How tightly a written expression holds together; an operand that is looser than its place
# demands is put in parentheses.
_LOOSE, _SIGNED, _SUM, _PRODUCT, _ATOM = range(5)
#: How tightly an operation holds together, and its operands have to; others compare.
_STRENGTHS = dict.fromkeys(("multiply", "divide"), (_PRODUCT, _PRODUCT, _ATOM))
_STRENGTHS |= dict.fromkeys(("add", "subtract"), (_SUM, _SUM, _PRODUCT))
#: What a language without a function for it writes as a choice.
_CHOSEN = {
    "select": "{c} ? {1} : {2}",
    "integer absolute": "{0} < 0 ? -{0} : {0}",
    **dict.fromkeys(("maximum", "integer maximum"), "{0} > {1} ? {0} : {1}"),
    **dict.fromkeys(("minimum", "integer minimum"), "{0} < {1} ? {0} : {1}"),
}
#: Where that holds an operand twice.
_REPEATING = {*_CHOSEN} - {"select"}
_OPPOSITE = {"and": "or", "or": "and"}
_TRUTHS = COMPARISONS | LOGIC | {"greater", "greater_equal"}
_ARITHMETIC = frozenset({"add", "subtract", "multiply", "negate", "absolute"})
#: Operations that languages have for integers apart.
_TWOFOLD = frozenset({"absolute", "minimum", "maximum"})
#: Operations with the type of their last operand.
_ALIKE = _ARITHMETIC | _TWOFOLD | {"select"}


@dataclass(frozen=True)
class Expression:
    """A tree of operations over variables and constants.

    Parameters
    ----------
    code : str
        An operation code of `clepsydra.program.program`, "variable", "constant", or "convert"
        (from the type of the operand to another one).
    operands : tuple of Expression
    text : str
        What is written for a variable.
    number : float
        The value of a constant; 0 or 1 of a truth value.
    held : {"real", "integer", "boolean"}
        The type of a variable, of a constant or of what is converted.

    Examples
    --------
    >>> less = Expression("less", (variable("level"), constant(0.2)))
    >>> less.kind, less.is_atom
    ('boolean', False)
    """

    code: str
    operands: tuple[Expression, ...] = ()
    text: str = ""
    number: float = 0.0
    held: Kind = "real"

    @property
    def is_atom(self) -> bool:
        """Whether it can be written twice without being computed twice."""
        return self.typed_part.is_atom if self.operation == "integer to real" else not self.operands

    @property
    def kind(self) -> Kind:
        """The type of a variable that holds it."""
        if self.code in _TRUTHS:
            return "boolean"
        return self.operands[-1].kind if self.code in _ALIKE else self.held

    @property
    def operation(self) -> str:
        """What a language has a sign or a function for: the code, with its types where they count.

        >>> reading("integer", "scans").operation
        'integer to real'
        """
        if self.code == "convert":
            return f"{self.operands[0].kind} to {self.held}"
        twofold = self.code in _TWOFOLD and self.kind == "integer"
        return f"integer {self.code}" if twofold else self.code

    @property
    def typed_part(self) -> Expression:
        """What a number is made of where that is an integer or a truth value; else itself."""
        return self.operands[0] if self.code == "convert" and self.held == "real" else self

    @property
    def as_select(self) -> Expression:
        """What is converted from a truth value or from a choice, as a choice; else itself.

        >>> reading("boolean", "late").as_select.code
        'select'
        """
        part, kind = self.operands[0] if self.code == "convert" else self, self.held
        if part is not self and part.kind == "boolean":
            return Expression("select", (part, constant(1.0, kind), constant(0.0, kind)))
        if part is not self and part.code == "select" and part.kind == "integer":
            condition, *choices = part.operands
            return Expression("select", (condition, *(each.to(kind) for each in choices)))
        return self

    def known_as(self, kind: Kind) -> Expression | None:
        """Return it in a type that it has without rounding or comparing; None where there is none.

        >>> constant(3.0).known_as("integer").kind, constant(0.5).known_as("integer")
        ('integer', None)
        """
        part, number = self.typed_part, self.number
        if kind in (self.kind, part.kind):
            return self if self.kind == kind else part
        if kind == "real" or (part.kind == "boolean" and part is not self):
            return Expression("convert", (part,), held=kind)
        if self.code == "constant" and self.kind == "real":
            # An integer has no negative zero.
            whole = INTEGER_LOW < number <= INTEGER_HIGH and number % 1.0 == 0.0
            fits = whole and str(number) != "-0.0" if kind == "integer" else number in (0.0, 1.0)
            return constant(number, kind) if fits else None
        if self.code == "select" and kind == "integer":
            choices = [each.known_as(kind) for each in self.operands[1:]]
            if None not in choices:
                return Expression("select", (self.operands[0], *filter(None, choices)))
        return None

    def to(self, kind: Kind) -> Expression:
        """Return it in a type; that it fits has been proved.

        >>> reading("boolean", "good").to("boolean").text
        'good'
        """
        return self.known_as(kind) or Expression("convert", (self,), held=kind)

    @property
    def parts(self) -> Iterator[Expression]:
        """The expression and every part of it.

        >>> [part.code for part in Expression("negate", (variable("a"),)).parts]
        ['negate', 'variable']
        """
        yield self
        for operand in self.operands:
            yield from operand.parts

    def reads(self, name: str) -> bool:
        """Whether it reads a variable."""
        return any(part.text == name for part in self.parts)

    def simplified(self) -> Expression:
        """Return a condition without NOT of a bracketed AND or OR, and with no part said twice.

        Some compilers of Structured Text take NOT of a bracket for a function, which has no truth
        value of two comparisons to work on. Operands are simplified already; any other expression
        is returned as it is.

        Examples
        --------
        >>> from clepsydra.deploy.c99.statements import C99
        >>> a, b = flag("a"), flag("b")
        >>> both = Expression("and", (a, b))
        >>> [C99("law", "double").render(Expression(*parts).simplified()) for parts in (
        ...     ("not", (both,)), ("and", (both, a)), ("and", (b, both)))]
        ['!a || !b', 'a && b', 'b && a']
        """
        code, operands = self.code, self.operands
        if code == "not" and operands[0].code == "not":
            return operands[0].operands[0]
        if code == "not" and operands[0].code in _OPPOSITE:
            negated = (Expression("not", (each,)).simplified() for each in operands[0].operands)
            return Expression(_OPPOSITE[operands[0].code], tuple(negated)).simplified()
        if code not in _OPPOSITE:
            return self
        # By their texts: equal numbers may be zeros of different sign.
        first, *rest = {repr(part): part for part in self._chain(code)}.values()
        for part in rest:
            first = Expression(code, (first, part))
        return first

    def _chain(self, code: str) -> Iterator[Expression]:
        """Yield the parts of a chain of AND or of OR, in order."""
        if self.code != code:
            yield self
            return
        for operand in self.operands:
            yield from operand._chain(code)


def variable(text: str, kind: Kind = "real") -> Expression:
    """Return the expression that reads a variable of a type."""
    return Expression("variable", text=text, held=kind)


def flag(text: str) -> Expression:
    """Return the expression that reads a truth value."""
    return variable(text, "boolean")


def constant(number: float = 0.0, kind: Kind = "real") -> Expression:
    """Return a constant of a type."""
    return Expression("constant", number=number, held=kind)


def reading(kind: Kind, text: str) -> Expression:
    """Return the expression that reads a variable of a type, as a number.

    Examples
    --------
    >>> reading("boolean", "good").code, reading("real", "level").code
    ('convert', 'variable')
    """
    return variable(text, kind).to("real")


#: Signs that all languages share.
OPERATORS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"}
OPERATORS |= {"less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">="}


class Notation:
    """How a language writes operations; what each one has is set in its class.

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import C99
    >>> less = Expression("less", (variable("a"), variable("b")))
    >>> C99("law", "double").render(Expression("not", (less,)))
    '!(a < b)'
    """

    #: What the reader calls it.
    language: str
    precision: Precision
    #: Code of a binary operation to its sign.
    operators: ClassVar[Mapping[str, str]]
    #: Operation to the name of the function that computes it, or to a type in parentheses.
    functions: Mapping[str, str]
    #: Operation to the names of its function's parameters, where they are written.
    formal: Mapping[str, tuple[str, ...]] = {}
    #: The sign before a negated truth value.
    negation: str
    #: Whether a choice is an expression, ``c ? a : b``, and not only a statement.
    chooses = False
    #: Whether entries of a table are computed where that gives every bit of them: a list of
    #: numbers takes memory, in some systems in each instance.
    computes = False
    #: The text of infinity; empty where the language has none.
    infinity = ""
    #: What stands behind a number to give it its type.
    suffix = ""
    #: What does not hold, and what does.
    truths = ("FALSE", "TRUE")

    def readable(self, number: float) -> bool:
        """Whether the system can read a number at all."""
        return True

    def writes(self, expression: Expression) -> bool:
        """Whether an expression can be part of another one.

        A function that selects evaluates both alternatives, so these have to be at hand.
        """
        code, operands = expression.code, expression.operands
        if code == "convert":
            return operands[0].kind == "boolean" or self.writes(operands[0])
        return self.chooses or code != "select" or all(map(_at_hand, operands[1:]))

    def repeats(self, expression: Expression) -> bool:
        """Whether the text of an operation holds an operand more than once."""
        return self.chooses and expression.operation in _REPEATING

    def render(self, expression: Expression) -> str:
        """Write an expression, with the parentheses that keep its tree.

        Raises
        ------
        InputError
            The language has no such function or constant.

        Examples
        --------
        >>> from clepsydra.deploy.c99.statements import C99
        >>> a, b = variable("a"), variable("b")
        >>> right = Expression("add", (a, Expression("add", (a, b))))
        >>> C99("law", "double").render(Expression("multiply", (right, b)))
        '(a + (a + b)) * b'
        """
        return self._written(expression)[0]

    def _written(self, expression: Expression) -> tuple[str, int]:
        code, operands = expression.operation, expression.operands
        function = self.functions.get(code, "")
        if code == "variable":
            return expression.text, _ATOM
        if code == "constant":
            sign = _SIGNED if math.copysign(1.0, expression.number) < 0 else _ATOM
            return self._constant(expression.number, expression.kind), sign
        if code in self.operators:
            return self._operator(expression)
        if code == "negate":
            return "-" + self._operand(operands[0], _ATOM), _SIGNED
        if code == "not":
            # No operator over truth values binds as tightly, in either language.
            return self.negation + self._operand(operands[0], _ATOM), _ATOM
        if code == "real to boolean":
            return self._operator(Expression("not_equal", (operands[0], constant())))
        if code in _CHOSEN and not function:
            return self._choice(expression), _LOOSE
        if code.startswith("boolean to ") and not function:
            return self._written(expression.as_select)
        if function.endswith(")"):
            return function + self._operand(operands[0], _ATOM), _ATOM
        if function:
            texts = [self._operand(operand, _LOOSE) for operand in operands]
            if code == "select":
                # The function has the alternative of FALSE first.
                texts[1:] = texts[:0:-1]
            if formal := self.formal.get(code):
                texts = [f"{name} := {text}" for name, text in zip(formal, texts, strict=True)]
            return f"{function}({', '.join(texts)})", _ATOM
        expected = f"an operation that {self.language} can write"
        remedy = "write the law without this function"
        raise InputError(f"program, operation {code}", code, expected, remedy)

    def _constant(self, number: float, kind: Kind) -> str:
        if kind != "real":
            return self.truths[int(number)] if kind == "boolean" else f"{number:.0f}"
        if math.isinf(number) and self.infinity:
            return ("-" if number < 0 else "") + self.infinity
        if not math.isfinite(number):
            expected = f"a number that {self.language} can write"
            remedy = "write the law with finite numbers, for example 1e300 for no limit"
            raise InputError("program, constant", number, expected, remedy)
        return decimal(number, single=self.precision == "single") + self.suffix

    def _operator(self, expression: Expression) -> tuple[str, int]:
        code, (left, right) = expression.code, expression.operands
        strength, *least = _STRENGTHS.get(code, (_LOOSE, _SIGNED, _SIGNED))
        if code in LOGIC:
            # A chain of one operator needs no parentheses; a mixture gets them all.
            least = [_LOOSE if left.code == code else _ATOM, _ATOM]
        first, second = self._operand(left, least[0]), self._operand(right, least[1])
        return f"{first} {self.operators[code]} {second}", strength

    def _choice(self, expression: Expression) -> str:
        """Write a choice in the notation of C."""
        texts = [self._operand(operand, _SIGNED) for operand in expression.operands]
        condition = self._operand(expression.operands[0], _ATOM)
        return _CHOSEN[expression.operation].format(*texts, c=condition)

    def _operand(self, expression: Expression, least: int) -> str:
        text, strength = self._written(expression)
        return text if strength >= least else f"({text})"


def _at_hand(expression: Expression) -> bool:
    """Whether an expression costs next to nothing, and is defined whatever it reads."""
    if expression.is_atom or (expression.kind == "integer" and expression.code != "select"):
        return True
    defined = expression.code in _ARITHMETIC or expression.code in COMPARISONS | LOGIC
    defined = defined or (expression.code == "divide" and expression.operands[1].number != 0.0)
    return defined and all(operand.is_atom for operand in expression.operands)
