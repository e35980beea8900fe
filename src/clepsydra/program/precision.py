"""The precision of a program: double, or single where a target computes in REAL or float."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from itertools import count
from typing import Literal, get_args

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.program.operation import LIBRARY, TO_SINGLE, Operation
from clepsydra.program.program import Block, Call, ForLoop, Program, Statement, written_by
from clepsydra.program.routine import RoutineCall, Step
from clepsydra.program.step_block import block_of

#: LREAL and double, or REAL and float.
Precision = Literal["double", "single"]

_LARGEST = float(np.finfo(np.float32).max)
_SMALLEST = float(np.finfo(np.float32).tiny)
#: What takes the place of doubles among single-precision numbers: of the magnitude above which a
#: value counts as not a number (`LARGEST_NUMBER` of the controllers' blocks), and of what keeps a
#: divisor from being zero.
_IN_SINGLE = {1e300: float(np.float32(3e38)), 1e-300: _SMALLEST}
_LARGEST_NUMBER = Signal(
    "largest_number",
    initial=1e300,
    description="a value beyond it is not a number",
)


#: Operations on numbers of single precision whose result need not be one.
_INEXACT = frozenset({"add", "subtract", "multiply", "divide", "square_root", *LIBRARY})


def check_precision(precision: str) -> None:
    """Refuse a precision that there is not.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_precision("half")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: precision: got 'half', expected double or single; \
choose one of them.
    """
    if precision not in get_args(Precision):
        raise InputError(
            "precision", precision, " or ".join(get_args(Precision)), "choose one of them"
        )


def largest_number(precision: Precision) -> Signal:
    """Return the magnitude above which a value counts as not a number, as a constant with a name.

    Examples
    --------
    >>> largest_number("double").initial
    1e+300
    """
    if precision == "double":
        return _LARGEST_NUMBER
    return replace(_LARGEST_NUMBER, initial=_IN_SINGLE[_LARGEST_NUMBER.initial])


def in_precision(program: Program, precision: Precision) -> Program:
    """Return a program whose numbers all are numbers of a precision.

    In single precision every constant, table entry, parameter and initial value is rounded to
    the nearest single-precision number; the bound above which a value counts as not a number,
    1e300, becomes 3e38, and the divisor that stands in for zero, 1e-300, becomes 1.2e-38.

    Raises
    ------
    InputError
        The precision is unknown, or a number is too large or too small for it.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> tenth = Block(0, (Operation(0, "constant", (), 0.1),), (0,))
    >>> program = Program("tenth", (), (), (), (Signal("y"),), tenth)
    >>> in_precision(program, "single").block.statements[0].constant
    0.10000000149011612
    """
    check_precision(precision)
    if precision == "double":
        return program
    place = f"program {program.name}"

    def numbers(values: Iterable[float], where: str) -> tuple[float, ...]:
        return tuple(_single(value, f"{place}, {where}") for value in values)

    def statement(each: Statement) -> Statement:
        if isinstance(each, Operation) and each.code == "constant":
            return replace(each, constant=_single(each.constant, f"{place}, a constant"))
        if isinstance(each, Call):
            return replace(each, program=in_precision(each.program, "single"))
        if isinstance(each, ForLoop):
            tables = tuple(numbers(table, f"table of {each.name}") for table in each.tables)
            return replace(each, tables=tables)
        if isinstance(each, RoutineCall):
            where = f"numbers of {each.routine.name}"
            return replace(each, tables=tuple(numbers(table, where) for table in each.tables))
        return each

    def signal(each: Signal) -> Signal:
        if each.kind != "real":
            return each
        return replace(each, initial=_single(each.initial, f"{place}, {each.name}"))

    found = replace(program, block=program.block.with_statements(statement)).with_signals(signal)
    tables = (replace(t, values=numbers(t.values, f"table {t.name}")) for t in program.tables)
    return replace(found, tables=tuple(tables))


def in_single_arithmetic(program: Program) -> Program:
    """Return a program that computes in doubles what one in single precision computes.

    Its numbers are those of `in_precision`, and each operation is rounded to single precision:
    a sum, difference, product, quotient or root of singles that is rounded to double and then
    to single is the one that is rounded once, since double has more than twice the digits
    (Figueroa, doi:10.1145/221332.221334). A function such as exp is the engine's double,
    rounded; the one for single precision of another library may differ in its last bit.

    Parameters
    ----------
    program : Program
        Who runs it gives inputs in single precision.

    Raises
    ------
    InputError
        A number is too large or too small for single precision.

    Examples
    --------
    One is lost beside 2²⁴:

    >>> from clepsydra.engine.kernel import Kernel
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("sum", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> for each in (program, in_single_arithmetic(program)):
    ...     run = Kernel(each).run(3, inputs={"u": [2.0**24, 1.0, 1.0]})
    ...     print(run.output("y")[0] - 2.0**24)
    [0. 1. 2.]
    [0. 0. 0.]
    """
    return _rounding(in_precision(program, "single"))


def _rounding(program: Program) -> Program:
    return replace(program, block=_rounding_block(program.block))


def _rounding_block(block: Block) -> Block:
    taken = (value for statement in block.statements for value in written_by(statement))
    free = count(max(taken, default=block.arguments) + 1)
    statements: list[Statement] = []
    for each in block.statements:
        if isinstance(each, Call):
            statements.append(replace(each, program=_rounding(each.program)))
        elif isinstance(each, RoutineCall):
            statements.append(each.with_steps(_rounding_step))
        elif not isinstance(each, Operation):
            statements.append(replace(each, body=_rounding_block(each.body)))
        elif each.code in _INEXACT:
            exact = next(free)
            statements.append(replace(each, target=exact))
            statements.append(Operation(each.target, TO_SINGLE, (exact,)))
        else:
            statements.append(each)
    return replace(block, statements=tuple(statements))


def _rounding_step(step: Step) -> Step:
    block = _rounding_block(block_of(step))
    operations = tuple(each for each in block.statements if isinstance(each, Operation))
    return replace(step, operations=operations)


def _single(value: float, place: str) -> float:
    if value == 0.0 or not math.isfinite(value):
        return value
    if abs(value) in _IN_SINGLE:
        return math.copysign(_IN_SINGLE[abs(value)], value)
    if not _SMALLEST <= abs(value) <= _LARGEST:
        raise InputError(
            place, value, f"a number of REAL: magnitude from {_SMALLEST:.3g} to {_LARGEST:.3g}",
            "print it in double precision",
        )  # fmt: skip
    return float(np.float32(value))
