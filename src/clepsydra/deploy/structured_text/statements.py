"""How Structured Text writes IF, FOR, calls and numbers, in a dialect and a precision."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Sequence
from typing import ClassVar

from clepsydra.base.errors import InputError
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.expressions import OPERATORS, Expression, constant, variable
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.listing import BlockCall, Repeated
from clepsydra.deploy.printing.statements import Language
from clepsydra.deploy.structured_text.dialect import OWN, Dialect
from clepsydra.program.operation import COMPARISONS
from clepsydra.program.precision import Precision

#: The largest power of two that every system reads as a number, whatever the type.
_FACTOR_EXPONENT = 120
_NAME = re.compile(r"(?<![\w.#])[A-Za-z]\w*")


_ABBREVIATIONS = frozenset({"lq", "pd", "pi", "pid"})
REAL: dict[Precision, str] = {"double": "LREAL", "single": "REAL"}
#: Functions of integers and truth values.
_TYPED = {
    "select": "SEL",
    "boolean to integer": "BOOL_TO_DINT",
    "integer maximum": "MAX",
    "integer minimum": "MIN",
    "integer absolute": "ABS",
}


def joined(name: str) -> str:
    """Return the words of a name as one, each with a capital.

    Examples
    --------
    >>> joined("pi_loop")
    'PILoop'
    """
    words = name.split("_")
    return "".join(w.upper() if w in _ABBREVIATIONS else w.capitalize() for w in words)


class StructuredText(Language):
    """Writes expressions and numbers as a dialect and a precision want them.

    Parameters
    ----------
    dialect : Dialect
    precision : {"double", "single"}
        LREAL or REAL.
    taken : iterable of str
        Names of the scope of the statements, beside the words of the system.

    Examples
    --------
    >>> from clepsydra.deploy.structured_text.dialect import dialect_of
    >>> half = Expression("multiply", (variable("x"), constant(0.1)))
    >>> for name, precision in (("codesys", "double"), ("codesys", "single")):
    ...     wording = StructuredText(dialect_of(name), precision)
    ...     wording.real, wording.expression(half)
    ('LREAL', 'x * 0.1')
    ('REAL', 'x * REAL#0.1')
    """

    language = "Structured Text"
    operators: ClassVar = {**OPERATORS, "equal": "=", "not_equal": "<>", "and": "AND", "or": "OR"}
    negation = "NOT "
    computes = True
    comment = "(* {} *)"
    assignment = "{} := {};"
    opened = "IF {} THEN"
    another = "ELSIF {} THEN"
    otherwise = "ELSE"
    closed = "END_IF;"
    repeated = "FOR {} := {} TO {} DO"
    repeated_end = "END_FOR;"
    advanced = "({0} + 1) MOD {1}"
    told = "{} => {}"

    def __init__(self, dialect: Dialect, precision: Precision, taken: Iterable[str] = ()) -> None:
        self.dialect, self.precision, self.formal = dialect, precision, dialect.formal
        self.real = real = REAL[precision]
        self.types = {"real": real, "integer": "DINT", "boolean": "BOOL"}
        self.functions = {
            **dialect.functions,
            **_TYPED,
            **{code: dialect.quoted(name) for code, name in OWN.items()},
            "integer to real": f"DINT_TO_{real}",
            "real to integer": f"{real}_TO_DINT",
        }
        if dialect.power:
            # It is written as an operator, see `worded`; here it counts for its width.
            self.functions["pow"] = "EXPT"
        if dialect.line_comments:
            self.comment = "// {}"
        #: Variable to a number that the system cannot read, and to the factors of the product
        #: that it is assigned at the start of a scan.
        self.products: dict[str, tuple[float, list[str]]] = {}
        #: The scope, where a number that the system cannot read gets a variable.
        self.names = Identifiers([*taken, *dialect.all_words], ignore_case=True)

    def record(self, name: str) -> str:
        """Return what the type of a structure is called."""
        return f"ST_{joined(name)}"

    def call(self, entry: BlockCall) -> list[str]:
        """Write the call of an instance.

        An input that is a constant stays what it is declared with where it is that.
        """
        given = []
        for signal, value in entry.given():
            declared = constant(signal.initial).to(signal.kind)
            # By their texts: equal numbers may be zeros of different sign.
            if repr(value) == repr(declared):
                continue
            text = self.expression(value)
            text = f"({text})" if value.code in COMPARISONS else text
            given.append(f"{signal.identifier} := {text}")
        given += [self.told.format(*each) for each in entry.told]
        return [f"{entry.instance}({', '.join(given)});"]

    def loop(self, entry: Repeated, body: Sequence[str]) -> list[str]:
        """Write a loop over arrays; with WHILE where a FOR might leave out its only turn."""
        if self.dialect.one_turn or not entry.once:
            return super().loop(entry, body)
        index = entry.index
        return [
            f"{index} := {entry.first};",
            f"WHILE {index} <= {entry.last} DO",
            *indented([*body, f"{index} := {index} + 1;"]),
            "END_WHILE;",
        ]

    def number(self, value: float, place: str = "a number") -> str:
        """Write a number of a declaration, where it needs no type.

        Raises
        ------
        InputError
            It is not finite, or the system cannot read it.
        """
        if self.readable(value) or not math.isfinite(value):
            return super().number(value)
        low, high = self.dialect.literals or (0.0, math.inf)
        raise InputError(
            place, value,
            f"0 or a magnitude from {low:.8g} to {high:.8g}, which {self.dialect.systems} can read",
            "give a number within that range, or print in another dialect",
        )  # fmt: skip

    def literal(self, value: float) -> str:
        """Write a number of a statement, with its type where the dialect needs it."""
        return self.expression(constant(value))

    def marked(self, line: str, local: Collection[str]) -> str:
        """Put the dialect's mark before every local name (in lower case) of a line.

        >>> from clepsydra.deploy.structured_text.dialect import dialect_of
        >>> wording = StructuredText(dialect_of("scl"), "single")
        >>> wording.marked("  y := REAL#1.5E3 * tank.level;", {"y", "tank", "level"})
        '  #y := REAL#1.5E3 * #tank.level;'
        """
        mark = self.dialect.local_mark
        if not mark or line.lstrip().startswith("//"):
            return line

        def written(found: re.Match[str]) -> str:
            name, before, after = found[0], line[: found.start()], line[found.end() :]
            # In a call that is the name of the block's own port.
            given = after.startswith((" :=", " =>")) and before.endswith(("(", ", "))
            return mark + name if name.lower() in local and not given else name

        return _NAME.sub(written, line)

    def readable(self, number: float) -> bool:
        """Whether the system can read a number at all."""
        bounds = self.dialect.literals
        return bounds is None or number == 0.0 or bounds[0] <= abs(number) <= bounds[1]

    def worded(self, expression: Expression, *, compared: bool = False) -> Expression:
        """Return an expression as the dialect writes it."""
        found = super().worded(expression, compared=compared)
        if found.code == "constant" and found.kind == "real":
            return self._typed(found)
        if expression.operation == "absolute" and not compared and not self.dialect.absolute_zero:
            # The sum of the two zeros is the positive one.
            return Expression("add", (found, self._typed(constant())))
        if expression.code == "pow" and self.dialect.power:
            base, exponent = map(self._atom, found.operands)
            return variable(f"({base} {self.dialect.power} {exponent})")
        return found

    def _atom(self, operand: Expression) -> str:
        text = self.render(operand)
        return text if operand.is_atom and not text.startswith("-") else f"({text})"

    def _typed(self, expression: Expression) -> Expression:
        number = expression.number
        if not math.isfinite(number):
            return expression
        if self.precision in self.dialect.typed_numbers:
            single = self.precision == "single"
            return variable(f"{self.real}#{decimal(number, single=single)}")
        return expression if self.readable(number) else variable(self._product(number))

    def _product(self, number: float) -> str:
        """Return the variable that holds a number as a product of numbers that can be read.

        Every factor but the first is a power of two, so the product is exact.
        """
        name = next((n for n, (known, _) in self.products.items() if known == number), "")
        if not name:
            fraction, exponent = math.frexp(number)
            full, rest = divmod(abs(exponent), _FACTOR_EXPONENT)
            powers = [_FACTOR_EXPONENT] * full + [rest] * (rest > 0)
            factors = [decimal(2.0 ** math.copysign(power, exponent)) for power in powers]
            name = self.names.new("large_number" if abs(number) > 1.0 else "small_number")
            self.products[name] = number, [decimal(fraction), *factors]
        return name
