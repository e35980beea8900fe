"""Reads CasADi's SX instruction list into the values of a program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache

import casadi as ca

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.signal import Signal
from clepsydra.program.block import Block
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.counted_loop import recover_loop
from clepsydra.program.equations import Equations, function_of
from clepsydra.program.kept_equations import keeping_calls, kept_calls
from clepsydra.program.operation import LIBRARY
from clepsydra.program.program import Program
from clepsydra.program.step_law import StepLaw

#: Programs of blocks that are kept: a law in its shell has some dozens.
_BLOCKS = 128
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


def inline(
    builder: BlockBuilder, function: ca.Function, arguments: Sequence[int], *, fused: bool = False
) -> list[int]:
    """Append the instructions of an SX function and return the values of its outputs.

    Parameters
    ----------
    builder : BlockBuilder
    function : casadi.Function
        An SX function with dense arguments.
    arguments : sequence of int
        Values of all its arguments, one after the other.
    fused : bool
        Whether a target may fuse multiplications into additions here.

    Returns
    -------
    list of int
        Values of all its outputs, one after the other.

    Raises
    ------
    ClepsydraError
        The function is Python, no SX function, or uses an operation that no target prints.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> builder = BlockBuilder(1)
    >>> values = inline(builder, ca.Function("f", [x], [ca.sqrt(x) + 1]), [0])
    >>> [operation.code for operation in builder.finish(values).operations()]
    ['square_root', 'constant', 'add']
    """
    outputs = _read(builder, function, arguments, fused)
    found = []
    for i in range(function.n_out()):
        # An output stores only its structural nonzeros.
        stored = {entry: k for k, entry in enumerate(function.sparsity_out(i).find())}
        for entry in range(function.numel_out(i)):
            known = entry in stored
            found.append(outputs[i, stored[entry]] if known else builder.constant(0.0))
    return found


def _check(function: ca.Function) -> None:
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


def _read(
    builder: BlockBuilder, function: ca.Function, arguments: Sequence[int], fused: bool
) -> dict[tuple[int, int], int]:
    """Append the instructions; return the value of every structural nonzero of every output."""
    _check(function)
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
            called = nodes[k].which_function()
            values = _call(builder, called, [work[entry] for entry in source], fused)
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


def _call(
    builder: BlockBuilder, called: ca.Function, arguments: list[int], fused: bool
) -> Sequence[int]:
    if kept := (kept_calls() or {}).get(called.name()):
        block, instance = kept
        return builder.call(_program_of_block(block), instance, arguments)
    loop = recover_loop(called)
    if loop is None:
        found = _read(builder, called, arguments, fused)
        return [found[i, k] for i in range(called.n_out()) for k in range(called.nnz_out(i))]
    size = sum(loop.body.numel_in(i) for i in range(loop.body.n_in()))
    inner, carried = BlockBuilder(size), called.numel_in(0)
    body = inner.finish(inline(inner, loop.body, range(size), fused=fused))
    start, held = arguments[:carried], arguments[carried:]
    return builder.loop(loop.name, body, loop.count, loop.tables, start, held)


def program_of(law: StepLaw) -> Program:
    """Read a step law into one straight-line program: what the engine runs.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.step_law import Equations, step_law
    >>> law = step_law("doubler", inputs=[Signal("a")], parameters=[], state=[],
    ...                outputs=[Signal("b")],
    ...                equations=lambda s: Equations({}, {"b": 2 * s["a"]}))
    >>> [operation.code for operation in program_of(law).block.operations()]
    ['constant', 'multiply']
    """
    names = [signal.name for signal in law.intermediates]
    return _program(law, law.parameters, law.function, names)


def structured_program_of(law: StepLaw) -> Program:
    """Read a step law into a program in which the calls of its blocks are calls.

    It computes the same bits as `program_of`; the printers write each block once.

    Raises
    ------
    ClepsydraError
        The law has no equations, as one in Python.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.block import Block
    >>> from clepsydra.program.step_law import Equations, step_law
    >>> double = Block("double", (Signal("a"),), (), (Signal("b"),),
    ...                lambda s: Equations({}, {"b": 2 * s["a"]}))
    >>> law = step_law("doubler", inputs=[Signal("a")], parameters=[], state=[],
    ...                outputs=[Signal("b")],
    ...                equations=lambda s: double("twice", {"a": s["a"]}, {}))
    >>> [call.instance for call in structured_program_of(law).block.statements]
    ['twice']
    """
    if law.equations is None:
        raise ClepsydraError(
            f"{law.name}: a law in Python has no program to compile, to print or to run as a "
            "batch; write it as expressions, by step_law"
        )
    with keeping_calls():
        return _structured(law, law.parameters, law.equations)[0]


def _structured(
    whole: StepLaw | Block,
    parameters: tuple[Signal, ...],
    equations: Callable[[dict[str, ca.SX]], Equations],
) -> tuple[Program, Equations]:
    """Read the equations of a law or a block, in which calls are kept; return these too."""
    groups = (whole.state, whole.inputs, parameters)
    function, written = function_of(whole.name, groups, whole.outputs, equations)
    return _program(whole, parameters, function, written.intermediates), written


@lru_cache(maxsize=_BLOCKS)
def _program_of_block(block: Block) -> Program:
    """Return the program of a block, which all its instances share."""
    program, written = _structured(block, (), block.equations)
    return replace(
        program,
        description=block.description,
        constants=block.constants,
        words=written.words,
        tables=block.tables,
    )


def _program(
    whole: StepLaw | Block,
    parameters: tuple[Signal, ...],
    function: ca.Function,
    between: Iterable[str],
) -> Program:
    """Read the function of a law or a block; its results are followed by what only has names."""
    _check(function)
    results = len(whole.state) + len(whole.outputs)
    size = sum(function.numel_in(i) for i in range(function.n_in()))
    builder = BlockBuilder(size)
    values = inline(builder, function, range(size))
    named: dict[int, str] = {}
    for value, name in zip(values[results:], between, strict=True):
        if value >= size:
            named.setdefault(value, name)
    block = builder.finish(values[:results])
    signals = (whole.state, whole.inputs, parameters, whole.outputs)
    program = Program(whole.name, *signals, block, named)
    instances = [call.identifier for call in program.calls]
    for name in instances:
        if instances.count(name) > 1:
            raise InputError(
                f"{whole.name}, instances", name, "a name of its own for each", "rename one of them"
            )
    return program
