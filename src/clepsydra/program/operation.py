"""One operation of a step program, and which there are."""

from __future__ import annotations

from dataclasses import dataclass

#: Operations whose result is a truth value; their arguments are numbers.
COMPARISONS = frozenset({"less", "less_equal", "equal", "not_equal"})
#: Operations on truth values whose result is a truth value.
LOGIC = frozenset({"not", "and", "or"})
#: Operations that every target computes to the last bit.
EXACT = frozenset(
    {
        "add",
        "subtract",
        "multiply",
        "divide",
        "negate",
        "square_root",
        "absolute",
        "floor",
        "ceiling",
    }
    | {"minimum", "maximum", "select", "number", "truth", "constant"}
    | COMPARISONS
    | LOGIC
)
#: Functions of the target's mathematical library, with their number of arguments.
LIBRARY = {
    "exp": 1, "log": 1, "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1,
    "sinh": 1, "cosh": 1, "tanh": 1, "asinh": 1, "acosh": 1, "atanh": 1, "log1p": 1, "expm1": 1,
    "erf": 1, "pow": 2, "atan2": 2, "fmod": 2, "hypot": 2, "copysign": 2,
}  # fmt: skip


#: Rounds a number to the nearest one of single precision. No law has it, and no printer takes it:
#: the engine computes with it what a target computes that has REAL or float only.
TO_SINGLE = "to_single"


@dataclass(frozen=True)
class Operation:
    """One operation; its result is the value `target`.

    `code` is a member of `EXACT` or `LIBRARY`, or `TO_SINGLE`:

    - ``maximum(a, b)`` is ``a > b ? a : b``, ``minimum(a, b)`` is ``a < b ? a : b``;
    - ``select(c, a, b)`` is ``c ? a : b`` with a truth value c;
    - ``number(c)`` is ``c ? 1 : 0`` and ``truth(a)`` is ``a != 0``.
    """

    target: int
    code: str
    arguments: tuple[int, ...] = ()
    constant: float = 0.0
    fused: bool = False
