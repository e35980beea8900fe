"""Equations of a process as SymPy expressions, as they are while every tank holds water."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import casadi as ca

if TYPE_CHECKING:
    from sympy import Expr


def to_sympy(expression: ca.SX, names: Mapping[str, Any]) -> list[Expr]:
    """Return a CasADi vector in SymPy, by the names of its symbols.

    A level is above any number that it is compared with, the one below which the flow is
    laminar: the equations are those of tanks that hold water.

    Examples
    --------
    >>> import sympy
    >>> x = ca.SX.sym("x")
    >>> to_sympy(ca.sqrt(ca.fmax(x, 0.001)) + 2 * x**2, {"x": sympy.Symbol("h")})
    [sqrt(h) + 2*h**2]
    """
    import sympy

    operations = {
        ca.OP_ADD: lambda a, b: a + b,
        ca.OP_SUB: lambda a, b: a - b,
        ca.OP_MUL: lambda a, b: a * b,
        ca.OP_DIV: lambda a, b: a / b,
        ca.OP_FMAX: lambda a, b: b if a.is_number else a,
        ca.OP_LT: lambda a, b: sympy.Integer(not b.is_number),
        ca.OP_LE: lambda a, b: sympy.Integer(not b.is_number),
        ca.OP_IF_ELSE_ZERO: lambda a, b: a * b,
        ca.OP_SQRT: sympy.sqrt,
        ca.OP_SQ: lambda a: a**2,
        ca.OP_NEG: lambda a: -a,
        ca.OP_INV: lambda a: 1 / a,
        ca.OP_TWICE: lambda a: 2 * a,
        ca.OP_NOT: lambda a: 1 - a,
    }

    def of(entry: ca.SX) -> Any:
        if entry.is_symbolic():
            return names[entry.name()]
        if entry.is_constant():
            return sympy.nsimplify(float(entry), rational=True)
        return operations[entry.op()](*(of(entry.dep(k)) for k in range(entry.n_dep())))

    return [sympy.simplify(of(entry)) for entry in ca.vertsplit(ca.densify(expression))]
