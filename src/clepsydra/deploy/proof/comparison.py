"""How far two runs of one program lie apart: differences, bits, decisions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.proof.instance import Array
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import EXACT
from clepsydra.program.program import Program

#: Largest difference of a law with exp, pow and other functions of a library, in double
#: precision, as a share of a signal's range.
LIBRARY_BOUND = 1e-12


@dataclass(frozen=True)
class Difference:
    """How far the numbers of one run lie from those of another.

    Parameters
    ----------
    largest : float
        Largest difference of a real number, as a share of its signal's range: of one without a
        finite range, of the largest number that the first run shows of it. Infinite where one of
        the two is not a number and the other is.
    signal : str
        The output or state with the largest difference; empty where there is none.
    scan : int
        Where it is, from 0; -1 where there is none.
    differing : int
        Numbers that differ in a bit; a not-a-number is equal to every other one.
    decisions : int
        Integer and boolean outputs and states that differ.
    first_decision : int
        The scan in which the first of them differs; -1 where none does.
    overflows : int
        Numbers that are infinite or not a number in the second run and finite in the first.

    Examples
    --------
    >>> Difference(0.0, "", -1, 0, 0, -1).largest
    0.0
    """

    largest: float
    signal: str
    scan: int
    differing: int
    decisions: int
    first_decision: int
    overflows: int = 0


def shown_signals(program: Program) -> tuple[Signal, ...]:
    """Return the signals of a table of outputs and states.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> program = Program("law", (Signal("x"),), (), (), (Signal("y"),), Block(1, (), (0, 0)))
    >>> [signal.name for signal in shown_signals(program)]
    ['y', 'x']
    """
    return (*program.outputs, *(signal_of(entry) for entry in program.state))


def compare(signals: Sequence[Signal], expected: Array, found: Array) -> Difference:
    """Compare two runs [scans, signals].

    Examples
    --------
    >>> y = Signal("y", low=0.0, high=10.0)
    >>> compare([y], np.array([[1.0], [np.nan]]), np.array([[1.5], [np.nan]]))
    Difference(largest=0.05, signal='y', scan=0, differing=1, decisions=0, first_decision=-1, \
overflows=0)
    """
    if expected.shape != found.shape or expected.shape[1] != len(signals):
        raise ValueError(f"tables of {expected.shape} and {found.shape} for {len(signals)} signals")
    decided = np.array([signal.kind != "real" for signal in signals], dtype=bool)
    # A zero that is an integer has no sign.
    expected, found = (np.where(decided, table + 0.0, table) for table in (expected, found))
    differs = _bits(expected) != _bits(found)
    wrong = np.flatnonzero(differs[:, decided].any(axis=1))
    largest, signal, scan = 0.0, "", -1
    for column in np.flatnonzero(~decided & differs.any(axis=0)).tolist():
        shares = _shares(signals[column], expected[:, column], found[:, column])
        place = int(np.argmax(shares))
        if scan < 0 or shares[place] > largest:
            largest, signal, scan = float(shares[place]), signals[column].name, place
    return Difference(
        largest, signal, scan, int(differs.sum()), int(differs[:, decided].sum()),
        int(wrong[0]) if len(wrong) else -1,
        int((np.isfinite(expected) & ~np.isfinite(found)).sum()),
    )  # fmt: skip


def is_exact(program: Program) -> bool:
    """Whether a program has only operations that every target computes to the last bit.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> power = Block(1, (Operation(1, "exp", (0,)),), (1,))
    >>> is_exact(Program("law", (), (Signal("u"),), (), (Signal("y"),), power))
    False
    """
    return all(operation.code in EXACT for operation in program.block.operations())


def double_bound(program: Program) -> float:
    """Return the bound in double precision: 0, or that of functions of a library.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> double_bound(Program("nothing", (), (), (), (), Block(0, (), ())))
    0.0
    """
    return 0.0 if is_exact(program) else LIBRARY_BOUND


def _bits(table: Array) -> np.ndarray:
    table = np.ascontiguousarray(table, dtype=float)
    return np.where(np.isnan(table), -1, table.view(np.int64))


def _shares(signal: Signal, expected: Array, found: Array) -> Array:
    span = signal.span
    if not (math.isfinite(span) and span > 0.0):
        numbers = np.abs(expected[np.isfinite(expected)])
        span = float(numbers.max()) if numbers.size and numbers.max() > 0.0 else 1.0
    with np.errstate(all="ignore"):
        shares = np.abs(found - expected) / span
    same = _bits(expected) == _bits(found)
    return np.where(same, 0.0, np.where(np.isnan(shares), math.inf, shares))
