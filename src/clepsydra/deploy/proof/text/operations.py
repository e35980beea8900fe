"""What operators and standard functions of Structured Text compute, type by type."""

from __future__ import annotations

import ctypes
import math
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np

from clepsydra.deploy.proof.text.tree import StructuredTextError
from clepsydra.deploy.proof.text.values import in_range


def quotient(a: float, b: float) -> float:
    """Divide doubles as IEEE 754 does, by zero too.

    Examples
    --------
    >>> quotient(1.0, -0.0), quotient(-3.0, 0.0), quotient(0.0, 0.0)
    (-inf, -inf, nan)
    """
    if b != 0.0:
        return a / b
    if a == 0.0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, math.copysign(1.0, a) * math.copysign(1.0, b))


def square_root(a: float) -> float:
    """Return the square root as IEEE 754 does, not a number below zero."""
    return math.sqrt(a) if a >= 0.0 else math.nan


def whole_quotient(a: int, b: int) -> int:
    """Divide integers and cut off towards zero."""
    if b == 0:
        raise StructuredTextError("a DINT divided by 0")
    return in_range(abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1))


def remainder(a: int, b: int) -> int:
    """Return the rest of a division that is cut off towards zero."""
    if b == 0:
        raise StructuredTextError("MOD 0")
    return int(math.fmod(a, b))


def agreed_turns(first: int, last: int) -> range:
    """Return the turns of a FOR, of which some systems leave out a single one.

    Examples
    --------
    >>> agreed_turns(2, 4), len(agreed_turns(2, 1))
    (range(2, 5), 0)
    """
    if first == last:
        raise StructuredTextError(f"a FOR from {first} to {last}, which not every system takes")
    return range(first, last + 1)


def truncated(value: Any) -> int:
    """Return a number cut off to a DINT."""
    return in_range(math.trunc(_finite(value)))


def rounded(value: Any) -> int:
    """Return a number rounded to a DINT, halves to the even one."""
    return in_range(round(_finite(value)))


def _finite(value: Any) -> float:
    if not math.isfinite(value):
        raise StructuredTextError(f"{value} to DINT")
    return float(value)


def rounding() -> Callable[[float], float]:
    """Return a function that rounds a double to the nearest single-precision number.

    A number of single precision is kept as the double that has its value. Sum, difference,
    product, quotient and square root are computed in double and rounded once more, which is the
    number that one rounding of the exact result gives, since 53 binary digits are at least twice
    24 and two more (S. A. Figueroa, ACM SIGNUM Newsletter 30(3), 1995,
    doi 10.1145/221332.221334). That holds below the smallest normal number too, 2^-126, where
    fewer than 24 digits remain: a sum there is a multiple of 2^-149 and exact, a product of two
    singles has 48 digits and is exact in double anywhere, and no root gets there. A quotient A/B
    of whole numbers below 2^24, in units of some power of two, differs from a middle M of two
    neighbours, whole and below 2^25, by a share of |A - M B| / (M B) of it, at least 2^-49 where
    it is not M itself, which a rounding of 2^-53 does not bridge. Exponents of singles stay far
    inside those of double, so that nothing is lost or infinite before the second rounding.

    Every function has a place of its own to round in: two texts can run at the same time.

    Examples
    --------
    >>> single = rounding()
    >>> single(0.1), single(1e39), single(1e-46)
    (0.10000000149011612, inf, 0.0)
    """
    place = array("f", [0.0])

    def single(value: float) -> float:
        place[0] = value
        return place[0]

    return single


def _single(value: float) -> float:
    return ctypes.c_float(value).value


def _single_root(a: float) -> float:
    return _single(square_root(a))


def _of_numpy(function: Any, kind: type) -> Callable[..., float]:
    def compute(*arguments: float) -> float:
        with np.errstate(all="ignore"):
            return float(kind(function(*map(kind, arguments))))

    return compute


