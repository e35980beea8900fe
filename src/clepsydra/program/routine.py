"""Routines: algorithms over arrays in counted loops, and the call of one in a program."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Any

from clepsydra.program.operation import Operation


@dataclass(frozen=True)
class Index:
    """A whole number that follows from the indices of loops: constant + Σ factor · index.

    Parameters
    ----------
    constant : int
    factors : tuple of (str, int)
        Of the loops around, the innermost last.

    Examples
    --------
    >>> row, column = Index(0, (("i", 1),)), Index(0, (("k", 1),))
    >>> (10 * row + column + 1).at({"i": 2, "k": 3})
    24
    """

    constant: int = 0
    factors: tuple[tuple[str, int], ...] = ()

    def __add__(self, other: Index | int) -> Index:
        """Return the sum."""
        other = other if isinstance(other, Index) else Index(other)
        factors = dict(self.factors)
        for name, factor in other.factors:
            factors[name] = factors.get(name, 0) + factor
        kept = tuple((name, factor) for name, factor in factors.items() if factor)
        return Index(self.constant + other.constant, kept)

    def __sub__(self, other: Index | int) -> Index:
        """Return the difference."""
        return self + -1 * other

    def __mul__(self, factor: int) -> Index:
        """Return a multiple."""
        factors = tuple((name, factor * each) for name, each in self.factors if factor)
        return Index(factor * self.constant, factors)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: int) -> Index:
        """Return the difference."""
        return -1 * self + other

    def at(self, indices: Mapping[str, int]) -> int:
        """Return the number where the loops are at some indices."""
        return self.constant + sum(factor * indices[name] for name, factor in self.factors)


@dataclass(frozen=True)
class Array:
    """An array of a routine.

    Parameters
    ----------
    name : str
        An identifier.
    shape : tuple of int
        Empty for a single number.

    Examples
    --------
    >>> Array("weight", (2, 3)).size
    6
    """

    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return prod(self.shape)


@dataclass(frozen=True)
class Element:
    """One number of an array, counted row by row.

    Examples
    --------
    >>> Element("weight", Index(2, (("i", 3),))).index.at({"i": 1})
    5
    """

    array: str
    index: Index


@dataclass(frozen=True)
class Step:
    """What a routine computes at once: one element from others.

    Parameters
    ----------
    written : Element
    read : tuple of Element
        Their numbers are the values 0, 1, … of the operations.
    operations : tuple of Operation
    result : int
        The value that is written.
    truths : frozenset of int
        Those values that are truth values.
    """

    written: Element
    read: tuple[Element, ...]
    operations: tuple[Operation, ...]
    result: int
    truths: frozenset[int]


@dataclass(frozen=True)
class Note:
    """What a reader is told of the steps that follow."""

    text: str


@dataclass(frozen=True)
class Turns:
    """A counted loop: ``for index in first … stop - 1``; none where stop is not above first."""

    index: str
    first: Index
    stop: Index
    steps: tuple[Step | Turns | Note, ...]


@dataclass(frozen=True)
class Routine:
    """An algorithm over arrays in counted loops, written by `routine_writer.routine`.

    Parameters
    ----------
    name : str
        An identifier.
    arguments, results, local : tuple of Array
        What is given and only read; what is computed; and what is kept on the way.
    steps : tuple of Step, Turns or Note
    description : str
        What it computes, in a line for its reader.
    """

    name: str
    arguments: tuple[Array, ...]
    results: tuple[Array, ...]
    local: tuple[Array, ...]
    steps: tuple[Step | Turns | Note, ...]
    description: str = ""

    def every_step(self) -> Iterator[Step]:
        """Yield each step, once a place."""
        return _steps(self.steps)

    def operations(self) -> Iterator[Operation]:
        """Yield every operation of its steps, once a place."""
        for step in self.every_step():
            yield from step.operations

    def computed(self) -> Iterator[Operation]:
        """Yield every operation as often as a call computes it."""
        for step, _ in _every(self.steps, {}):
            yield from step.operations

    def extent(self) -> int:
        """Return how many operations a call computes, without going through all of them."""
        return _extent(self.steps, {})

    def needed(self, results: Iterable[str]) -> Routine:
        """Return the routine without the steps that only feed what nothing reads.

        Parameters
        ----------
        results : iterable of str
            The arrays of its results that are read.
        """
        wanted: set[str] = set()
        found = {*results}
        while found != wanted:
            wanted = found
            steps = (step for step in self.every_step() if step.written.array in wanted)
            found = wanted.union(*({each.array for each in step.read} for step in steps))
        return replace(self, steps=_kept(self.steps, wanted))

    def read(self) -> dict[str, set[int]]:
        """Return which elements of each array some step reads."""
        found: dict[str, set[int]] = {}
        for step, at in _every(self.steps, {}):
            for element in step.read:
                found.setdefault(element.array, set()).add(element.index.at(at))
        return found


@dataclass(frozen=True)
class RoutineCall:
    """A call of a routine, computed where it stands.

    Parameters
    ----------
    targets : tuple of int
        Values that hold the elements of the results, row by row, one array behind the other.
    routine : Routine
    arguments : tuple of int
        The elements of those arrays of its arguments that have no table.
    tables : tuple of tuple of float
        For each array of its arguments its numbers where they are known, else none.
    """

    targets: tuple[int, ...]
    routine: Routine
    arguments: tuple[int, ...]
    tables: tuple[tuple[float, ...], ...]

    def with_steps(self, change: Callable[[Step], Step]) -> RoutineCall:
        """Return the call with the steps of its routine changed."""
        steps = _changed(self.routine.steps, change)
        return replace(self, routine=replace(self.routine, steps=steps))

    def with_operations(self, change: Callable[[Any], Any]) -> RoutineCall:
        """Return the call with the operations of its routine changed."""

        def changed(step: Step) -> Step:
            return replace(step, operations=tuple(map(change, step.operations)))

        return self.with_steps(changed)

    def needed(self, read: Container[int]) -> RoutineCall:
        """Return the call without the steps that only feed what nothing reads.

        `read`: the values that are read behind the call.
        """
        results = [array.name for array, values in self.told if any(v in read for v in values)]
        return replace(self, routine=self.routine.needed(results))

    @property
    def arguments_read(self) -> Iterator[int]:
        """Yield those of its arguments that some step reads."""
        read = self.routine.read()
        for array, _, values in self.given:
            yield from (v for place, v in enumerate(values) if place in read.get(array.name, ()))

    @property
    def given(self) -> Iterator[tuple[Array, tuple[float, ...], tuple[int, ...]]]:
        """Yield each array of the arguments with its table or its values."""
        place = 0
        for array, table in zip(self.routine.arguments, self.tables, strict=True):
            size = 0 if table else array.size
            yield array, table, self.arguments[place : place + size]
            place += size

    @property
    def told(self) -> Iterator[tuple[Array, tuple[int, ...]]]:
        """Yield each array of the results with its values."""
        place = 0
        for array in self.routine.results:
            yield array, self.targets[place : place + array.size]
            place += array.size


def _steps(steps: tuple[Step | Turns | Note, ...]) -> Iterator[Step]:
    for each in steps:
        if isinstance(each, Turns):
            yield from _steps(each.steps)
        elif isinstance(each, Step):
            yield each


def _changed(
    steps: tuple[Step | Turns | Note, ...], change: Callable[[Step], Step]
) -> tuple[Step | Turns | Note, ...]:
    found: list[Step | Turns | Note] = []
    for each in steps:
        if isinstance(each, Turns):
            each = replace(each, steps=_changed(each.steps, change))
        found.append(change(each) if isinstance(each, Step) else each)
    return tuple(found)


def _kept(
    steps: tuple[Step | Turns | Note, ...], written: set[str]
) -> tuple[Step | Turns | Note, ...]:
    """Return the steps that write some arrays, and what is told of them."""
    found: list[Step | Turns | Note] = []
    for each in reversed(steps):
        if isinstance(each, Turns):
            inside = _kept(each.steps, written)
            found += [replace(each, steps=inside)] if inside else []
        elif isinstance(each, Step):
            found += [each] if each.written.array in written else []
        elif found and not isinstance(found[-1], Note):
            found.append(each)
    return tuple(reversed(found))


def _every(
    steps: tuple[Step | Turns | Note, ...], at: Mapping[str, int]
) -> Iterator[tuple[Step, Mapping[str, int]]]:
    """Yield each step as often as it is taken, with the indices of the loops around it."""
    for each in steps:
        if isinstance(each, Step):
            yield each, at
        elif isinstance(each, Turns):
            for index in range(each.first.at(at), each.stop.at(at)):
                yield from _every(each.steps, {**at, each.index: index})


def _extent(steps: tuple[Step | Turns | Note, ...], at: Mapping[str, int]) -> int:
    """Return how many operations steps compute, turn by turn only where turns differ in that."""
    found = 0
    for each in steps:
        if isinstance(each, Step):
            found += len(each.operations)
        elif isinstance(each, Turns):
            turns = range(each.first.at(at), each.stop.at(at))
            if _is_bound_by(each.index, each.steps):
                found += sum(_extent(each.steps, {**at, each.index: turn}) for turn in turns)
            elif turns:
                found += len(turns) * _extent(each.steps, at)
    return found


def _is_bound_by(index: str, steps: tuple[Step | Turns | Note, ...]) -> bool:
    """Return whether a loop among steps begins or ends where an index says."""
    return any(
        index in dict(each.first.factors + each.stop.factors) or _is_bound_by(index, each.steps)
        for each in steps
        if isinstance(each, Turns)
    )
