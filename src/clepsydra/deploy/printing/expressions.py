"""Expressions of a printed program, and how one is written so that its tree survives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Kind
from clepsydra.program.program import COMPARISONS, LOGIC

# How tightly a written expression holds together; an operand that is looser than its place
# demands is put in parentheses.
_LOOSE, _SIGNED, _SUM, _PRODUCT, _ATOM = range(5)
#: How tightly an operation holds together, and its operands have to; others compare.
_STRENGTHS = dict.fromkeys(("multiply", "divide", "quotient"), (_PRODUCT, _PRODUCT, _ATOM))
_STRENGTHS |= dict.fromkeys(("add", "subtract"), (_SUM, _SUM, _PRODUCT))
_LARGER, _SMALLER = "{0} > {1} ? {0} : {1}", "{0} < {1} ? {0} : {1}"
#: What a language without a function for it writes as a choice.
_CHOSEN = {
    "select": "{c} ? {1} : {2}",
    "number": "{c} ? {one} : {zero}",
    "count": "{c} ? 1 : 0",
    "magnitude": "{0} < 0 ? -{0} : {0}",
    **dict.fromkeys(("maximum", "greatest"), _LARGER),
    **dict.fromkeys(("minimum", "least"), _SMALLER),
}
# Integers: read, constant, counted from a truth value, rounded; the others have whole operands.
_INTEGERS = frozenset(
    {"integer", "whole", "count", "rounded", "quotient", "greatest", "least", "limit", "magnitude"}
)
_ARITHMETIC = frozenset({"add", "subtract", "multiply", "negate", "absolute"})


@dataclass(frozen=True)
class Expression:
    """A tree of operations over variables and constants.

    Parameters
    ----------
    code : str
        An operation code of `clepsydra.program.program`, or "variable" (a number), "flag"
        (a truth value) or "constant". Where a language has integers also "integer" (a variable),
        "whole" (a constant), "count" (1 of a truth value that holds, else 0), "rounded" (of a
        whole number), "quotient" (the rest is dropped), "greatest", "least" and "limit" (from,
        value, to) of integers, and "real" (the number that an integer is).
    operands : tuple of Expression
    text : str
        What is written for a variable or a flag.
    number : float
        The value of a constant.

    Examples
    --------
    >>> less = Expression("less", (variable("level"), Expression("constant", number=0.2)))
    >>> less.is_truth, less.is_atom
    (True, False)
    """

    code: str
    operands: tuple[Expression, ...] = ()
    text: str = ""
    number: float = 0.0

    @property
    def is_atom(self) -> bool:
        """Whether it can be written twice without being computed twice."""
        if self.code == "real":
            return self.operands[0].is_atom
        return self.code in ("variable", "flag", "constant", "integer", "whole")

    @property
    def is_truth(self) -> bool:
        """Whether it is a truth value."""
        if self.code == "select":
            return self.operands[1].is_truth
        return self.code in ("flag", "truth") or self.code in COMPARISONS or self.code in LOGIC

    @property
    def is_whole(self) -> bool:
        """Whether it is an integer."""
        if self.code == "select":
            return self.operands[1].is_whole
        return self.code in _INTEGERS or (self.code in _ARITHMETIC and self.operands[0].is_whole)

    @property
    def is_choice(self) -> bool:
        """Whether it is one of two values."""
        return self.code in ("select", "number")


def variable(text: str) -> Expression:
    """Return the expression that reads a number.

    Examples
    --------
    >>> variable("level").code
    'variable'
    """
    return Expression("variable", text=text)


def flag(text: str) -> Expression:
    """Return the expression that reads a truth value.

    Examples
    --------
    >>> flag("in_automatic").is_truth
    True
    """
    return Expression("flag", text=text)


def reading(kind: Kind, text: str) -> Expression:
    """Return the expression that reads a variable of a type, as a number.

    Examples
    --------
    >>> reading("boolean", "good").code, reading("real", "level").code
    ('number', 'variable')
    """
    if kind == "boolean":
        return Expression("number", (flag(text),))
    if kind == "integer":
        return Expression("real", (Expression("integer", text=text),))
    return variable(text)


def as_select(choice: Expression) -> Expression:
    """Return a truth value's number as what it selects; any other expression as it is.

    Examples
    --------
    >>> as_select(Expression("number", (flag("late"),))).code
    'select'
    """
    if choice.code != "number":
        return choice
    one, zero = Expression("constant", number=1.0), Expression("constant")
    return Expression("select", (choice.operands[0], one, zero))


#: A number with as many zeros at its end is written with an exponent.
_ZEROS = 6
_OPPOSITE = {"and": "or", "or": "and"}


def simplified(condition: Expression) -> Expression:
    """Return a condition without NOT of a bracketed AND or OR, and with no part said twice.

    Some compilers of Structured Text take NOT of a bracket for a function, which has no truth
    value of two comparisons to work on. Any other expression is returned as it is.

    Parameters
    ----------
    condition : Expression
        Its operands are simplified already.

    Examples
    --------
    >>> a, b = flag("a"), flag("b")
    >>> both = Expression("and", (a, b))
    >>> signs = Notation("signs", {"and": "&", "or": "|"}, {}, "!", frozenset(), frozenset())
    >>> [render(simplified(Expression(*parts)), signs) for parts in (
    ...     ("not", (both,)), ("and", (both, a)), ("and", (b, both)))]
    ['!a | !b', 'a & b', 'b & a']
    """
    code, operands = condition.code, condition.operands
    if code == "not" and operands[0].code == "not":
        return operands[0].operands[0]
    if code == "not" and operands[0].code in _OPPOSITE:
        negated = tuple(simplified(Expression("not", (each,))) for each in operands[0].operands)
        return simplified(Expression(_OPPOSITE[operands[0].code], negated))
    if code not in _OPPOSITE:
        return condition
    # By their texts: equal numbers may be zeros of different sign.
    first, *rest = {repr(part): part for part in _chain(condition, code)}.values()
    for part in rest:
        first = Expression(code, (first, part))
    return first


def _chain(condition: Expression, code: str) -> Iterator[Expression]:
    """Yield the parts of a chain of AND or of OR, in order."""
    if condition.code != code:
        yield condition
        return
    for operand in condition.operands:
        yield from _chain(operand, code)


#: Signs that all languages share.
OPERATORS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "quotient": "/"}
OPERATORS |= {"less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">="}


@dataclass(frozen=True)
class Notation:
    """How a language writes operations.

    Parameters
    ----------
    language : str
        What the reader calls it.
    operators : mapping
        Code of a binary operation to its sign.
    functions : mapping
        Code of an operation to the name of the function that computes it, or to a type in
        parentheses.
    negation : str
        The sign before a negated truth value.
    statements : frozenset of str
        Operations that this language writes as statements, not as expressions.
    repeating : frozenset of str
        Operations whose text holds an operand more than once.
    infinity : str
        The text of infinity; empty where the language has none.
    single : bool
        Whether numbers are single-precision ones.
    suffix : str
        What stands behind a number to give it its type.
    width : int
        A folded expression grows no wider than this: two lines at the most [characters].
    formal : mapping
        Code of an operation to the names of its function's parameters, where they are written.

    Examples
    --------
    >>> signs = Notation("signs", {"less": "<"}, {}, "!", frozenset(), frozenset())
    >>> render(Expression("not", (Expression("less", (variable("a"), variable("b"))),)), signs)
    '!(a < b)'
    """

    language: str
    operators: Mapping[str, str]
    functions: Mapping[str, str]
    negation: str
    statements: frozenset[str]
    repeating: frozenset[str]
    infinity: str = ""
    single: bool = False
    suffix: str = ""
    width: int = 150
    formal: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def writes(self, expression: Expression) -> bool:
        """Whether an expression can be part of another one.

        A function that selects evaluates both alternatives, so these have to be at hand.
        """
        if expression.code in ("real", "rounded", "number"):
            return expression.code == "number" or self.writes(expression.operands[0])
        if expression.code not in self.statements:
            return True
        if "select" not in self.functions or not expression.is_choice:
            return False
        at_hand = expression.operands[1:] if expression.code == "select" else expression.operands
        return all(map(_at_hand, at_hand))


def decimal(value: float, *, single: bool = False) -> str:
    """Write a finite number so that C and Structured Text read back the same number.

    The shortest decimal that rounds to the double, or to the single-precision number, always
    with a point, the exponent behind a capital E without a plus sign. A compiler may read a
    single-precision number as a double first: the text survives both roundings.

    Examples
    --------
    >>> [decimal(value) for value in (1e300, 0.1, -0.0, 5e-324, 1e22, 3.0)]
    ['1.0E300', '0.1', '-0.0', '5.0E-324', '1.0E22', '3.0']
    >>> decimal(0.10000000149011612, single=True), decimal(1e9), decimal(-1200000.0)
    ('0.1', '1.0E9', '-1200000.0')
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} has no decimal form")
    text = repr(float(value))
    if single:
        shortest = str(np.float32(value))
        text = shortest if np.float32(float(shortest)) == value else text
    mantissa, _, exponent = text.partition("e")
    whole = mantissa.removesuffix(".0")
    digits = whole.rstrip("0")
    if not exponent and len(whole) - len(digits) >= _ZEROS and whole != mantissa:
        point = 2 if digits.startswith("-") else 1
        exponent = str(len(whole) - point)
        mantissa = f"{digits[:point]}.{digits[point:] or '0'}"
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def _at_hand(expression: Expression) -> bool:
    """Whether an expression costs next to nothing, and is defined whatever it reads."""
    if expression.is_atom or (expression.is_whole and not expression.is_choice):
        return True
    defined = expression.code in _ARITHMETIC or expression.code in COMPARISONS | LOGIC
    return defined and all(operand.is_atom for operand in expression.operands)


