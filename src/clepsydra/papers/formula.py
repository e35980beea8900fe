"""A formula as a document prints it, in the notation of a program, read into exact expressions."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from clepsydra.papers.exact_matrix import determinant, inverse
from clepsydra.papers.rational_function import exact, square_root, symbol

#: An expression, or a matrix of them.
Value = Any


def read_formula(text: str, names: Mapping[str, Value] | None = None) -> Value:
    """Read a formula: sums, products, quotients, powers, ``sqrt``; of matrices ``.T`` and ``det``.

    A name is the symbol that is called so, or what `names` has for it. Any other function of
    something is a symbol too, by what it is of: ``y(k - 1)`` and ``y(-1 + k)`` are one. Numbers are
    exactly what their digits say.

    Examples
    --------
    >>> read_formula("u(k - 1 - d) + sqrt(2*g*h)/0.5")
    2*sqrt(2)*sqrt(g)*sqrt(h) + u(-d + k - 1)
    """
    return _value(ast.parse(text, mode="eval").body, names or {})


def _value(node: ast.expr, names: Mapping[str, Value]) -> Value:
    def of(child: ast.expr) -> Value:
        return _value(child, names)

    match node:
        case ast.Constant(value=int() | float() as number):
            return exact(Fraction(repr(number)))
        case ast.Name(id=name):
            return names[name] if name in names else symbol(name)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -of(operand)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(of(left), of(right))
        case ast.BinOp(left=left, op=sign, right=right):
            return _OPERATIONS[type(sign)](of(left), of(right))
        case ast.Attribute(value=transposed, attr="T"):
            return of(transposed).T
        case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
            return square_root(of(argument))
        case ast.Call(func=ast.Name(id="det"), args=[argument]):
            return determinant(of(argument))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return symbol(f"{name}({', '.join(str(of(each)) for each in arguments)})")
    raise ValueError(f"{ast.unparse(node)} is no part of a formula")


def _power(base: Value, exponent: Value) -> Value:
    if not isinstance(base, np.ndarray):
        return base**exponent.number
    if exponent != -1:
        raise ValueError(f"{exponent} as the power of a matrix is no part of a formula")
    return inverse(base)


def _times(left: Value, right: Value) -> Value:
    are_matrices = isinstance(left, np.ndarray) and isinstance(right, np.ndarray)
    return left @ right if are_matrices else left * right


_OPERATIONS: dict[type[ast.operator], Callable[[Value, Value], Value]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _times,
    ast.Div: operator.truediv,
}
