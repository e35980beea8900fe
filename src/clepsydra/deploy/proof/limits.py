"""What targets cannot express, and why: the only refusals with which a proof still holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from clepsydra.controllers.python_law import PythonLaw
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Call, ForLoop

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
    codes = {operation.code for operation in _operations(item)}
    return bool(codes & _NO_FUNCTIONS)


def _is_infinite(item: ProofItem) -> bool:
    return not all(map(math.isfinite, _numbers(item)))


def _unread_by_matiec(item: ProofItem) -> bool:
    low, high = float(_SINGLE.tiny), float(_SINGLE.max)
    declared = [signal_of(entry).initial for entry in _declared(item)]
    return any(v and not low <= abs(v) <= high for v in declared)


def _outside_real(item: ProofItem) -> bool:
    low, high = float(_SINGLE.tiny), float(_SINGLE.max)
    sizes = {abs(v) for v in _numbers(item) if v and math.isfinite(v)} - set(_REPLACED)
    return any(not low <= size <= high for size in sizes)


def _beyond_whole(item: ProofItem) -> bool:
    counts = [
        signal for signal in map(signal_of, (*_declared(item), *_outputs(item)))
        if signal.kind == "integer"
    ]  # fmt: skip
    within = all(s.low >= -_SINGLE_WHOLE and s.high <= _SINGLE_WHOLE for s in counts)
    return not within


def _delays(item: ProofItem) -> bool:
    return item.point is not None and bool(item.point.process.motion.delays)


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
    "an importer integrates the present, and a transport delay needs the past",
    _delays,
)
LIMITS = (PYTHON_LAW, *OF_TEXT, MATIEC_NUMBERS, *OF_SINGLE, DELAYS)


def _declared(item: ProofItem) -> tuple[Entry, ...]:
    """Return the entries of a program that have a number of their own."""
    program = item.program
    if program is None:
        return ()
    return (*program.state, *program.rings, *program.inputs, *program.parameters)


def _outputs(item: ProofItem) -> tuple[Entry, ...]:
    return item.program.outputs if item.program else ()


def _operations(item: ProofItem) -> Iterator[Operation]:
    return item.program.block.operations() if item.program else iter(())


def _numbers(item: ProofItem) -> Iterator[float]:
    """Yield every real number of a program: initial values, constants, tables of loops."""
    for signal in map(signal_of, _declared(item)):
        if signal.kind == "real":
            yield signal.initial
    for operation in _operations(item):
        if operation.code == "constant":
            yield operation.constant
    if item.program is not None:
        yield from _tables(item.program.block)


def _tables(block: Block) -> Iterator[float]:
    for statement in block.statements:
        if isinstance(statement, Operation):
            continue
        if isinstance(statement, Call):
            yield from _tables(statement.program.block)
            continue
        if isinstance(statement, ForLoop):
            for table in statement.tables:
                yield from table
        yield from _tables(statement.body)