def render(expression: Expression, notation: Notation) -> str:
    """Write an expression in a language, with the parentheses that keep its tree.

    Raises
    ------
    InputError
        The language has no such function or constant.

    Examples
    --------
    >>> signs = Notation("signs", {"add": "+", "multiply": "*"}, {}, "!", frozenset(), frozenset())
    >>> a, b = variable("a"), variable("b")
    >>> right = Expression("add", (a, Expression("add", (a, b))))
    >>> render(Expression("multiply", (right, b)), signs)
    '(a + (a + b)) * b'
    """
    return _written(expression, notation)[0]


def _written(expression: Expression, notation: Notation) -> tuple[str, int]:
    code, operands = expression.code, expression.operands
    function = notation.functions.get(code, "")
    if code in ("variable", "flag", "integer"):
        return expression.text, _ATOM
    if code == "whole":
        return f"{expression.number:.0f}", _SIGNED if expression.number < 0 else _ATOM
    if code == "constant":
        sign = _SIGNED if math.copysign(1.0, expression.number) < 0 else _ATOM
        return _constant(expression.number, notation), sign
    if code in notation.operators:
        return _operator(expression, notation)
    if code == "negate":
        return "-" + _operand(operands[0], notation, _ATOM), _SIGNED
    if code == "not":
        # No operator over truth values binds as tightly, in either language.
        return notation.negation + _operand(operands[0], notation, _ATOM), _ATOM
    if code == "truth":
        return _operator(Expression("not_equal", (operands[0], Expression("constant"))), notation)
    as_function = code in notation.statements if expression.is_choice else function
    if code in _CHOSEN and not as_function:
        return _choice(expression, notation), _LOOSE
    if code == "number":
        return _written(as_select(expression), notation)
    if function.endswith(")"):
        return function + _operand(operands[0], notation, _ATOM), _ATOM
    if function:
        texts = [_operand(operand, notation, _LOOSE) for operand in operands]
        if code == "select":
            # The function has the alternative of FALSE first.
            texts[1:] = texts[:0:-1]
        if formal := notation.formal.get(code):
            texts = [f"{name} := {text}" for name, text in zip(formal, texts, strict=True)]
        return f"{function}({', '.join(texts)})", _ATOM
    raise InputError(
        f"program, operation {code}",
        code,
        f"an operation that {notation.language} can write",
        "write the law without this function",
    )


