"""What targets cannot express, and why: the only refusals with which a proof still holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, ForLoop, Program
from clepsydra.program.routine import RoutineCall

_SINGLE = np.finfo(np.float32)
#: Magnitudes that stand for no limit and for no divisor, which single precision replaces.
_REPLACED = (1e300, 1e-300)
_SINGLE_WHOLE = 2.0**24
#: The standard has exponential, logarithm, power and the functions of angles, and no more.
_NO_FUNCTIONS = frozenset(
    {
        "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "log1p", "expm1", "erf", "atan2",
        "fmod", "hypot", "copysign",
    }
)  # fmt: skip


@dataclass(frozen=True)
class Limit:
    """Something that a target cannot express by its nature.

    Parameters
    ----------
    name : str
        As it stands in the row that is refused.
    reason : str
        Why that is no fault of what is printed.
    meets : callable
        Takes an item, and returns whether it needs that. It looks at the program itself, so that
        a printer which refuses without need is found out.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Program
    >>> curve = Block(1, (Operation(1, "tanh", (0,)),), (1,))
    >>> item = ProofItem("curve", 1.0, Program("curve", (), (Signal("u"),), (), (Signal("y"),),
    ...                                        curve))
    >>> [limit.name for limit in LIMITS if limit.meets(item)]
    ['functions of Structured Text']
    """

    name: str
    reason: str
    meets: Callable[[ProofItem], bool]


def _is_python(item: ProofItem) -> bool:
    return item.controller is not None and isinstance(item.controller.law, PythonLaw)


def _lacks_function(item: ProofItem) -> bool:
    return any(operation.code in _NO_FUNCTIONS for operation in _program(item).block.operations())


def _is_infinite(item: ProofItem) -> bool:
    return not all(map(math.isfinite, _numbers(_program(item))))


def _unread_by_matiec(item: ProofItem) -> bool:
    return any(map(_outside_single, (signal.initial for signal in _declared(_program(item)))))


def _outside_real(item: ProofItem) -> bool:
    numbers = {abs(v) for v in _numbers(_program(item)) if math.isfinite(v)}
    return any(map(_outside_single, numbers - set(_REPLACED)))


def _outside_single(value: float) -> bool:
    return bool(value) and not float(_SINGLE.tiny) <= abs(value) <= float(_SINGLE.max)


def _beyond_whole(item: ProofItem) -> bool:
    program = _program(item)
    counts = [s for s in (*_declared(program), *program.outputs) if s.kind == "integer"]
    within = all(s.low >= -_SINGLE_WHOLE and s.high <= _SINGLE_WHOLE for s in counts)
    return not within


def _delays(item: ProofItem) -> bool:
    return item.point is not None and bool(item.point.process.delayed)


PYTHON_LAW: Limit = Limit(
    "law in Python",
    "a law that is a Python function has no program that could be printed",
    _is_python,
)
OF_TEXT = (
    Limit(
        "functions of Structured Text",
        "the standard has no hyperbolic functions, no arc tangent of two arguments, no remainder "
        "of real numbers and no hypotenuse",
        _lacks_function,
    ),
    Limit(
        "infinity in Structured Text",
        "the standard has no word for what is infinite or not a number",
        _is_infinite,
    ),
)
MATIEC_NUMBERS = Limit(
    "numbers that matiec reads",
    "it reads a declared number by a function for single precision, and refuses what that "
    "cannot represent",
    _unread_by_matiec,
)
OF_SINGLE = (
    Limit(
        "range of REAL",
        "single precision has no such number, so the program is for double precision only",
        _outside_real,
    ),
    Limit("whole numbers of REAL", "single precision counts to 2^24 only", _beyond_whole),
)
DELAYS = Limit(
    "delays in model exchange",
    "an importer integrates the present, and dead time needs the past",
    _delays,
)
LIMITS = (PYTHON_LAW, *OF_TEXT, MATIEC_NUMBERS, *OF_SINGLE, DELAYS)


def _program(item: ProofItem) -> Program:
    assert item.program is not None
    return item.program


def _declared(program: Program) -> list[Signal]:
    """Return the signals of a program that have a number of their own."""
    entries = (*program.state, *program.rings, *program.inputs, *program.parameters)
    return list(map(signal_of, entries))


def _numbers(program: Program) -> Iterator[float]:
    """Yield every real number of a program: initial values, constants, tables of loops."""
    yield from (signal.initial for signal in _declared(program) if signal.kind == "real")
    for operation in program.block.operations():
        if operation.code == "constant":
            yield operation.constant
    yield from _tables(program.block)


def _tables(block: Block) -> Iterator[float]:
    for statement in block.statements:
        if isinstance(statement, Operation):
            continue
        if isinstance(statement, Call):
            yield from _tables(statement.program.block)
            continue
        if isinstance(statement, (ForLoop, RoutineCall)):
            for table in statement.tables:
                yield from table
        if isinstance(statement, RoutineCall):
            continue
        yield from _tables(statement.body)
