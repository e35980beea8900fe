"""Programs computed in single precision, operation by operation: a second route beside C's float.

The numbers are rounded here once more, and what each code means is written down from the
description of `Operation`, `ForLoop` and `Conditional`, with NumPy's float32 scalars and the
single-precision functions of the C library. Nothing is shared with the printers.
"""

import ctypes
import ctypes.util
import math
from collections import deque

import numpy as np

from clepsydra import Kernel
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Block, Conditional, ForLoop, Program

F = np.float32
_LIBRARY = ctypes.CDLL(ctypes.util.find_library("m") or "libm.so.6")


def _library_function(name: str):
    function = getattr(_LIBRARY, f"{name}f")
    function.restype = ctypes.c_float
    function.argtypes = [ctypes.c_float] * LIBRARY[name]
    return lambda *arguments: F(function(*map(float, arguments)))


MEANING = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negate": lambda a: -a,
    "square_root": np.sqrt,
    "absolute": np.abs,
    "floor": np.floor,
    "ceiling": np.ceil,
    "minimum": lambda a, b: a if a < b else b,
    "maximum": lambda a, b: a if a > b else b,
    "select": lambda c, a, b: a if c else b,
    "number": lambda c: F(1) if c else F(0),
    "truth": lambda a: bool(a != 0),
    "less": lambda a, b: bool(a < b),
    "less_equal": lambda a, b: bool(a <= b),
    "equal": lambda a, b: bool(a == b),
    "not_equal": lambda a, b: bool(a != b),
    "not": lambda c: not c,
    "and": lambda c, d: c and d,
    "or": lambda c, d: c or d,
    **{name: _library_function(name) for name in LIBRARY},
}


def single(value: float) -> F:
    """Round; bounds for what is no number, and for divisors, have counterparts of their own."""
    instead = {1e300: 3e38, 1e-300: float(np.finfo(F).tiny)}.get(abs(value))
    return F(value) if instead is None else F(math.copysign(instead, value))


class InSinglePrecision:
    """One instance of a program's state, computed with 32-bit numbers."""

    def __init__(self, program: Program) -> None:
        self.program = program = Kernel(program).program  # with its blocks in place
        self.parameters = [single(signal.initial) for signal in program.parameters]
        self._kept = [_content(entry) for entry in program.state]
        self._rings = {ring.name: _content(ring) for ring in program.rings}

    def run(self, inputs: dict[str, np.ndarray]) -> np.ndarray:
        """Run all scans; returns outputs and then states [scans, q + n]."""
        count = len(next(iter(inputs.values())))
        rows = []
        with np.errstate(all="ignore"):
            for k in range(count):
                outputs = self({name: column[k] for name, column in inputs.items()})
                rows.append([*outputs, *(float(content[0]) for content in self._kept)])
        return np.array(rows)

    def __call__(self, given: dict[str, float]) -> list[float]:
        program = self.program
        arguments = [
            *(content[0] for content in self._kept),
            *(F(given[signal.name]) for signal in program.inputs),
            *(
                _tuned(given.get(signal.name, math.nan), value)
                for signal, value in zip(program.parameters, self.parameters, strict=True)
            ),
        ]
        results = self._block(program.block, arguments)
        for content, value in zip(self._kept, results, strict=False):
            content.popleft()
            content.append(value)
        return [float(value) for value in results[len(self._kept) :]]

    def _block(self, block: Block, arguments: list) -> list:
        values = dict(enumerate(arguments))
        for statement in block.statements:
            if isinstance(statement, Operation):
                if statement.code == "constant":
                    values[statement.target] = single(statement.constant)
                else:
                    operands = [values[value] for value in statement.arguments]
                    values[statement.target] = MEANING[statement.code](*operands)
                continue
            carried = [values[value] for value in statement.carried]
            invariants = [values[value] for value in statement.invariants]
            if isinstance(statement, ForLoop):
                carried = self._turns(statement, carried, invariants)
            else:
                assert isinstance(statement, Conditional)
                if values[statement.condition]:
                    carried = self._block(statement.body, [*carried, *invariants])
            values.update(zip(statement.targets, carried, strict=True))
        return [values[value] for value in block.results]

    def _turns(self, loop: ForLoop, carried: list, invariants: list) -> list:
        contents = [self._rings[ring.name] for ring in loop.rings]
        for turn in range(loop.count):
            row = [single(table[turn]) for table in loop.tables]
            oldest = [content[0] for content in contents]
            results = self._block(loop.body, [*row, *carried, *oldest, *invariants])
            carried = results[: len(carried)]
            for content, value in zip(contents, results[len(carried) :], strict=True):
                content.popleft()
                content.append(value)
        return carried


def _tuned(given: float, own: F) -> F:
    """A parameter that is not a number in a scan keeps the value that it was printed with."""
    return own if math.isnan(given) else F(given)


def _content(entry) -> deque:
    ring = isinstance(entry, DelayRing)
    signal = entry.signal if ring else entry
    return deque([single(signal.initial)] * (entry.length if ring else 1))


def single_bits(values: np.ndarray) -> np.ndarray:
    """The bits of single-precision numbers; every not-a-number counts as the same one."""
    narrow = np.ascontiguousarray(values, dtype=float).astype(np.float32)
    assert np.array_equal(narrow.astype(float), values, equal_nan=True), "no single precision"
    return np.where(np.isnan(narrow), -1, narrow.view(np.int32).astype(np.int64))