def _constant(number: float, notation: Notation) -> str:
    if math.isinf(number) and notation.infinity:
        return ("-" if number < 0 else "") + notation.infinity
    if not math.isfinite(number):
        raise InputError(
            "program, constant",
            number,
            f"a number that {notation.language} can write",
            "write the law with finite numbers, for example 1e300 for no limit",
        )
    return decimal(number, single=notation.single) + notation.suffix


def _operator(expression: Expression, notation: Notation) -> tuple[str, int]:
    code, (left, right) = expression.code, expression.operands
    strength, *least = _STRENGTHS.get(code, (_LOOSE, _SIGNED, _SIGNED))
    if code in LOGIC:
        # A chain of one operator needs no parentheses; a mixture gets them all.
        least = [_LOOSE if left.code == code else _ATOM, _ATOM]
    first, second = _operand(left, notation, least[0]), _operand(right, notation, least[1])
    return f"{first} {notation.operators[code]} {second}", strength


def _choice(expression: Expression, notation: Notation) -> str:
    """Write a choice in the notation of C."""
    texts = [_operand(operand, notation, _SIGNED) for operand in expression.operands]
    condition = _operand(expression.operands[0], notation, _ATOM)
    one, zero = (_constant(value, notation) for value in (1.0, 0.0))
    return _CHOSEN[expression.code].format(*texts, c=condition, one=one, zero=zero)


def _operand(expression: Expression, notation: Notation, least: int) -> str:
    text, strength = _written(expression, notation)
    return text if strength >= least else f"({text})"
