"""Reads the instructions of CasADi's expressions into the values of a program."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca

from clepsydra.base.errors import ClepsydraError
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import LIBRARY

#: Appends the call of a function, given its arguments, and returns the values of its results.
Called = Callable[[ca.Function, list[int]], Sequence[int]]
_CODES = {getattr(ca, f"OP_{name.upper()}"): name for name in LIBRARY}
_CODES |= {
    ca.OP_CONSTPOW: "pow",
    ca.OP_ADD: "add",
    ca.OP_SUB: "subtract",
    ca.OP_MUL: "multiply",
    ca.OP_DIV: "divide",
    ca.OP_NEG: "negate",
    ca.OP_SQRT: "square_root",
    ca.OP_FABS: "absolute",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceiling",
    ca.OP_FMIN: "minimum",
    ca.OP_FMAX: "maximum",
    ca.OP_LT: "less",
    ca.OP_LE: "less_equal",
    ca.OP_EQ: "equal",
    ca.OP_NE: "not_equal",
    ca.OP_NOT: "not",
    ca.OP_AND: "and",
    ca.OP_OR: "or",
}


def check_expressions(function: ca.Function) -> None:
    """Refuse what is no function of SX expressions.

    Raises
    ------
    ClepsydraError

    Examples
    --------
    >>> check_expressions(ca.Function("nothing", [], []))
    """
    if not isinstance(function, ca.Function):
        raise ClepsydraError(
            f"{getattr(function, 'name', 'law')}: a law in Python has no program to compile, to "
            "print or to run as a batch; write it as expressions, by step_law"
        )
    if not function.is_a("SXFunction"):
        raise ClepsydraError(
            f"{function.name()}: a {function.class_name()} cannot become a step program; "
            "write it over casadi.SX"
        )


def read_expressions(
    builder: BlockBuilder,
    function: ca.Function,
    arguments: Sequence[int],
    called: Called,
    *,
    fused: bool = False,
) -> dict[tuple[int, int], int]:
    """Append the instructions; return the value of every structural nonzero of every output.

    Parameters
    ----------
    builder : BlockBuilder
    function : casadi.Function
        An SX function with dense arguments.
    arguments : sequence of int
        Values of all its arguments, one after the other.
    called : callable
        Appends the functions that it calls.
    fused : bool
        Whether a target may fuse multiplications into additions here.

    Raises
    ------
    ClepsydraError
        The function is Python, no SX function, or uses an operation that no target prints.
    """
    check_expressions(function)
    place: dict[tuple[int, int], int] = {}
    for i in range(function.n_in()):
        if not function.sparsity_in(i).is_dense():
            raise ClepsydraError(f"{function.name()}: argument {i} is sparse; make it dense")
        for entry in range(function.numel_in(i)):
            place[i, entry] = len(place)
    if len(place) != len(arguments):
        raise ClepsydraError(
            f"{function.name()}: {len(arguments)} values for {len(place)} scalar arguments"
        )
    nodes: ca.SX | None = None
    work: dict[int, int] = {}
    outputs: dict[tuple[int, int], int] = {}
    # A choice that is made in the expression itself, whatever that is called with: its other half
    # is nothing to add, and some versions of CasADi write the half that counts alone.
    alone, nothing = not any(map(builder.is_constant, arguments)), set[int]()
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        target, source = function.instruction_output(k), function.instruction_input(k)
        added = [entry for entry in source if entry not in nothing] if code == ca.OP_ADD else []
        if nothing:
            nothing -= set(target)
        if alone and code == ca.OP_IF_ELSE_ZERO and builder.known_truth(work[source[0]]) is False:
            nothing.add(target[0])
        if len(added) == 1:
            work[target[0]] = work[added[0]]
        elif code == ca.OP_INPUT:
            work[target[0]] = arguments[place[source[0], source[1]]]
        elif code == ca.OP_OUTPUT:
            outputs[target[0], target[1]] = work[source[0]]
        elif code == ca.OP_CONST:
            work[target[0]] = builder.constant(function.instruction_constant(k))
        elif code == ca.OP_CALL:
            if nodes is None:
                nodes = function.instructions_sx()
            values = called(nodes[k].which_function(), [work[entry] for entry in source])
            work.update(zip(target, values, strict=True))
        else:
            operands = [work[entry] for entry in source]
            work[target[0]] = _operation(builder, function, code, operands, fused)
    return outputs


def _operation(
    builder: BlockBuilder, function: ca.Function, code: int, operands: list[int], fused: bool
) -> int:
    first = operands[0]
    if code in _CODES:
        return builder.operation(_CODES[code], *operands, fused=fused)
    if code == ca.OP_ASSIGN:
        return first
    if code == ca.OP_SQ:
        return builder.operation("multiply", first, first, fused=fused)
    if code == ca.OP_TWICE:
        return builder.operation("multiply", builder.constant(2.0), first, fused=fused)
    if code == ca.OP_INV:
        return builder.operation("divide", builder.constant(1.0), first, fused=fused)
    if code == ca.OP_IF_ELSE_ZERO:
        return builder.operation("select", first, operands[1], builder.constant(0.0))
    if code == ca.OP_SIGN:
        return _sign(builder, first)
    raise ClepsydraError(
        f"{function.name()}: CasADi operation number {code} has no printed form; "
        "write the law with + - * / sqrt, comparisons and the functions of the C library"
    )


def _sign(builder: BlockBuilder, value: int) -> int:
    """Return -1, +1, or the value itself where it is zero or not a number."""
    zero, one, minus_one = (builder.constant(number) for number in (0.0, 1.0, -1.0))
    above = builder.operation("select", builder.operation("less", zero, value), one, value)
    return builder.operation("select", builder.operation("less", value, zero), minus_one, above)
