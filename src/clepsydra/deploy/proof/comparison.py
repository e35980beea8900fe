"""How far two runs of one program lie apart: differences, bits, decisions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.row import Verdict
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import EXACT
from clepsydra.program.program import Program

#: Largest difference of a law with exp, pow and other functions of a library, in double
#: precision, as a share of a signal's range.
LIBRARY_BOUND = 1e-12
#: Two runs that lie further apart than the range of a signal, as a share of it, have diverged.
DIVERGED = 1.0


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
    overflows : int
        Numbers that are infinite or not a number in the second run and finite in the first.
    """

    largest: float
    signal: str
    scan: int
    differing: int
    decisions: int
    overflows: int = 0


def shown_signals(program: Program) -> tuple[Signal, ...]:
    """Return the signals of a table of outputs and states."""
    return (*program.outputs, *(signal_of(entry) for entry in program.state))


def compare(signals: Sequence[Signal], expected: Array, found: Array) -> Difference:
    """Compare two runs [scans, signals].

    Examples
    --------
    >>> y = Signal("y", low=0.0, high=10.0)
    >>> compare([y], np.array([[1.0], [np.nan]]), np.array([[1.5], [np.nan]]))
    Difference(largest=0.05, signal='y', scan=0, differing=1, decisions=0, overflows=0)
    """
    if expected.shape != found.shape or expected.shape[1] != len(signals):
        raise ValueError(f"tables of {expected.shape} and {found.shape} for {len(signals)} signals")
    decided = np.array([signal.kind != "real" for signal in signals], dtype=bool)
    # A zero that is an integer has no sign.
    expected, found = (np.where(decided, table + 0.0, table) for table in (expected, found))
    differs = _bits(expected) != _bits(found)
    largest, signal, scan = 0.0, "", -1
    for column in np.flatnonzero(~decided & differs.any(axis=0)).tolist():
        shares = _shares(signals[column], expected[:, column], found[:, column])
        place = int(np.argmax(shares))
        if scan < 0 or shares[place] > largest:
            largest, signal, scan = float(shares[place]), signals[column].name, place
    overflows = np.isfinite(expected) & ~np.isfinite(found)
    decisions = differs[:, decided]
    counts = (int(each.sum()) for each in (differs, decisions, overflows))
    return Difference(largest, signal, scan, *counts)


def verdict(difference: Difference, bound: float | None) -> Verdict:
    """Return the verdict of a difference; without a bound it is only reported.

    Examples
    --------
    >>> verdict(Difference(1e-3, "y", 0, 1, 0), None)
    'reported'
    """
    if difference.differing == 0:
        return "equal"
    if bound is None:
        # Rounding may move a number, and turn none into what is infinite or not a number.
        if difference.overflows:
            return "differs"
        return "diverges" if difference.largest > DIVERGED else "reported"
    # Where nothing but exact operations are, the sign of a zero counts too; and a decision that
    # differs is no matter of a bound.
    within = bound > 0.0 and difference.largest <= bound and difference.decisions == 0
    return "within the bound" if within else "differs"


def is_exact(program: Program) -> bool:
    """Whether a program has only operations that every target computes to the last bit."""
    return all(operation.code in EXACT for operation in program.block.operations())


def double_bound(program: Program) -> float:
    """Return the bound in double precision: 0, or that of functions of a library."""
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
