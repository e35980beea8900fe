"""Prints a routine as LLVM code: its loops, over arrays that stand in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from clepsydra.engine.loop_registers import accumulated, unchanged
from clepsydra.engine.vector_text import VectorText
from clepsydra.engine.workspace import POINTER, Workspace
from clepsydra.program.program import Block
from clepsydra.program.routine import Element, Index, Note, RoutineCall, Step, Turns
from clepsydra.program.step_block import block_of

#: Prints a block over named values, and returns the names of its results.
Computed = Callable[[Block, list[str]], list[str]]


class RoutinePrinter:
    """Prints the calls of routines in one function.

    Parameters
    ----------
    text : VectorText
    workspace : Workspace
        Where arrays stand, a row for each element.
    block : callable
        Prints the block of a step.
    """

    def __init__(self, text: VectorText, workspace: Workspace, block: Computed) -> None:
        self._text, self._workspace, self._block = text, workspace, block
        #: Array to its first row, or to the table that holds its numbers.
        self._rows: dict[str, int] = {}
        self._tables: dict[str, str] = {}
        #: The loops around what is printed.
        self._around: list[Turns] = []
        #: Elements that the innermost loop has in registers.
        self._held: dict[Element, str] = {}

    def call(self, call: RoutineCall, values: Mapping[int, str]) -> dict[int, str]:
        """Print a call over named values, and return the names of what it computes."""
        text, routine = self._text, call.routine
        arrays = (*routine.arguments, *routine.results, *routine.local)
        rows = self._workspace.take_together(sum(array.size for array in arrays))
        row = rows.start
        for array in arrays:
            self._rows[array.name] = row
            row += array.size
        for array, table, given in call.given:
            if table:
                symbol = f"@{text.new_label('routine')}.{array.name}"
                text.table(symbol, table)
                self._tables[array.name] = symbol
            for place, value in enumerate(given):
                text.store(values[value], POINTER, self._rows[array.name] + place)
        self._steps(routine.steps, {})
        return {
            target: text.load(POINTER, self._rows[array.name] + place)
            for array, targets in call.told
            for place, target in enumerate(targets)
        }

    def _steps(self, steps: Sequence[Step | Turns | Note], at: Mapping[str, str]) -> None:
        for each in steps:
            if isinstance(each, Turns):
                self._turns(each, at)
            elif isinstance(each, Step):
                self._step(each, at)

    def _turns(self, turns: Turns, at: Mapping[str, str]) -> None:
        """Print a loop; an innermost one keeps in registers what it can."""
        text, label = self._text, self._text.new_label("turns")
        innermost = not any(isinstance(each, Turns) for each in turns.steps)
        summed = accumulated(turns, self._around) if innermost else []
        first, stop = self._index(turns.first, at), self._index(turns.stop, at)
        some = text.assign(f"icmp slt i64 {first}, {stop}")
        text.line(f"br i1 {some}, label %{label}.begin, label %{label}.done")
        text.begin(f"{label}.begin")
        if innermost:
            self._held = {each: self._load(each, at) for each in [*unchanged(turns), *summed]}
        starts = [first, *(self._held[each] for each in summed)]
        carried = [f"%{label}.i", *(f"%{label}.s{k}" for k in range(len(summed)))]
        text.line(f"br label %{label}")
        text.begin(label)
        gaps = [text.gap() for _ in carried]
        self._held.update(zip(summed, carried[1:], strict=True))
        self._around.append(turns)
        self._steps(turns.steps, {**at, turns.index: carried[0]})
        self._around.pop()
        following = [
            text.assign(f"add i64 {carried[0]}, 1"),
            *(self._held[each] for each in summed),
        ]
        more = text.assign(f"icmp slt i64 {following[0]}, {stop}")
        text.line(f"br i1 {more}, label %{label}, label %{label}.end")
        kinds = ["i64", *(text.real for _ in summed)]
        for gap, name, kind, start, result in zip(
            gaps, carried, kinds, starts, following, strict=True
        ):
            text.fill(
                gap,
                f"{name} = phi {kind} [ {start}, %{label}.begin ], [ {result}, %{text.label} ]",
            )
        text.begin(f"{label}.end")
        for each in summed:
            self._store(self._held[each], each, at)
        self._held = {}
        text.line(f"br label %{label}.done")
        text.begin(f"{label}.done")

    def _step(self, step: Step, at: Mapping[str, str]) -> None:
        read = [self._held.get(element) or self._load(element, at) for element in step.read]
        (value,) = self._block(block_of(step), read)
        if step.written in self._held:
            self._held[step.written] = value
        else:
            self._store(value, step.written, at)

    def _store(self, value: str, element: Element, at: Mapping[str, str]) -> None:
        place = self._place(element, at)
        self._text.line(f"store {self._text.real} {value}, ptr {place}, align 8")

    def _load(self, element: Element, at: Mapping[str, str]) -> str:
        text = self._text
        if table := self._tables.get(element.array):
            return text.load_spread(table, self._index(element.index, at))
        return text.assign(f"load {text.real}, ptr {self._place(element, at)}, align 8")

    def _place(self, element: Element, at: Mapping[str, str]) -> str:
        text, row = self._text, self._rows[element.array]
        index = self._index(element.index + row, at)
        number = index if text.lanes == 1 else text.assign(f"mul i64 {index}, {text.lanes}")
        return text.assign(f"getelementptr double, ptr {POINTER}, i64 {number}")

    def _index(self, index: Index, at: Mapping[str, str]) -> str:
        """Print the computation of an index, and return its name."""
        text, found = self._text, str(index.constant)
        for name, factor in index.factors:
            part = at[name] if factor == 1 else text.assign(f"mul i64 {at[name]}, {factor}")
            found = part if found == "0" else text.assign(f"add i64 {part}, {found}")
        return found
