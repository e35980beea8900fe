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

    symbols = ca.symvar(expression)
    function = ca.Function("expression", symbols, [ca.densify(expression)])
    work: dict[int, Any] = {}
    results: list[Any] = [sympy.Integer(0)] * expression.numel()
    binary = {
        ca.OP_ADD: lambda a, b: a + b,
        ca.OP_SUB: lambda a, b: a - b,
        ca.OP_MUL: lambda a, b: a * b,
        ca.OP_DIV: lambda a, b: a / b,
        ca.OP_FMAX: lambda a, b: b if a.is_number else a,
        ca.OP_LT: _below,
        ca.OP_LE: _below,
        ca.OP_IF_ELSE_ZERO: lambda a, b: a * b,
    }
    unary = {
        ca.OP_SQRT: sympy.sqrt,
        ca.OP_SQ: lambda a: a**2,
        ca.OP_NEG: lambda a: -a,
        ca.OP_INV: lambda a: 1 / a,
        ca.OP_TWICE: lambda a: 2 * a,
        ca.OP_NOT: lambda a: 1 - a,
    }
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        given, out = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_CONST:
            work[out[0]] = sympy.nsimplify(function.instruction_constant(k), rational=True)
        elif operation == ca.OP_INPUT:
            work[out[0]] = names[symbols[given[0]].name()]
        elif operation == ca.OP_OUTPUT:
            results[out[1]] = sympy.simplify(work[given[0]])
        elif operation in binary:
            work[out[0]] = binary[operation](*(work[place] for place in given))
        else:
            work[out[0]] = unary[operation](work[given[0]])
    return results


def _below(left: Any, right: Any) -> Any:
    """Return whether left < right where one of the two is a number and the other a level."""
    from sympy import Integer

    return Integer(0) if right.is_number else Integer(1)
