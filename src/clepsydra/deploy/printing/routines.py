"""A routine as loops over arrays that a reader knows from a textbook."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.listing import (
    Assignment,
    DeclaredArray,
    ListingStatement,
    Remark,
    Repeated,
    Scope,
)
from clepsydra.program.apart import apart
from clepsydra.program.counted_loop import Table
from clepsydra.program.program import Block
from clepsydra.program.routine import Array, Element, Index, Note, RoutineCall, Step, Turns
from clepsydra.program.step_block import block_of

#: Returns the statements and the result of a block over what is written for its arguments.
Folded = Callable[[Block, Sequence[Expression]], tuple[list[ListingStatement], Expression]]


def index_text(index: Index, names: Mapping[str, str]) -> str:
    """Write an index as every language does.

    Examples
    --------
    >>> index_text(Index(-1, (("row", 10), ("column", 1))), {"row": "i", "column": "k"})
    '10 * i + k - 1'
    >>> index_text(Index(5, (("k", -1),)), {"k": "k"}), index_text(Index(), {})
    ('5 - k', '0')
    """
    terms = [(factor, names[name]) for name, factor in index.factors]
    terms += [(index.constant, "")] if index.constant or not terms else []
    # What is added comes first.
    terms.sort(key=lambda term: term[0] < 0)
    text = ""
    for factor, name in terms:
        size = str(abs(factor))
        part = f"{size} * {name}" if name and size != "1" else name or size
        sign = "-" if factor < 0 else "+"
        text += f" {sign} {part}" if text else f"{sign.strip('+')}{part}"
    return text


@dataclass
class RoutineListing:
    """The statements of a call of a routine.

    Parameters
    ----------
    call : RoutineCall
    scope : Scope
    depth : object
        What those loops have in common that share an index.
    folded : callable
    """

    call: RoutineCall
    scope: Scope
    depth: object
    folded: Folded

    def __post_init__(self) -> None:
        routine, self._read = self.call.routine, self.call.routine.read()
        self._names: dict[str, str] = {}
        self._single: set[str] = set()
        known = {array.name: table for array, table, _ in self.call.given if table}
        used = self._read.keys() | {step.written.array for step in routine.every_step()}
        for array in (*routine.arguments, *routine.results, *routine.local):
            if array.name in known and array.name in used:
                self._names[array.name] = self.scope.table(Table(array.name, known[array.name]))
            elif array.name in used:
                self._names[array.name] = self._array(array)

    def _array(self, array: Array) -> str:
        name = self.scope.names.new(array.name)
        self.scope.arrays[name] = DeclaredArray(array.size if array.shape else 0)
        self._single |= set() if array.shape else {array.name}
        return name

    def element(self, array: Array, place: int) -> str:
        """Return what an element is called."""
        return self._element(Element(array.name, Index(place)), {})

    def statements(self, values: Mapping[int, Expression]) -> list[ListingStatement]:
        """Return what computes the results from what is written for each value."""
        routine = self.call.routine
        found = list[ListingStatement]([Remark(routine.description)] if routine.description else [])
        for array, _, given in self.call.given:
            found += self._given(array, given, values) if given else []
        return [*found, *self._steps(routine.steps, {}, ())]

    def _given(
        self, array: Array, given: Sequence[int], values: Mapping[int, Expression]
    ) -> Iterator[Assignment]:
        """Yield what assigns the elements that are read; what never changes is there already."""
        read = {place: values[given[place]] for place in self._read.get(array.name, ())}
        # A number that the system cannot read is computed, and so assigned.
        known = {
            place: each.number
            for place, each in read.items()
            if each.code == "constant" and self.scope.notation.readable(each.number)
        }
        if known and array.shape:
            initial = tuple(known.get(place, 0.0) for place in range(array.size))
            name = self._names[array.name]
            self.scope.arrays[name] = DeclaredArray(array.size, initial)
        for place, value in sorted(read.items()):
            if place not in known or not array.shape:
                yield Assignment(self.element(array, place), value)

    def _element(self, element: Element, indices: Mapping[str, str]) -> str:
        name = self._names[element.array]
        if element.array in self._single:
            return name
        return f"{name}[{index_text(element.index, indices)}]"

    def _steps(
        self,
        steps: Sequence[Step | Turns | Note],
        indices: Mapping[str, str],
        around: Sequence[Turns],
    ) -> list[ListingStatement]:
        found: list[ListingStatement] = []
        for each in steps:
            if isinstance(each, Turns):
                found += self._turns(each, indices, around)
            elif isinstance(each, Step):
                found += self._step(each, indices)
            else:
                found.append(Remark(each.text))
        return found

    def _turns(
        self, turns: Turns, indices: Mapping[str, str], around: Sequence[Turns]
    ) -> list[ListingStatement]:
        name = self.scope.names.shared(turns.index, self.depth)
        inside = {**indices, turns.index: name}
        body = tuple(self._steps(turns.steps, inside, [*around, turns]))
        first = index_text(turns.first, indices)
        last, behind = (index_text(end, indices) for end in (turns.stop - 1, turns.stop))
        once = not apart(turns.stop, turns.first + 1, around)
        return [Repeated(name, first, last, behind, body, once)]

    def _step(self, step: Step, indices: Mapping[str, str]) -> list[ListingStatement]:
        written = self._element(step.written, indices)
        read = [variable(self._element(each, indices)) for each in step.read]
        before, result = self.folded(block_of(step), read)
        same = {
            self._element(each, indices) for each in step.read if each.array == step.written.array
        }
        if same - {written} and any(part.code == "select" for part in result.parts):
            # Another index may be the same element: it is overwritten when all is computed.
            name = self.scope.names.shared("chosen", self.depth)
            before.append(Assignment(name, result))
            result = variable(name)
        return [*before, Assignment(written, result)]