#: Operators on two values of a type that Python has too. Both operands of AND and OR are evaluated:
#: what goes wrong in the second one is not overlooked.
ARITHMETIC = {
    **{(kind, sign): sign for kind in ("LREAL", "REAL", "DINT") for sign in "+-*"},
    ("BOOL", "AND"): "&",
    ("BOOL", "OR"): "|",
}
#: What a result of a type goes through, and what divides.
ROUNDED = {"REAL": "single"}
DIVIDED = {("DINT", "/"): "whole_quotient", ("DINT", "MOD"): "remainder"}
COMPARISONS = {"<": "<", "<=": "<=", ">": ">", ">=": ">=", "=": "==", "<>": "!="}
COMPARED = ("LREAL", "REAL", "DINT")

#: Names of the parameters of functions that have more than one.
PARAMETERS = {
    "MAX": ("IN1", "IN2"), "MIN": ("IN1", "IN2"), "LIMIT": ("MN", "IN", "MX"),
    "SEL": ("G", "IN0", "IN1"),
}  # fmt: skip


def _limit(low: int, value: int, high: int) -> int:
    return min(max(value, low), high)


def _select(which: bool, first: Any, second: Any) -> Any:
    return second if which else first


_BOOL, _LREAL, _REAL, _DINT = ("BOOL",), ("LREAL",), ("REAL",), ("DINT",)
_SHARED: dict[str, Any] = {
    "EXP": np.exp, "LN": np.log, "SIN": np.sin, "COS": np.cos, "TAN": np.tan,
    "ASIN": np.arcsin, "ACOS": np.arccos, "ATAN": np.arctan,
}  # fmt: skip
_OF_TWO: dict[str, Any] = {"ATAN2": np.arctan2, "EXPT": np.power}

#: Name and types of the arguments of a function to type of the result and what computes it.
FUNCTIONS: dict[tuple[str, tuple[str, ...]], tuple[str, Callable[..., Any]]] = {
    ("BOOL_TO_DINT", _BOOL): ("DINT", int),
    ("MAX", _DINT * 2): ("DINT", max),
    ("MIN", _DINT * 2): ("DINT", min),
    ("LIMIT", _DINT * 3): ("DINT", _limit),
    **{
        ("SEL", ("BOOL", kind, kind)): (kind, _select) for kind in ("LREAL", "REAL", "DINT", "BOOL")
    },
    ("ABS", _DINT): ("DINT", abs),
    ("ABS", _LREAL): ("LREAL", abs),
    ("ABS", _REAL): ("REAL", abs),
    ("SQRT", _LREAL): ("LREAL", square_root),
    ("SQRT", _REAL): ("REAL", _single_root),
    ("TRUNC", _LREAL): ("DINT", truncated),
    ("TRUNC", _REAL): ("DINT", truncated),
    ("TRUNC_DINT", _LREAL): ("DINT", truncated),
    ("TRUNC_DINT", _REAL): ("DINT", truncated),
    ("LREAL_TO_DINT", _LREAL): ("DINT", rounded),
    ("REAL_TO_DINT", _REAL): ("DINT", rounded),
    ("DINT_TO_LREAL", _DINT): ("LREAL", float),
    ("DINT_TO_REAL", _DINT): ("REAL", _single),
    ("REAL_TO_LREAL", _REAL): ("LREAL", float),
    ("LREAL_TO_REAL", _LREAL): ("REAL", _single),
    **{(name, _LREAL): ("LREAL", _of_numpy(f, float)) for name, f in _SHARED.items()},
    **{(name, _REAL): ("REAL", _of_numpy(f, np.float32)) for name, f in _SHARED.items()},
    **{(name, _LREAL * 2): ("LREAL", _of_numpy(f, float)) for name, f in _OF_TWO.items()},
    **{(name, _REAL * 2): ("REAL", _of_numpy(f, np.float32)) for name, f in _OF_TWO.items()},
}
