"""Writes a routine from Python that names its loops, and computes it in expressions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import count
from typing import Any, Protocol, cast

import casadi as ca

from clepsydra.program.builder import BlockBuilder
from clepsydra.program.expression_reader import read_expressions
from clepsydra.program.operation import Operation
from clepsydra.program.routine import Array, Element, Index, Note, Routine, Step, Turns

Shape = tuple[int, ...]
#: Where an element stands: a number or an index for each dimension of its array.
Place = int | Index | tuple[int | Index, ...]


class Elements(Protocol):
    """An array as an algorithm has it: ``a[i, k]`` is an element, ``a[i, k] = …`` assigns it."""

    def __getitem__(self, place: Place) -> ca.SX:
        """Return an element."""

    def __setitem__(self, place: Place, value: ca.SX | float) -> None:
        """Assign an element."""


class Loops:
    """What an algorithm counts by: ``for i in loop("i", first, stop):``."""

    def __call__(self, name: str, first: int | Index, stop: int | Index) -> Iterator[Any]:
        """Yield the index of each turn."""
        raise NotImplementedError

    def again(self, name: str, turns: int) -> Iterator[None]:
        """Yield for each of so many turns that are all alike: nobody asks which it is."""
        for _ in self(name, 0, turns):
            yield

    def note(self, text: str) -> None:
        """Tell a reader what the steps that follow compute, in characters of ASCII."""


class _Written(Loops):
    """Writes the steps of an algorithm down, each loop once."""

    def __init__(self) -> None:
        self.steps: list[Step | Turns | Note] = []
        #: How often each array was written.
        self.versions: dict[str, int] = {}
        #: The loops around, by their indices and by a number that each has alone.
        self._around: tuple[tuple[str, int], ...] = ()
        self._numbers = count()

    def __call__(self, name: str, first: int | Index, stop: int | Index) -> Iterator[int | Index]:
        """Yield the index once, for all turns; a single turn needs no loop, and none is none."""
        if isinstance(first, int) and isinstance(stop, int) and stop <= first + 1:
            yield from range(first, stop)
            return
        if name in dict(self._around):
            raise ValueError(f"{name}: a loop around this one has the same index")
        outer, around = self.steps, self._around
        self.steps, self._around = [], (*around, (name, next(self._numbers)))
        yield Index(0, ((name, 1),))
        turns = Turns(name, Index() + first, Index() + stop, tuple(self.steps))
        self.steps, self._around = [*outer, turns], around

    def moment(self, array: str) -> object:
        """Return until when what is read of an array now is the number that stands there.

        Another turn of a loop may write the array, so a loop ends it on both its sides.
        """
        return self._around, self.versions.get(array, 0)

    def note(self, text: str) -> None:
        """Write a note down."""
        self.steps.append(Note(text))


class _Counted(Loops):
    """Computes every turn."""

    def __init__(self) -> None:
        self.arrays: list[_ComputedArray] = []

    def __call__(self, name: str, first: int | Index, stop: int | Index) -> Iterator[int]:
        """Yield the index of each turn."""
        assert isinstance(first, int) and isinstance(stop, int)
        yield from range(first, stop)

    def again(self, name: str, turns: int) -> Iterator[None]:
        """Yield once, for a function that is called in every turn."""
        known = self._numbers()
        before = ca.vertcat(*(value for _, _, value in known))
        given = ca.SX.sym("given", len(known))
        for (array, place, _), symbol in zip(known, ca.vertsplit(given), strict=True):
            array.values[place] = symbol
        yield
        # What a turn is the first to write is behind what it is given.
        first = {(id(array), place): k for k, (array, place, _) in enumerate(known)}
        found = sorted(self._numbers(), key=lambda e: first.get((id(e[0]), e[1]), len(first)))
        results = ca.vertcat(*(value for _, _, value in found))
        turn = ca.Function(name, [given], [results], {"never_inline": True})
        for _ in range(turns):
            results = turn(before)
            before = results[: len(known)]
        for (array, place, _), value in zip(found, ca.vertsplit(results), strict=True):
            array.values[place] = value

    def _numbers(self) -> list[tuple[_ComputedArray, int, ca.SX]]:
        """Return the numbers that stand somewhere."""
        return [
            (array, place, value)
            for array in self.arrays
            for place, value in enumerate(array.values)
            if value is not None
        ]


class _WrittenArray:
    """An array whose elements are named where they are read and written."""

    def __init__(self, array: Array, written: _Written, known: dict[str, tuple[Element, object]]):
        self.array, self._written, self._known = array, written, known

    def _element(self, place: Place) -> Element:
        places = place if isinstance(place, tuple) else (place,)
        if len(places) != len(self.array.shape):
            raise ValueError(f"{self.array.name}: {len(places)} indices for {self.array.shape}")
        index = Index()
        for size, each in zip(self.array.shape, places, strict=True):
            index = index * size + each
        return Element(self.array.name, index)

    def __getitem__(self, place: Place) -> ca.SX:
        symbol = ca.SX.sym(f"element_{len(self._known)}")
        self._known[symbol.name()] = self._element(place), self._written.moment(self.array.name)
        return symbol

    def __setitem__(self, place: Place, value: ca.SX | float) -> None:
        written, expression = self._element(place), ca.SX(value)
        symbols = ca.symvar(expression)
        read = [self._known[symbol.name()] for symbol in symbols]
        for element, moment in read:
            if moment != self._written.moment(element.array):
                raise ValueError(
                    f"{element.array} was written since it was read, or read in another loop: "
                    "read it where it is used"
                )
        self._written.steps.append(
            _step(written, [element for element, _ in read], symbols, expression)
        )
        versions = self._written.versions
        versions[self.array.name] = versions.get(self.array.name, 0) + 1


def _step(written: Element, read: list[Element], symbols: list[ca.SX], value: ca.SX) -> Step:
    """Return what computes an element from a value over the symbols of elements."""

    def called(function: ca.Function, _: list[int]) -> list[int]:
        raise ValueError(f"{function.name()}: a routine calls no function")

    builder, function = (
        BlockBuilder(len(symbols)),
        ca.Function("step", symbols, [ca.densify(value)]),
    )
    outputs = read_expressions(builder, function, range(len(symbols)), called)
    block = builder.finish([outputs[0, 0]])
    numbers = {value: value for value in range(block.arguments)}
    operations = []
    for each in block.statements:
        assert isinstance(each, Operation)
        given = tuple(numbers[value] for value in each.arguments)
        numbers[each.target] = len(numbers)
        operations.append(replace(each, target=numbers[each.target], arguments=given))
    truths = frozenset(numbers[value] for value in block.truths)
    result = numbers[block.results[0]]
    return Step(written, tuple(read), tuple(operations), result, truths)


class _ComputedArray:
    """An array of expressions."""

    def __init__(self, array: Array, values: list[ca.SX | None]) -> None:
        self.array, self.values = array, values

    def _place(self, place: Place) -> int:
        found = 0
        places = place if isinstance(place, tuple) else (place,)
        for size, each in zip(self.array.shape, places, strict=True):
            if not 0 <= cast("int", each) < size:
                raise ValueError(f"{self.array.name}: index {each} outside 0..{size - 1}")
            found = found * size + cast("int", each)
        return found

    def __getitem__(self, place: Place) -> ca.SX:
        value = self.values[self._place(place)]
        if value is None:
            raise ValueError(f"{self.array.name}[{place}] is read before it is written")
        return value

    def __setitem__(self, place: Place, value: ca.SX | float) -> None:
        self.values[self._place(place)] = ca.SX(value)


#: Takes the loops, then the arrays: arguments, results, local ones.
Algorithm = Callable[..., None]


def routine(
    name: str,
    algorithm: Algorithm,
    *,
    arguments: Mapping[str, Shape],
    results: Mapping[str, Shape],
    local: Mapping[str, Shape] | None = None,
    description: str = "",
) -> Routine:
    """Write an algorithm down as a routine.

    Parameters
    ----------
    name : str
    algorithm : callable
        Takes the loops and the arrays; ``a[i, k]`` is an element, ``a[i, k] = …`` assigns it. An
        element that is read is the one of that moment: after the array is written, and inside
        or behind another loop, it has to be read again. A single number is ``a[()]``.
    arguments, results, local : mapping
        Name of each array to its shape.
    description : str

    Raises
    ------
    ValueError
        An element is used that was read before its array was written or in another loop, an
        argument is written, or a loop has the index of one around it.

    Examples
    --------
    >>> def total(loop, x, y):
    ...     y[()] = 0
    ...     for i in loop("i", 0, 3):
    ...         y[()] = y[()] + x[i]
    >>> three = routine("total", total, arguments={"x": (3,)}, results={"y": ()})
    >>> len([*three.computed()]), computed(three, total, [ca.DM([1, 2, 4])])
    (4, [SX(7)])
    """
    written, known = _Written(), dict[str, tuple[Element, object]]()
    given, found, kept = (
        tuple(Array(each, shape) for each, shape in (group or {}).items())
        for group in (arguments, results, local)
    )
    arrays = (_WrittenArray(array, written, known) for array in (*given, *found, *kept))
    algorithm(written, *arrays)
    whole = Routine(name, given, found, kept, tuple(written.steps), description)
    for array in given:
        if array.name in written.versions:
            raise ValueError(f"{array.name} is an argument, which is only read")
    return whole.needed(results)


def computed(made: Routine, algorithm: Algorithm, given: list[ca.SX]) -> list[ca.SX]:
    """Return the results of a routine as expressions, one array behind the other, row by row.

    Parameters
    ----------
    made : Routine
    algorithm : callable
        What it was written from.
    given : list of casadi.SX
        The elements of each argument, row by row.

    Raises
    ------
    ValueError
        An index is outside its array, or an element is read before it is written.
    """
    values: list[list[ca.SX | None]] = [list(ca.vertsplit(ca.SX(each))) for each in given]
    own = (*made.results, *made.local)
    values += [[None] * array.size for array in own]
    arrays = [
        _ComputedArray(array, entries)
        for array, entries in zip((*made.arguments, *own), values, strict=True)
    ]
    counted = _Counted()
    counted.arrays += arrays
    algorithm(counted, *arrays)
    first = len(made.arguments)
    told = arrays[first : first + len(made.results)]
    return [each[place] for each in told for place in _places(each.array.shape)]


def _places(shape: Shape) -> Iterator[Shape]:
    """Yield every place of an array, row by row."""
    if not shape:
        yield ()
        return
    for first in range(shape[0]):
        yield from ((first, *rest) for rest in _places(shape[1:]))
