"""Proof that a value is a whole number within bounds, before a program declares it integer."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.program.called_blocks import without_untold
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import COMPARISONS, LOGIC, Operation
from clepsydra.program.owned_state import with_owned_state
from clepsydra.program.precision import Precision, in_precision
from clepsydra.program.program import Block, Call, Conditional, Program

INTEGER_LOW, INTEGER_HIGH = -(2.0**31), 2.0**31 - 1.0
#: Sums and products of whole numbers up to this size are exact.
_EXACT = 2.0**53
#: Every whole number up to this size is a single-precision number; the next one is none.
SINGLE_WHOLE = 2.0**24
#: Lowest and highest integer that is computed with, and what the user is told.
INTEGERS: dict[Precision, tuple[float, float, str]] = {
    "double": (INTEGER_LOW, INTEGER_HIGH, "a whole number of at most 32 bits"),
    "single": (
        -SINGLE_WHOLE,
        SINGLE_WHOLE,
        f"a whole number from {-SINGLE_WHOLE:.0f} to {SINGLE_WHOLE:.0f} in single precision",
    ),
}


@dataclass(frozen=True)
class WholeRange:
    """Bounds of a whole number; with `maybe_nan` it may also be not a number.

    Examples
    --------
    >>> WholeRange(0.0, 127.0).within(0.0, 255.0), WholeRange(0.0, 1.0, maybe_nan=True).within(0, 1)
    (True, False)
    """

    low: float
    high: float
    maybe_nan: bool = False

    def within(self, low: float, high: float) -> bool:
        """Whether every value that it may take is a number between the bounds."""
        return not self.maybe_nan and low <= self.low and self.high <= high


_TRUTH = WholeRange(0.0, 1.0)
_ANY = WholeRange(-math.inf, math.inf, maybe_nan=True)
#: Operations on two whole numbers whose bounds are among those of the operands' bounds.
_CORNERS: dict[str, Callable[[float, float], float]] = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
}


def printed_form(program: Program, precision: Precision) -> Program:
    """Return a program whose calls own their state and tell nothing that nobody reads.

    Structured Text has no fused operation, and a controller must compute the same bits
    everywhere.

    Raises
    ------
    InputError
        It is no program, some operation is fused, or it cannot be printed in that precision.
    ValueError
        Two blocks of one name compute different things.

    Examples
    --------
    >>> fused = Block(1, (Operation(1, "multiply", (0, 0), fused=True),), (1,))
    >>> try:
    ...     printed_form(Program("law", (), (Signal("u"),), (), (Signal("y"),), fused), "double")
    ... except InputError as error:
    ...     print(error.value)
    a fused multiply
    """
    remedy = "give controller.program(), or program_of(law) of a step law"
    require_type(program, Program, "print", "a Program", remedy)
    for operation in program.block.operations():
        if operation.fused:
            place = f"program {program.name}, value {operation.target}"
            expected = "a program without fused operations"
            remedy = "print the controller's own program, or a process without fused operations"
            raise InputError(place, f"a fused {operation.code}", expected, remedy)
    program = without_untold(with_owned_state(in_precision(program, precision)))
    check_whole_results(program, precision)
    return program


def check_whole_results(
    program: Program, precision: Precision = "double", given: Mapping[int, WholeRange] | None = None
) -> None:
    """Refuse a program whose integer or boolean results may be anything else.

    A conversion to an integer type rounds in one language, cuts off in another and is undefined
    outside the type's range; so it is printed only where nothing of that can happen. In single
    precision integers are computed with as numbers of 24 bits: results must be proved to stay
    within these, and inputs and parameters declared to, by their range or their value.

    Parameters
    ----------
    program : Program
    precision : {"double", "single"}
    given : mapping, optional
        Of a block, the bounds of its integer arguments where it is called.

    Raises
    ------
    InputError
        A state or output is declared integer and may leave the 32-bit integers, or those of 24
        bits in single precision, or is declared boolean and may be other than 0 or 1; or an
        initial value is none; or a ring of a loop is declared integer or boolean.

    Examples
    --------
    A comparison is 0 or 1, so it may be declared boolean:

    >>> block = Block(2, (Operation(2, "less", (0, 1)), Operation(3, "number", (2,))), (3,))
    >>> inputs = (Signal("level", "m"), Signal("limit", "m"))
    >>> program = Program("law", (), inputs, (), (Signal("low", kind="boolean"),), block)
    >>> check_whole_results(program)
    """
    ranges = whole_ranges(program, precision, given)
    integers = {value for value, entry in enumerate(program.given) if entry.kind == "integer"}
    for call in program.calls:
        check_whole_results(call.program, precision, _given(call, ranges))
        ports = [*map(signal_of, call.program.state), *call.program.inputs]
        for signal, value in zip(ports, call.arguments, strict=True):
            # An integer is handed on as it is.
            if not (signal.kind == "integer" and value in integers):
                _check(call.program, signal, ranges.get(value), precision)
    declared = [*map(signal_of, program.state), *program.outputs]
    for signal, value in zip(declared, program.block.results, strict=True):
        _check(program, signal, ranges.get(value), precision)
    for ring in program.rings:
        _check(program, ring.signal, None, precision)
    for signal in program.given:
        _check(program, signal, _whole(signal.initial), precision, initial=True)
    for signal in program.inputs if precision == "single" else ():
        known = signal.low >= -SINGLE_WHOLE and signal.high <= SINGLE_WHOLE
        if signal.kind == "integer" and not known:
            raise InputError(
                f"program {program.name}, {signal.name}",
                f"an integer from {signal.low:.12g} to {signal.high:.12g}",
                f"a range within {-SINGLE_WHOLE:.0f} and {SINGLE_WHOLE:.0f} in single precision",
                "declare its range (low, high), or print it in double precision",
            )


def _check(
    program: Program,
    signal: Signal,
    found: WholeRange | None,
    precision: Precision,
    *,
    initial: bool = False,
) -> None:
    low, high, expected = INTEGERS[precision]
    remedy = "round it with floor and limit it with fmin and fmax, or declare it real"
    remedy += ", or print it in double precision" if precision == "single" else ""
    if signal.kind == "boolean":
        low, high = 0.0, 1.0
        expected, remedy = "0 or 1", "write it as a comparison, or declare it real"
    if signal.kind != "real" and not (found and found.within(low, high)):
        place = f"program {program.name}, {'initial value of ' if initial else ''}{signal.name}"
        raise InputError(place, signal.initial if initial else _shown(found), expected, remedy)


def _shown(found: WholeRange | None) -> str:
    if found is None:
        return "a value that may be any number"
    beside = " or not a number" if found.maybe_nan else ""
    return f"a whole number from {found.low:.12g} to {found.high:.12g}{beside}"


def whole_ranges(
    program: Program, precision: Precision = "double", given: Mapping[int, WholeRange] | None = None
) -> dict[int, WholeRange]:
    """Return bounds of every value of a program that is certainly a whole number.

    Interval arithmetic along the list of operations: integer signals are 32-bit integers,
    boolean signals and comparisons 0 or 1; what comes out of a counted loop or of a real
    signal is not known to be whole. In single precision the bounds are rounded outwards: a
    rounded whole number is whole, and rounding changes no order. There a state counts as within
    ±2^24: so it starts, and `check_whole_results` demands that it goes on so.

    Examples
    --------
    >>> block = Block(2, (Operation(2, "less", (0, 1)), Operation(3, "number", (2,))), (3,))
    >>> inputs = (Signal("level", "m"), Signal("limit", "m"))
    >>> program = Program("law", (), inputs, (), (Signal("low", kind="boolean"),), block)
    >>> whole_ranges(program)[3]
    WholeRange(low=0.0, high=1.0, maybe_nan=False)
    """
    integer = WholeRange(INTEGER_LOW, INTEGER_HIGH)
    states, others = integer, integer
    if precision == "single":
        states, others = WholeRange(-SINGLE_WHOLE, SINGLE_WHOLE), _in_single(integer)
    ranges: dict[int, WholeRange] = {}
    for value, signal in enumerate(program.given):
        if signal.kind == "integer":
            known = states if value in program.state_arguments else others
            ranges[value] = (given or {}).get(value, known)
        elif signal.kind == "boolean":
            ranges[value] = _TRUTH
    _follow(program.block, ranges, precision)
    return ranges


def _follow(block: Block, ranges: dict[int, WholeRange], precision: Precision) -> None:
    # Bounds of quotients, which only rounding makes whole.
    quotients: dict[int, WholeRange] = {}
    for each in block.statements:
        if isinstance(each, Operation):
            operands = [ranges.get(value) for value in each.arguments]
            if each.code in ("floor", "ceiling"):
                operands = [operands[0] or quotients.get(each.arguments[0], _ANY)]
            found = _range_of(each, operands)
            if found is not None and each.code == "divide":
                quotients[each.target] = found
            elif found is not None:
                ranges[each.target] = found if precision == "double" else _in_single(found)
        elif isinstance(each, Conditional):
            given = enumerate(each.carried + each.invariants)
            inside = {argument: ranges[value] for argument, value in given if value in ranges}
            _follow(each.body, inside, precision)
            carried = zip(each.targets, each.carried, each.body.results, strict=True)
            for target, start, result in carried:
                if start in ranges and result in inside:
                    ranges[target] = _either(ranges[start], inside[result])
        elif isinstance(each, Call):
            inside = whole_ranges(each.program, precision, _given(each, ranges))
            for target, result in zip(each.targets, each.program.block.results, strict=True):
                if result in inside:
                    ranges[target] = inside[result]


def _given(call: Call, ranges: Mapping[int, WholeRange]) -> dict[int, WholeRange]:
    """Return the bounds of the arguments of a call, by their places in the block."""
    first = len(call.program.state)
    return {
        place: ranges[value]
        for place, value in enumerate(call.arguments)
        if place >= first and value in ranges
    }


def _in_single(found: WholeRange) -> WholeRange:
    low, high = (float(np.float32(bound)) for bound in (found.low, found.high))
    return WholeRange(min(low, found.low), max(high, found.high), found.maybe_nan)


def _whole(number: float) -> WholeRange | None:
    whole = math.isfinite(number) and number == math.floor(number)
    return WholeRange(number, number) if whole else None


def _range_of(operation: Operation, operands: list[WholeRange | None]) -> WholeRange | None:
    code = operation.code
    if code == "constant":
        return _whole(operation.constant)
    if code in COMPARISONS | LOGIC | {"number", "truth"}:
        return _TRUTH
    known = [*filter(None, operands[code == "select" :])]
    if len(known) != len(operands) - (code == "select") or not known:
        return None
    first, second = known[0], known[-1]
    if code == "select":
        return _either(first, second)
    if code in ("floor", "ceiling"):
        if not math.isfinite(first.low) or not math.isfinite(first.high):
            return first
        whole = math.floor if code == "floor" else math.ceil
        return WholeRange(whole(first.low), whole(first.high), first.maybe_nan)
    if code in ("maximum", "minimum"):
        return _extreme(code, first, second)
    if first.maybe_nan or second.maybe_nan or (code == "divide" and second.low < 1.0):
        return None
    bounds = [-first.high, -first.low]
    if code == "absolute":
        bounds = [0.0, max(-first.low, first.high)]
    elif code in _CORNERS:
        lows_and_highs = product((first.low, first.high), (second.low, second.high))
        bounds = [_CORNERS[code](a, b) for a, b in lows_and_highs]
    elif code != "negate":
        return None
    found = WholeRange(min(bounds), max(bounds))
    computed = code in ("add", "subtract", "multiply")
    return None if computed and not found.within(-_EXACT, _EXACT) else found


def _either(first: WholeRange, second: WholeRange) -> WholeRange:
    maybe_nan = first.maybe_nan or second.maybe_nan
    return WholeRange(min(first.low, second.low), max(first.high, second.high), maybe_nan)


def _extreme(code: str, first: WholeRange, second: WholeRange) -> WholeRange:
    """Return the bounds of ``a > b ? a : b``: whenever a or b is not a number, it is b."""
    take = max if code == "maximum" else min
    found = WholeRange(take(first.low, second.low), take(first.high, second.high), second.maybe_nan)
    return _either(found, second) if first.maybe_nan else found
