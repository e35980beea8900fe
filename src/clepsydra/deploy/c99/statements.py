"""How C99 writes operations and statements, and what it must hold to, in each precision."""

from __future__ import annotations

from typing import ClassVar

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import OPERATORS
from clepsydra.deploy.printing.listing import BlockCall, DeclaredArray
from clepsydra.deploy.printing.statements import Language
from clepsydra.deploy.printing.whole_numbers import INTEGER_LOW
from clepsydra.program.operation import LIBRARY
from clepsydra.program.precision import Precision

_FUNCTIONS = {
    "square_root": "sqrt", "absolute": "fabs", "floor": "floor", "ceiling": "ceil",
    **{name: name for name in LIBRARY},
}  # fmt: skip
REAL: dict[Precision, str] = {"double": "double", "single": "float"}


class C99(Language):
    """C99 in a precision.

    Parameters
    ----------
    name : str
        What the names of the blocks' types and functions begin with.
    precision : {"double", "single"}

    Examples
    --------
    >>> language = C99("law", "single")
    >>> language.types["real"], language.functions["square_root"], language.infinity
    ('float', 'sqrtf', 'HUGE_VALF')
    """

    language = "C"
    operators: ClassVar = {**OPERATORS, "equal": "==", "not_equal": "!=", "and": "&&", "or": "||"}
    negation = "!"
    chooses = True
    truths = ("false", "true")
    comment = "/* {} */"
    assignment = "{} = {};"
    opened = "if ({}) {{"
    another = "}} else if ({}) {{"
    otherwise = "} else {"
    closed = "}"
    repeated = "for (int32_t {0} = {1}; {0} < {3}; ++{0}) {{"
    repeated_end = "}"
    advanced = "{0} + 1 < {1} ? {0} + 1 : 0"
    states = "state->"

    def __init__(self, name: str, precision: Precision) -> None:
        self.name, self.precision, real = name, precision, REAL[precision]
        self.types = {"real": real, "integer": "int32_t", "boolean": "bool"}
        self.suffix = mark = "f" if precision == "single" else ""
        self.infinity = f"HUGE_VAL{mark.upper()}"
        self.functions = {code: f"{name}{mark}" for code, name in _FUNCTIONS.items()}
        self.functions |= {"integer to real": f"({real})", "real to integer": "(int32_t)"}

    def initial(self, signal: Signal) -> str:
        """Write the initial value of a signal in its type."""
        # The lowest 32-bit integer has no literal of its own in C.
        lowest = signal.kind == "integer" and signal.initial == INTEGER_LOW
        return "INT32_MIN" if lowest else super().initial(signal)

    def dimension(self, array: DeclaredArray) -> str:
        """Write what stands behind the name of an array in its declaration.

        Where nothing is known of it, it begins with zeros: compilers warn of what they cannot see
        to be assigned.

        >>> C99("law", "double").dimension(DeclaredArray(3, (0.5, 0.0, 0.0)))
        '[3] = {0.5, 0.0, 0.0}'
        """
        numbers = ", ".join(map(self.number, array.initial or (0.0,)))
        return f"[{array.length}] = {{{numbers}}}" if array.length else f" = {numbers}"

    def record(self, name: str) -> str:
        """Return what a structure is called, or what the names of a block begin with.

        With the name of the program: two of them may stand in one file, each with blocks of its
        own.
        """
        return f"{self.name}_{name}"

    def call(self, entry: BlockCall) -> list[str]:
        """Call an instance; its outputs are members of a variable that is called like it."""
        block, name = entry.program, self.record(entry.program.name)
        arguments = [f"&{self.states}{entry.kept}"] if block.state else []
        arguments += [self.expression(value) for _, value in entry.given()]
        lines = [f"{name}_outputs {entry.instance};"] if block.outputs else []
        arguments += [f"&{entry.instance}"] if block.outputs else []
        return [*lines, f"{name}_step({', '.join(arguments)});"]


def arithmetic_check(precision: Precision) -> list[str]:
    """Return what stops a compiler whose arithmetic is another one.

    Doubles may be evaluated in the type of a float's evaluation (FLT_EVAL_METHOD 1), floats may
    not; the methods 16, 32 and 64 name a smallest type of evaluation [bits].

    Examples
    --------
    >>> arithmetic_check("single")[0]
    '#if FLT_RADIX != 2 || FLT_MANT_DIG != 24 || FLT_MAX_EXP != 128'
    """
    if precision == "single":
        number, whole = "float", "FLT_MANT_DIG != 24 || FLT_MAX_EXP != 128"
        widened = "FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16 && FLT_EVAL_METHOD != 32"
    else:
        number, whole = "double", "DBL_MANT_DIG != 53 || DBL_MAX_EXP != 1024"
        widened = "FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD > 64"
    return [
        f"#if FLT_RADIX != 2 || {whole}",
        f'#error "{number} is another number than that of IEEE 754: results would differ"',
        "#endif",
        f"#if {widened}",
        f'#error "this compiler does not evaluate {number}s as {number}s: results would differ"',
        "#endif",
        # The parts of -ffast-math, one by one: __FAST_MATH__ stands for all of them only.
        "#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__ \\",
        "    || defined __RECIPROCAL_MATH__ || defined __NO_SIGNED_ZEROS__",
        '#error "compile without -ffast-math and its parts: results would differ"',
        "#elif defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0",
        '#error "compile without -ffinite-math-only: what is no number would pass unseen"',
        "#endif",
        # gcc disregards the pragma of the standard, and without -std=c99 fuses by default.
        "#if defined __GNUC__ && !defined __clang__",
        '#pragma GCC optimize ("fp-contract=off")',
        "#else",
        "#pragma STDC FP_CONTRACT OFF",
        "#endif",
        "",
    ]
