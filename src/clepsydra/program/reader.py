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
from clepsydra.program.expression_reader import check_expressions, read_expressions
from clepsydra.program.kept_equations import keeping_calls, kept_calls
from clepsydra.program.known_routines import routine_of
from clepsydra.program.program import Program
from clepsydra.program.routine_library import is_conditional
from clepsydra.program.step_law import StepLaw

#: Programs of blocks that are kept: a law in its shell has some dozens.
_BLOCKS = 128


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

    def called(each: ca.Function, given: list[int]) -> Sequence[int]:
        return _call(builder, each, given, fused)

    outputs = read_expressions(builder, function, arguments, called, fused=fused)
    found = []
    for i in range(function.n_out()):
        # An output stores only its structural nonzeros.
        stored = {entry: k for k, entry in enumerate(function.sparsity_out(i).find())}
        for entry in range(function.numel_out(i)):
            known = entry in stored
            found.append(outputs[i, stored[entry]] if known else builder.constant(0.0))
    return found


def _call(
    builder: BlockBuilder, called: ca.Function, arguments: list[int], fused: bool
) -> Sequence[int]:
    if kept := (kept_calls() or {}).get(called.name()):
        block, instance = kept
        return builder.call(_program_of_block(block), instance, arguments)
    if routine := routine_of(called):
        if is_conditional(called):
            return builder.routine(routine, arguments[1:], condition=arguments[0])
        return builder.routine(routine, arguments)
    loop = recover_loop(called)
    if loop is None:

        def within(each: ca.Function, given: list[int]) -> Sequence[int]:
            return _call(builder, each, given, fused)

        found = read_expressions(builder, called, arguments, within, fused=fused)
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
    check_expressions(function)
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
