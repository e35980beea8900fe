"""Builds a program value by value: numbers values, shares equal ones, folds constants."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import COMPARISONS, EXACT, LIBRARY, LOGIC, TO_SINGLE, Operation
from clepsydra.program.program import Block, Call, Conditional, ForLoop, Program, Statement
from clepsydra.program.routine import Routine, RoutineCall

#: What an operation makes of constants.
_FOLDED: dict[str, Callable[..., Any]] = {
    "add": np.add,
    "subtract": np.subtract,
    "multiply": np.multiply,
    "divide": np.divide,
    "square_root": np.sqrt,
    "negate": np.negative,
    "absolute": np.abs,
    "floor": np.floor,
    "ceiling": np.ceil,
    "maximum": lambda a, b: a if a > b else b,
    "minimum": lambda a, b: a if a < b else b,
    "less": np.less,
    "less_equal": np.less_equal,
    "equal": np.equal,
    "not_equal": np.not_equal,
    "truth": lambda a: a != 0.0,
    TO_SINGLE: np.float32,
}

_KNOWN = EXACT | LIBRARY.keys() | {TO_SINGLE}
_MAKE_TRUTHS = COMPARISONS | LOGIC | {"truth"}
_ZERO = bytes(8)


class BlockBuilder:
    """Collects the statements of one block.

    Equal operations on equal values are computed once; operations on constants are folded,
    with the same IEEE arithmetic that a target would use; what nobody reads is dropped when
    the block is finished. None of the three changes a bit of any result. CasADi's form of a
    choice is read as one `select`, which keeps a negative zero that CasADi makes positive.

    Parameters
    ----------
    arguments : int
        Number of arguments of the block; they are the values 0 … arguments-1.

    Examples
    --------
    >>> builder = BlockBuilder(2)
    >>> total = builder.operation("add", 0, 1)
    >>> builder.operation("add", 0, 1) == total
    True
    >>> len(builder.finish([builder.operation("square_root", total)]).statements)
    2
    """

    def __init__(self, arguments: int) -> None:
        self._arguments = arguments
        self._next = arguments
        self._statements: list[Statement] = []
        self._known: dict[tuple[object, ...], int] = {}
        self._made: dict[int, Operation] = {}
        self._truths: set[int] = set()
        #: Numbers that are 0 or 1, since a block returns them as truth values.
        self._flags: set[int] = set()

    def constant(self, value: float) -> int:
        """Return the value that holds a constant."""
        return self._emit("constant", (), constant=float(value))

    def operation(self, code: str, *arguments: int, fused: bool = False) -> int:
        """Return the value of an operation, converting between numbers and truth values."""
        if code not in _KNOWN:
            raise ValueError(f"unknown operation {code!r}")
        if code in ("number", "truth"):
            (value,) = arguments
            if (value in self._truths) == (code == "truth"):
                return value
            made = self._made.get(value)
            codes = (code, made.code) if made else ()
            if made and (
                codes == ("truth", "number")
                or (codes == ("number", "truth") and made.arguments[0] in self._flags)
            ):
                return made.arguments[0]
        else:
            arguments = self._converted(code, arguments)
        simpler = self._simplified(code, arguments)
        if simpler is not None:
            return simpler
        return self._emit(code, arguments, fused=fused)

    def is_constant(self, value: int) -> bool:
        """Whether a value is a constant."""
        return self._constant_of(value) is not None

    def known_truth(self, value: int) -> bool | None:
        """Return what a condition is, whatever the block is given; None where it varies.

        >>> builder = BlockBuilder(1)
        >>> never = builder.operation("and", builder.constant(0.0), 0)
        >>> builder.known_truth(never), builder.known_truth(0)
        (False, None)
        """
        made = self._made.get(value)
        value = made.arguments[0] if made and made.code == "number" else value
        if value in self._truths:
            return self._truth_of(value)
        number = self._constant_of(value)
        return None if number is None else number != 0.0

    def loop(
        self,
        name: str,
        body: Block,
        count: int,
        tables: Sequence[Sequence[float]],
        carried: Sequence[int],
        invariants: Sequence[int],
        rings: Sequence[DelayRing] = (),
        *,
        adjustable: bool = False,
    ) -> tuple[int, ...]:
        """Return the carried values after `count` turns of a body, see `ForLoop`."""
        start, held = self._numbers(carried), self._numbers(invariants)
        targets = self._targets(len(start))
        rows = tuple(tuple(float(entry) for entry in table) for table in tables)
        self._statements.append(
            ForLoop(targets, count, body, rows, start, held, name, tuple(rings), adjustable)
        )
        return targets

    def conditional(
        self,
        name: str,
        condition: int,
        body: Block,
        carried: Sequence[int],
        invariants: Sequence[int],
    ) -> tuple[int, ...]:
        """Return what a body makes of the carried values where a condition is true.

        >>> builder, half = BlockBuilder(2), BlockBuilder(1)
        >>> body = half.finish([half.operation("multiply", 0, half.constant(0.5))])
        >>> (value,) = builder.conditional("halve", builder.operation("less", 1, 0), body, [0], [])
        >>> [type(statement).__name__ for statement in builder.finish([value]).statements]
        ['Operation', 'Conditional']
        """
        condition = self.operation("truth", condition)
        start, held = self._numbers(carried), self._numbers(invariants)
        if self._truth_of(condition) is False:
            return start
        targets = self._targets(len(start))
        self._statements.append(Conditional(targets, condition, body, start, held, name))
        return targets

    def call(self, program: Program, instance: str, arguments: Sequence[int]) -> tuple[int, ...]:
        """Return next state and outputs of a block, which stays a block of its own."""
        given = self._numbers(arguments)
        targets = self._targets(len(program.state) + len(program.outputs))
        self._statements.append(Call(targets, program, instance, given))
        results = zip(program.outputs, targets[len(program.state) :], strict=True)
        self._flags.update(target for signal, target in results if signal.kind == "boolean")
        return targets

    def routine(
        self,
        routine: Routine,
        arguments: Sequence[int],
        tables: Sequence[tuple[float, ...]] = (),
        condition: int | None = None,
    ) -> tuple[int, ...]:
        """Return the results of a routine; an array that is given as numbers becomes a table.

        Parameters
        ----------
        routine : Routine
        arguments : sequence of int
            The elements of all its arguments, or of those that have no table.
        tables : sequence of tuple of float
            The numbers of each argument where they are known already, else none.
        condition : int, optional
            Where it is false the routine is passed over, and its results are zero.
        """
        given, found = list(self._numbers(arguments)), list[tuple[float, ...]]()
        kept: list[int] = []
        for place, array in enumerate(routine.arguments):
            table = tables[place] if tables else ()
            if not table:
                values, given = given[: array.size], given[array.size :]
                known = [self._constant_of(value) for value in values]
                numbers = tuple(number for number in known if number is not None)
                table = numbers if len(numbers) == array.size else ()
                kept += [] if table else values
            found.append(table)
        size = sum(array.size for array in routine.results)
        if condition is not None:
            inner = BlockBuilder(size + len(kept))
            results = inner.routine(routine, range(size, size + len(kept)), found)
            zeros = [self.constant(0.0)] * size
            body = inner.finish(results)
            return self.conditional(routine.name, condition, body, zeros, kept)
        targets = self._targets(size)
        self._statements.append(RoutineCall(targets, routine, tuple(kept), tuple(found)))
        return targets

    def finish(self, results: Sequence[int]) -> Block:
        """Return the block, without the statements that nobody reads."""
        final = tuple(self.operation("number", value) for value in results)
        truths = frozenset(self._truths)
        return Block(self._arguments, tuple(self._statements), final, truths).without_unread()

    def _numbers(self, values: Sequence[int]) -> tuple[int, ...]:
        return tuple(self.operation("number", value) for value in values)

    def _targets(self, count: int) -> tuple[int, ...]:
        targets = tuple(range(self._next, self._next + count))
        self._next += count
        return targets

    def _emit(
        self, code: str, arguments: tuple[int, ...], constant: float = 0.0, fused: bool = False
    ) -> int:
        # By its bits: equal numbers may be zeros of different sign.
        bits = struct.pack("<d", constant) if code == "constant" else _ZERO
        key = (code, arguments, bits, fused)
        if key in self._known:
            return self._known[key]
        target = self._next
        self._next += 1
        operation = Operation(target, code, arguments, constant, fused)
        self._statements.append(operation)
        self._known[key] = target
        self._made[target] = operation
        if code in _MAKE_TRUTHS:
            self._truths.add(target)
        return target

    def _converted(self, code: str, arguments: tuple[int, ...]) -> tuple[int, ...]:
        truths = len(arguments) if code in LOGIC else int(code == "select")
        if not truths and self._truths.isdisjoint(arguments):
            return arguments
        return tuple(
            self.operation("truth" if place < truths else "number", value)
            for place, value in enumerate(arguments)
        )

    def _simplified(self, code: str, arguments: tuple[int, ...]) -> int | None:
        if code in LOGIC:
            return self._simplified_logic(code, arguments)
        if code == "select":
            return self._simplified_select(*arguments)
        constants = [self._constant_of(value) for value in arguments]
        if None not in constants:
            return self._folded(code, constants)
        if code == "add":
            return self._complementary_selects(*arguments)
        # Drop a multiplication or division by one; adding zero stays, for the sign of zero.
        if code == "multiply" and constants[0] == 1.0:
            return arguments[1]
        return arguments[0] if code in ("multiply", "divide") and constants[1] == 1.0 else None

    def _folded(self, code: str, values: Sequence[float | None]) -> int | None:
        if code not in _FOLDED:
            return None
        with np.errstate(all="ignore"):
            found = _FOLDED[code](*map(np.float64, values))
        truth = code in COMPARISONS or code == "truth"
        return self._truth_constant(bool(found)) if truth else self.constant(float(found))

    def _simplified_logic(self, code: str, arguments: tuple[int, ...]) -> int | None:
        known = [self._truth_of(value) for value in arguments]
        if code == "not":
            inner = self._made.get(arguments[0])
            if inner is not None and inner.code == "not":
                return inner.arguments[0]
            return None if known[0] is None else self._truth_constant(not known[0])
        decisive = code == "or"
        if decisive in known:
            return self._truth_constant(decisive)
        for position, value in enumerate(known):
            if value is not None:
                return arguments[1 - position]
        return arguments[0] if arguments[0] == arguments[1] else None

    def _simplified_select(self, condition: int, first: int, second: int) -> int | None:
        known = self._truth_of(condition)
        if known is not None:
            return first if known else second
        if first == second:
            return first
        inner = self._made.get(condition)
        if inner is not None and inner.code == "not":
            return self.operation("select", inner.arguments[0], second, first)
        return None

    def _complementary_selects(self, left: int, right: int) -> int | None:
        """Read ``(c ? a : 0) + (c ? 0 : b)``, CasADi's form of a choice, as ``c ? a : b``."""
        first, second = self._made.get(left), self._made.get(right)
        if first is None or second is None or not first.code == second.code == "select":
            return None
        condition, one, zero = first.arguments
        other_condition, other_zero, other = second.arguments
        plus_zero = self._known.get(("constant", (), _ZERO, False))
        if condition == other_condition and zero == other_zero == plus_zero:
            return self.operation("select", condition, one, other)
        return None

    def _constant_of(self, value: int) -> float | None:
        made = self._made.get(value)
        return made.constant if made is not None and made.code == "constant" else None

    def _truth_of(self, value: int) -> bool | None:
        made = self._made.get(value)
        if made is None or made.code != "truth":
            return None
        constant = self._constant_of(made.arguments[0])
        return None if constant is None else constant != 0.0

    def _truth_constant(self, value: bool) -> int:
        constant = self.constant(1.0 if value else 0.0)
        return self._emit("truth", (constant,))
