"""Expressions and numbers of Structured Text in a dialect and a precision."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.deploy.printing.expressions import (
    Expression,
    as_select,
    decimal,
    render,
    simplified,
    variable,
)
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.notation import notation_of
from clepsydra.program.program import COMPARISONS


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


# A variable is compared with a number, not the other way round.
_TURNED = {"less": "greater", "less_equal": "greater_equal"}
_TYPES = {"integer": "DINT", "boolean": "BOOL"}
#: The largest power of two that every system reads as a number, whatever the type.
_FACTOR_EXPONENT = 120
_NAME = re.compile(r"(?<![\w.#])[A-Za-z]\w*")


class Wording:
    """Writes expressions and numbers as a dialect and a precision want them.

    Parameters
    ----------
    dialect : Dialect
    precision : {"double", "single"}
        LREAL or REAL.
    names : Identifiers
        Where variables for numbers that the system cannot read get their names.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> half = Expression("multiply", (variable("x"), Expression("constant", number=0.1)))
    >>> for name, precision in (("codesys", "double"), ("codesys", "single")):
    ...     wording = Wording(dialect_of(name), precision, Identifiers([], ignore_case=True))
    ...     wording.real, wording.expression(half)
    ('LREAL', 'x * 0.1')
    ('REAL', 'x * REAL#0.1')
    """

    def __init__(self, dialect: Dialect, precision: Precision, names: Identifiers) -> None:
        self.dialect = dialect
        self.precision = precision
        self.notation = notation_of(dialect, precision)
        self.real = "LREAL" if precision == "double" else "REAL"
        #: Variable to a number that the system cannot read, and to the factors of the product
        #: that it is assigned at the start of a scan.
        self.products: dict[str, tuple[float, list[str]]] = {}
        self._names = names
        self._typed = precision in dialect.typed_numbers

    def type_of(self, kind: str) -> str:
        """Return the type that a kind of signal is declared with."""
        return _TYPES.get(kind, self.real)

    def expression(self, expression: Expression) -> str:
        """Write an expression.

        Raises
        ------
        InputError
            The system has no such function, or a number is not finite.
        """
        return render(self._worded(expression), self.notation)

    def number(self, value: float, place: str = "a number") -> str:
        """Write a number of a declaration, where it needs no type.

        Raises
        ------
        InputError
            It is not finite, or the system cannot read it.
        """
        if self._readable(value) or not math.isfinite(value):
            return render(Expression("constant", number=value), self.notation)
        low, high = self.dialect.literals or (0.0, math.inf)
        raise InputError(
            place, value,
            f"0 or a magnitude from {low:.8g} to {high:.8g}, which {self.dialect.systems} can read",
            "give a number within that range, or print in another dialect",
        )  # fmt: skip

    def literal(self, value: float) -> str:
        """Write a number of a statement, with its type where the dialect needs it."""
        return self.expression(Expression("constant", number=value))

    def marked(self, line: str, local: Collection[str]) -> str:
        """Put the dialect's mark before every local name (in lower case) of a line.

        >>> from clepsydra.deploy.structured_text.dialect import dialect_of
        >>> wording = Wording(dialect_of("scl"), "single", Identifiers([], ignore_case=True))
        >>> wording.marked("  y := REAL#1.5E3 * tank.level;", {"y", "tank", "level"})
        '  #y := REAL#1.5E3 * #tank.level;'
        """
        mark = self.dialect.local_mark
        if not mark or line.lstrip().startswith("//"):
            return line

        def written(found: re.Match[str]) -> str:
            name, before, after = found[0], line[: found.start()], line[found.end() :]
            # In a call that is the name of the block's own input.
            given = after.startswith(" :=") and before.endswith(("(", ", "))
            return mark + name if name.lower() in local and not given else name

        return _NAME.sub(written, line)

    def _readable(self, value: float) -> bool:
        bounds = self.dialect.literals
        return bounds is None or value == 0.0 or bounds[0] <= abs(value) <= bounds[1]

    def _worded(self, expression: Expression, *, compared: bool = False) -> Expression:
        code = expression.code
        if code == "constant":
            return self._constant(expression)
        if code == "truth":
            zero = Expression("constant")
            return self._worded(Expression("not_equal", (expression.operands[0], zero)))
        if code == "number":
            return self._worded(as_select(expression))
        if code == "select" and expression.is_truth:
            expression = _logical(expression)
            code = expression.code
        inside = code in COMPARISONS
        operands = tuple(self._worded(part, compared=inside) for part in expression.operands)
        if code == "absolute" and not compared and not self.dialect.absolute_zero:
            # The sum of the two zeros is the positive one.
            positive = replace(expression, operands=operands)
            return Expression("add", (positive, self._constant(Expression("constant"))))
        if code == "pow" and self.dialect.power:
            base, exponent = (self._atom(operand) for operand in operands)
            return variable(f"({base} {self.dialect.power} {exponent})")
        if code == "not" and operands[0].code in ("equal", "not_equal"):
            other = "equal" if operands[0].code == "not_equal" else "not_equal"
            return replace(operands[0], code=other)
        if code in _TURNED and expression.operands[0].code in ("constant", "whole"):
            return Expression(_TURNED[code], operands[::-1])
        return replace(expression, operands=operands)

    def _atom(self, operand: Expression) -> str:
        text = render(operand, self.notation)
        return text if operand.is_atom and not text.startswith("-") else f"({text})"

    def _constant(self, expression: Expression) -> Expression:
        number = expression.number
        if not math.isfinite(number):
            return expression
        if self._typed:
            single = self.precision == "single"
            return variable(f"{self.real}#{decimal(number, single=single)}")
        return expression if self._readable(number) else variable(self._product(number))

    def _product(self, number: float) -> str:
        """Return the variable that holds a number as a product of numbers that can be read.

        Every factor but the first is a power of two, so the product is exact.
        """
        for name, (known, _) in self.products.items():
            if known == number:
                return name
        fraction, exponent = math.frexp(number)
        step = math.copysign(_FACTOR_EXPONENT, exponent)
        factors = [decimal(fraction)]
        while exponent:
            part = step if abs(exponent) > abs(step) else exponent
            factors.append(decimal(2.0**part))
            exponent -= int(part)
        name = self._names.new("large_number" if abs(number) > 1.0 else "small_number")
        self.products[name] = number, factors
        return name
