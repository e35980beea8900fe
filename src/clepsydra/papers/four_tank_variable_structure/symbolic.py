"""Equations of a process as exact expressions, as they are while every tank holds water."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import casadi as ca

from clepsydra.papers.rational_function import RationalFunction, exact, square_root


def exactly(expression: ca.SX, names: Mapping[str, RationalFunction]) -> list[RationalFunction]:
    """Return a CasADi vector exactly, by the names of its symbols.

    A level is above any number that it is compared with, the one below which the flow is
    laminar: the equations are those of tanks that hold water.

    Examples
    --------
    >>> from clepsydra.papers.rational_function import symbol
    >>> x = ca.SX.sym("x")
    >>> exactly(ca.sqrt(ca.fmax(x, 0.001)) + 2 * x**2, {"x": symbol("h")})
    [2*h**2 + sqrt(h)]
    """
    operations: dict[int, Callable[..., RationalFunction]] = {
        ca.OP_ADD: lambda a, b: a + b,
        ca.OP_SUB: lambda a, b: a - b,
        ca.OP_MUL: lambda a, b: a * b,
        ca.OP_DIV: lambda a, b: a / b,
        ca.OP_FMAX: lambda a, b: a if a.symbols else b,
        ca.OP_LT: lambda a, b: exact(bool(b.symbols)),
        ca.OP_LE: lambda a, b: exact(bool(b.symbols)),
        ca.OP_IF_ELSE_ZERO: lambda a, b: a * b,
        ca.OP_SQRT: square_root,
        ca.OP_SQ: lambda a: a**2,
        ca.OP_NEG: lambda a: -a,
        ca.OP_INV: lambda a: 1 / a,
        ca.OP_TWICE: lambda a: 2 * a,
        ca.OP_NOT: lambda a: 1 - a,
    }

    def of(entry: ca.SX) -> RationalFunction:
        if entry.is_symbolic():
            return names[entry.name()]
        if entry.is_constant():
            return exact(Fraction(repr(float(entry))))
        first, *others = (entry.dep(place) for place in range(entry.n_dep()))
        left = of(first)
        if left == 0 and entry.op() in (ca.OP_MUL, ca.OP_IF_ELSE_ZERO):
            return left  # nothing runs over a weir that is not there, whatever root it has
        return operations[entry.op()](left, *map(of, others))

    return [of(entry) for entry in ca.vertsplit(ca.densify(expression))]
