"""Whole numbers and truth values of a printed program as what they are, not as real numbers."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.printing.expressions import Expression
from clepsydra.deploy.printing.whole_numbers import WholeRange
from clepsydra.program.operation import COMPARISONS

_OF_INTEGERS = {"add", "subtract", "multiply", "negate", "absolute", "maximum", "minimum"}


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
    >>> from clepsydra.deploy.printing.expressions import constant, reading
    >>> scans, bounds = reading("integer", "scans"), [WholeRange(0, 9), WholeRange(1, 1)]
    >>> more = in_own_type("add", [scans, constant(1.0)], bounds, WholeRange(1, 10), (-99.0, 99.0))
    >>> more.operation, more.operands[0].code
    ('integer to real', 'add')
    """
    numbers = operands[1:] if code == "select" else operands
    parts = [each.known_as("integer") for each in numbers]
    if not any(p and e.code != "constant" for e, p in zip(numbers, parts, strict=True)):
        return None
    truths = [each.known_as("boolean") for each in numbers]
    if code == "select" and None not in truths:
        return _logical(operands[0], *filter(None, truths)).to("real")
    whole = tuple(filter(None, parts))
    if len(whole) != len(parts):
        return None
    if code in COMPARISONS:
        return Expression(code, whole)
    if code in ("floor", "ceiling"):
        return operands[0]
    if found is None or not found.within(*integers):
        return None
    if code == "select":
        return Expression("select", (operands[0], *whole)).to("real")
    if code not in _OF_INTEGERS or _may_be_negative_zero(code, bounds):
        return None
    if code in ("maximum", "minimum"):
        # STruC++ computes in the type of the first operand, and takes a literal for an INT.
        whole = tuple(sorted(whole, key=lambda each: each.code == "constant"))
    return Expression(code, whole).to("real")


def _may_be_negative_zero(code: str, bounds: Sequence[WholeRange | None]) -> bool:
    if code == "multiply":
        return any(bound is None or bound.low < 0.0 for bound in bounds)
    zero = (bound is None or bound.low <= 0.0 <= bound.high for bound in bounds)
    return code == "negate" and any(zero)


def _logical(condition: Expression, first: Expression, second: Expression) -> Expression:
    """Return a choice of truth values, as logic where one of them is known."""
    for place, value, other in ((1, first, second), (0, second, first)):
        if value.code == "constant":
            truth, opposite = bool(value.number), Expression("not", (condition,)).simplified()
            # Where the known one is FALSE the other one counts under the opposite condition.
            holds = condition if truth == bool(place) else opposite
            return Expression("or" if truth else "and", (holds, other)).simplified()
    return Expression("select", (condition, first, second))
