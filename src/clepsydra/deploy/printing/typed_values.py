"""Whole numbers and truth values of a printed program as what they are, not as real numbers.

For languages whose notation says how an integer becomes a number ("real").
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from clepsydra.deploy.printing.expressions import Expression, flag
from clepsydra.deploy.printing.whole_numbers import INTEGER_HIGH, INTEGER_LOW, WholeRange
from clepsydra.program.program import COMPARISONS

_SAME = {"add": "add", "subtract": "subtract", "multiply": "multiply", "negate": "negate",
         "absolute": "magnitude", "maximum": "greatest", "minimum": "least"}  # fmt: skip
#: Comparison of a whole number n with what was rounded up, and the other way round: with which
#: comparison of the unrounded value, and what is added to n.
_ROUNDED = {
    ("less", "ceiling", 1): ("less", 0),  # n < ceil(x) is n < x
    ("less_equal", "ceiling", 1): ("less", -1),  # n <= ceil(x) is n - 1 < x
    ("less", "floor", 1): ("less_equal", 1),  # n < floor(x) is n + 1 <= x
    ("less_equal", "floor", 1): ("less_equal", 0),
    ("less", "ceiling", 0): ("less_equal", -1),  # ceil(x) < n is x <= n - 1
    ("less_equal", "ceiling", 0): ("less_equal", 0),
    ("less", "floor", 0): ("less", 0),
    ("less_equal", "floor", 0): ("less", 1),  # floor(x) <= n is x < n + 1
}


def whole_form(number: Expression) -> Expression | None:
    """Return a number as an integer; None where it is none.

    Examples
    --------
    >>> three, half = (Expression("constant", number=value) for value in (3.0, 0.5))
    >>> whole_form(three).code, whole_form(half)
    ('whole', None)
    """
    if number.code == "real":
        return number.operands[0]
    if number.code == "number":
        return Expression("count", number.operands)
    if number.code == "constant":
        value = number.number
        whole = math.isfinite(value) and value == math.floor(value)
        # An integer has no negative zero.
        exact = whole and INTEGER_LOW < value <= INTEGER_HIGH and str(value) != "-0.0"
        return Expression("whole", number=value) if exact else None
    if number.code == "select":
        first, second = map(whole_form, number.operands[1:])
        if first is not None and second is not None:
            return Expression("select", (number.operands[0], first, second))
    return None


def truth_form(number: Expression) -> Expression | None:
    """Return a number that is 0 or 1 as a truth value; None where it is no such number.

    Examples
    --------
    >>> truth_form(Expression("constant", number=1.0)).text
    'TRUE'
    """
    if number.code == "number":
        return number.operands[0]
    if number.code == "constant" and number.number in (0.0, 1.0):
        return flag("TRUE" if number.number else "FALSE")
    return None


def in_own_type(
    code: str,
    operands: Sequence[Expression],
    bounds: Sequence[WholeRange | None],
    found: WholeRange | None,
    integers: tuple[float, float],
) -> Expression | None:
    """Return an operation on whole numbers or truth values in their type; None for any other.

    Parameters
    ----------
    code : str
    operands : sequence of Expression
    bounds : sequence of WholeRange or None
        Of each operand.
    found : WholeRange or None
        Of the result.
    integers : (float, float)
        The least and the largest integer.

    Examples
    --------
    >>> scans = Expression("real", (Expression("integer", text="scans"),))
    >>> one, bounds = Expression("constant", number=1.0), [WholeRange(0, 9), WholeRange(1, 1)]
    >>> more = in_own_type("add", [scans, one], bounds, WholeRange(1, 10), (-99.0, 99.0))
    >>> more.code, more.operands[0].code
    ('real', 'add')
    """
    if code == "floor" and operands[0].code == "divide":
        number, divisor = operands[0].operands
        return _quotient(number, divisor, found, integers)
    numbers = operands[1:] if code == "select" else operands
    if all(each.code == "constant" or whole_form(each) is None for each in numbers):
        return None
    truths = [truth_form(each) for each in numbers]
    if code == "select" and None not in truths:
        return Expression("number", (Expression("select", (operands[0], *filter(None, truths))),))
    parts = [whole_form(each) for each in numbers]
    whole = tuple(part for part in parts if part is not None)
    if len(whole) != len(parts):
        return _compared(code, operands, bounds, integers) if code in COMPARISONS else None
    if code in COMPARISONS:
        return Expression(code, whole)
    if code in ("floor", "ceiling"):
        return operands[0]
    if found is None or not found.within(*integers):
        return None
    if code == "select":
        return Expression("real", (Expression("select", (operands[0], *whole)),))
    if code not in _SAME or _may_be_negative_zero(code, bounds):
        return None
    return Expression("real", (_limited(Expression(_SAME[code], whole)),))


def _quotient(
    number: Expression,
    divisor: Expression,
    found: WholeRange | None,
    integers: tuple[float, float],
) -> Expression | None:
    """Return a whole number, not negative, divided by a power of two and rounded down."""
    first, second = whole_form(number), whole_form(divisor)
    if first is None or second is None or second.code != "whole" or found is None:
        return None
    exact = second.number >= 1.0 and math.frexp(second.number)[0] == 0.5
    # The number itself has to be an integer too.
    if exact and found.low >= 0.0 and (found.high + 1.0) * second.number <= integers[1] + 1.0:
        return Expression("real", (Expression("quotient", (first, second)),))
    return None


def _may_be_negative_zero(code: str, bounds: Sequence[WholeRange | None]) -> bool:
    if code == "multiply":
        return any(bound is None or bound.low < 0.0 for bound in bounds)
    if code == "negate":
        return any(bound is None or bound.low <= 0.0 <= bound.high for bound in bounds)
    return False


def _limited(integer: Expression) -> Expression:
    """Return what is limited on both sides as one operation."""
    other = {"greatest": "least", "least": "greatest"}.get(integer.code)
    for inner, bound in (integer.operands, integer.operands[::-1]) if other else ():
        if bound.code != "whole" or inner.code != other:
            continue
        for value, first in (inner.operands, inner.operands[::-1]):
            low, high = (bound, first) if other == "least" else (first, bound)
            if first.code == "whole" and low.number <= high.number:
                return Expression("limit", (low, value, high))
    return integer


def _compared(
    code: str,
    operands: Sequence[Expression],
    bounds: Sequence[WholeRange | None],
    integers: tuple[float, float],
) -> Expression | None:
    """Return the comparison of an integer with what is rounded, without the rounding."""
    for place, other in ((1, 0), (0, 1)):
        rounded, integer, bound = operands[place], whole_form(operands[other]), bounds[other]
        rule = _ROUNDED.get((code, rounded.code, place))
        if rule is None or integer is None or bound is None:
            continue
        compared, more = rule
        if not bound.within(integers[0] + 1.0, integers[1] - 1.0):
            continue
        if more:
            step = Expression("whole", number=1.0)
            integer = Expression("add" if more > 0 else "subtract", (integer, step))
        sides = [rounded.operands[0], rounded.operands[0]]
        sides[other] = Expression("real", (integer,))
        return Expression(compared, tuple(sides))
    return None


def of_kind(kind: str, number: Expression) -> Expression:
    """Return a number in the type of a signal; that it fits has been proved.

    Examples
    --------
    >>> of_kind("boolean", Expression("number", (Expression("flag", text="good"),))).text
    'good'
    """
    if kind == "boolean":
        return truth_form(number) or Expression("truth", (number,))
    if kind == "integer":
        return whole_form(number) or Expression("rounded", (number,))
    return number
