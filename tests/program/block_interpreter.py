"""Blocks computed statement by statement in plain Python: a third route beside kernel and CasADi.

Nothing here is shared with the builder or the printers: the meaning of each code is written
down once more, from the description of `Operation`, `ForLoop` and `Conditional`, with double
precision scalars and the functions of the C library.
"""

import ctypes
import ctypes.util
import math
import struct
from collections import deque
from collections.abc import Sequence

import numpy as np

from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Block, Conditional, ForLoop

_LIBRARY = ctypes.CDLL(ctypes.util.find_library("m") or "libm.so.6")


def library_function(name: str):
    function = getattr(_LIBRARY, name)
    function.restype = ctypes.c_double
    function.argtypes = [ctypes.c_double] * LIBRARY[name]
    return function


def _divide(a: float, b: float) -> float:
    with np.errstate(all="ignore"):
        return float(np.float64(a) / np.float64(b))


def _whole(function, a: float) -> float:
    """Floor or ceiling: of a number without fraction it is the number, sign of zero included."""
    if not math.isfinite(a):
        return a
    return math.copysign(float(function(a)), a)


MEANING = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": _divide,
    "negate": lambda a: -a,
    "square_root": lambda a: math.sqrt(a) if a >= 0 else (a if a == 0 else math.nan),
    "absolute": lambda a: math.copysign(a, 1.0),
    "floor": lambda a: _whole(math.floor, a),
    "ceiling": lambda a: _whole(math.ceil, a),
    "minimum": lambda a, b: a if a < b else b,
    "maximum": lambda a, b: a if a > b else b,
    "select": lambda c, a, b: a if c else b,
    "number": lambda c: 1.0 if c else 0.0,
    "truth": lambda a: a != 0.0,
    "less": lambda a, b: a < b,
    "less_equal": lambda a, b: a <= b,
    "equal": lambda a, b: a == b,
    "not_equal": lambda a, b: a != b,
    "not": lambda c: not c,
    "and": lambda c, d: c and d,
    "or": lambda c, d: c or d,
    **{name: library_function(name) for name in LIBRARY},
}


Rings = dict[str, deque[float]]


def evaluate_block(
    block: Block, arguments: Sequence[float], rings: Rings | None = None
) -> list[float]:
    """Return the results of a block; every value is assigned once and before it is read.

    `rings` hold what the rings of its loops hold, the oldest first; they are advanced.
    """
    assert len(arguments) == block.arguments
    values: dict[int, float | bool] = dict(enumerate(map(float, arguments)))

    def assign(target: int, value: float | bool) -> None:
        assert target not in values, f"value {target} is assigned twice"
        assert isinstance(value, bool) == (target in block.truths), f"kind of value {target}"
        values[target] = value

    for statement in block.statements:
        if isinstance(statement, ForLoop):
            carried = [values[i] for i in statement.carried]
            invariants = [values[i] for i in statement.invariants]
            queues = [(rings or {})[ring.name] for ring in statement.rings]
            for turn in range(statement.count):
                row = [table[turn] for table in statement.tables]
                oldest = [queue.popleft() for queue in queues]
                results = evaluate_block(statement.body, [*row, *carried, *oldest, *invariants])
                carried, written = results[: len(carried)], results[len(carried) :]
                for queue, value in zip(queues, written, strict=True):
                    queue.append(value)
            for target, value in zip(statement.targets, carried, strict=True):
                assign(target, value)
        elif isinstance(statement, Conditional):
            condition = values[statement.condition]
            assert isinstance(condition, bool)
            carried = [values[i] for i in statement.carried]
            given = [*carried, *(values[i] for i in statement.invariants)]
            results = evaluate_block(statement.body, given) if condition else carried
            for target, value in zip(statement.targets, results, strict=True):
                assign(target, value)
        else:
            assert isinstance(statement, Operation)
            if statement.code == "constant":
                assign(statement.target, statement.constant)
            else:
                given = [values[i] for i in statement.arguments]
                assign(statement.target, MEANING[statement.code](*given))
    results = [values[i] for i in block.results]
    assert not any(isinstance(result, bool) for result in results)
    return [float(result) for result in results]


def bits(values: Sequence[float]) -> list[bytes]:
    """Return the bits of numbers, the sign of zero included; one form for all not-a-numbers."""
    return [b"nan" if math.isnan(value) else struct.pack("<d", value) for value in values]
