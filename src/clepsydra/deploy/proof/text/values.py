"""Values of Structured Text: its types, its literals, and what fits a type."""

from __future__ import annotations

import ctypes
import math
from decimal import Decimal
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.deploy.proof.text.tree import StructuredTextError, content, part, wrong

if TYPE_CHECKING:
    from tree_sitter import Node

#: Type to its value where a declaration gives none. A REAL is the double of its value.
ZEROS: dict[str, Any] = {"LREAL": 0.0, "REAL": 0.0, "DINT": 0, "BOOL": False}
REALS = ("LREAL", "REAL")
#: The whole numbers of 32 bits.
DINT = range(-(2**31), 2**31)
#: What a literal without a type may become.
LITERALS = {
    "real_literal": REALS,
    "integer_literal": ("DINT",),
    "boolean_literal": ("BOOL",),
}


def literal(node: Node, type_name: str) -> Any:
    """Return the value of a literal in a type; nothing is converted.

    Raises
    ------
    StructuredTextError
        It is no literal of the type.
    """
    if node.type == "typed_literal":
        if content(part(node, "type")).upper() != type_name:
            raise wrong(node, f"{content(node)} is no {type_name}")
        return literal(part(node, "value"), type_name)
    text = content(node)
    if type_name not in LITERALS.get(node.type, ()):
        raise wrong(node, f"{text} is no literal of {type_name}")
    if type_name == "BOOL":
        return {"TRUE": True, "FALSE": False}[text.upper()]
    if type_name == "DINT":
        return in_range(int(text))
    value = float(text) if type_name == "LREAL" else nearest_single(text)
    if not math.isfinite(value):
        raise wrong(node, f"{text} is too large for {type_name}")
    return value


def nearest_single(text: str) -> float:
    """Return the single-precision number nearest to a decimal.

    The nearest double need not lead there: a decimal close to the middle between two
    single-precision numbers may become that middle. So the double is rounded to odd first
    (S. Boldo and G. Melquiond, IEEE Transactions on Computers 57(4), 2008,
    doi 10.1109/TC.2007.70819).

    Examples
    --------
    A little above the middle of 1 and the next number, by less than a double can tell:

    >>> middle = "1.00000005960464477539062500000001"
    >>> float(np.float32(float(middle))), nearest_single(middle)
    (1.0, 1.0000001192092896)
    """
    value, exact = float(text), Decimal(text)
    if math.isfinite(value) and Decimal(value) != exact:
        toward = math.inf if Decimal(value) < exact else -math.inf
        if not np.float64(value).view(np.int64) & 1:
            value = math.nextafter(value, toward)
    return ctypes.c_float(value).value


def admitted(type_name: str, value: Any) -> Any:
    """Return a number that comes from outside as a value of a type.

    Raises
    ------
    StructuredTextError
        It is none of the type.
    """
    if type_name == "LREAL":
        return float(value)
    if type_name == "REAL":
        return ctypes.c_float(value).value
    if type_name == "BOOL" and value in (0, 1):
        return bool(value)
    if type_name == "DINT" and math.isfinite(value) and value == int(value):
        return in_range(int(value))
    raise StructuredTextError(f"{value} is no {type_name}")


def in_range(value: int) -> int:
    """Return an integer that fits a DINT.

    Raises
    ------
    StructuredTextError
        It does not fit.
    """
    if not -(2**31) <= value < 2**31:
        raise StructuredTextError(f"{value} leaves DINT")
    return value
