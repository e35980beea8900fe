"""Prints a large block as several functions, which exchange values through memory.

The time that it takes to compile one function grows faster than its length; that of many
functions of bounded length grows with their number. Every operation is printed as it would be
in one function, and what is fused there is fused here, so no bit of any result changes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from clepsydra.engine.vector_rings import RingPrinter
from clepsydra.engine.vector_statements import StatementPrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.engine.vector_turns import TurnPrinter
from clepsydra.engine.workspace import POINTER, StoredValues, Workspace
from clepsydra.program.operation import Operation
from clepsydra.program.program import (
    Block,
    Conditional,
    ForLoop,
    Program,
    Statement,
    read_by,
    written_by,
)
from clepsydra.program.routine import RoutineCall

#: Operations that one function may have: below, it compiles in less than half a second.
LARGEST_WHOLE = 4000
#: Operations of a part: compiling takes longer with larger ones, running with smaller ones.
LARGEST_PART = 500


def stands_in_parts(program: Program) -> bool:
    """Whether a program is printed in parts, which have memory: it is long, or has arrays.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> stands_in_parts(Program("nothing", (), (), (), (), Block(0, (), ())))
    False
    """
    if has_arrays(program.block):
        return True
    return sum(1 for _ in program.block.operations()) > LARGEST_WHOLE


def has_arrays(block: Block) -> bool:
    """Whether a block has arrays, which routines work on in loops."""
    return any(
        isinstance(each, RoutineCall)
        or (isinstance(each, (ForLoop, Conditional)) and has_arrays(each.body))
        for each in block.statements
    )


class _PartText(VectorText):
    """The lines of one part; what stands beside functions is common to all of a kernel."""

    def __init__(self, kernel: VectorText) -> None:
        super().__init__(kernel.lanes)
        self._kernel = kernel
        self.globals = kernel.globals
        self.declarations = kernel.declarations
        self.calls = kernel.calls

    def new_label(self, prefix: str) -> str:
        """Return a label that no function of the kernel uses: tables are named after them."""
        return self._kernel.new_label(prefix)


@dataclass(frozen=True)
class _Step:
    """Statements that become one part, or one that stands between parts."""

    statements: tuple[Statement, ...]
    reads: frozenset[int]
    writes: frozenset[int]
    is_part: bool


class PartsPrinter:
    """Prints statements of one block as parts, and loops around parts between their calls.

    Parameters
    ----------
    text : VectorText
        The function that calls the parts.
    block : Block
    workspace : Workspace
    fuse : bool
    rings : RingPrinter
    """

    def __init__(
        self, text: VectorText, block: Block, workspace: Workspace, *, fuse: bool,
        rings: RingPrinter,
    ) -> None:  # fmt: skip
        constants = {
            statement.target: text.literal(statement.constant)
            for statement in block.statements
            if isinstance(statement, Operation) and statement.code == "constant"
        }
        self.values = StoredValues(text, workspace, block.truths, constants)
        self._text = text
        self._block = block
        self._workspace = workspace
        self._fuse = fuse
        self._rings = rings
        self._printer = StatementPrinter(
            text, block, {}, fuse=fuse, rings=rings, workspace=workspace
        )
        absorbed = map(self._printer.product_in, block.statements)
        self._dropped = {value for value in absorbed if value is not None} | set(constants)

    def reads(self, statements: Iterable[Statement]) -> set[int]:
        """Return the values that statements read when printed: of a fused product, its factors."""
        return {
            value
            for statement in statements
            if self._dropped.isdisjoint(written_by(statement))
            for value in self._printer.read_by(statement)
            if value not in self.values.constants
        }

    def statements(self, statements: Iterable[Statement], kept: set[int]) -> None:
        """Print statements; values in `kept` are still there afterwards."""
        steps = list(self._steps(statements))
        last = {value: number for number, step in enumerate(steps) for value in step.reads}
        own: set[int] = set()
        for number, step in enumerate(steps):
            own |= step.writes
            self.values.take(
                value for value in sorted(step.writes) if value in kept or value in last
            )
            if step.is_part:
                self._part(step)
            else:
                self._between(step.statements[0])
            self.values.give(
                value for value in sorted(step.reads & own - kept) if last[value] == number
            )

    def _steps(self, statements: Iterable[Statement]) -> Iterator[_Step]:
        collected: list[Statement] = []
        size = 0
        for statement in statements:
            if not self._dropped.isdisjoint(written_by(statement)):
                continue
            length = _length(statement)
            alone = _stands_between(statement, length)
            if collected and (alone or size + length > LARGEST_PART):
                yield self._step(collected, is_part=True)
                collected, size = [], 0
            if alone:
                yield self._step([statement], is_part=False)
            else:
                collected.append(statement)
                size += length
        if collected:
            yield self._step(collected, is_part=True)

    def _step(self, statements: Sequence[Statement], *, is_part: bool) -> _Step:
        writes = frozenset(value for s in statements for value in written_by(s))
        reads = frozenset(self.reads(statements))
        inside = writes if is_part else frozenset()
        return _Step(tuple(statements), reads - inside, writes, is_part)

    def _part(self, step: _Step) -> None:
        """Print a function of its own and its call."""
        values = self.values
        text = _PartText(self._text)
        name = f"@{text.new_label('clepsydra_part')}"
        text.begin("entry")
        local = dict(values.constants)
        self._printer.text, self._printer.values = text, local
        for statement in step.statements:
            for value in self._printer.read_by(statement):
                if value not in local:
                    local[value] = values.load(text, value)
            self._printer.statement(statement)
            for value in written_by(statement):
                values.store(text, value, local[value])
        self._call(text, name)

    def _call(self, text: VectorText, name: str) -> None:
        """Define a function of some lines, and call it."""
        text.globals.append(
            "\n".join(
                [
                    f"define internal void {name}(ptr noalias {POINTER}) noinline #0 {{",
                    *text.lines,
                    "  ret void",
                    "}",
                ]
            )
        )
        self._text.line(f"call void {name}(ptr {POINTER})")

    def _between(self, statement: Statement) -> None:
        if _length(statement) <= LARGEST_PART:
            local = {value: self.values[value] for value in read_by(statement)}
            self._printer.text, self._printer.values = self._text, local
            self._printer.statement(statement)
            for value in written_by(statement):
                self.values[value] = local[value]
        elif isinstance(statement, ForLoop):
            self._loop(statement)
        else:
            assert isinstance(statement, Conditional)
            self._conditional(statement)

    def _body(self, body: Block) -> PartsPrinter:
        return PartsPrinter(self._text, body, self._workspace, fuse=self._fuse, rings=self._rings)

    def _conditional(self, conditional: Conditional) -> None:
        """Branch around the parts of the body where no lane needs it."""
        text, inner = self._text, self._body(conditional.body)
        label = text.new_label("when")
        for argument, value in enumerate(conditional.carried + conditional.invariants):
            inner.values.share(argument, self.values, value)
        needed = text.in_any_lane(self.values[conditional.condition])
        text.line(f"br i1 {needed}, label %{label}, label %{label}.not")
        text.begin(label)
        body = conditional.body
        inner.statements(body.statements, set(body.results))
        choices = [
            (target, result, start)
            for target, result, start in zip(
                conditional.targets, body.results, conditional.carried, strict=True
            )
            if target in self.values.rows
        ]
        for first in range(0, len(choices), LARGEST_PART):
            chosen = choices[first : first + LARGEST_PART]
            self._select(conditional.condition, inner.values, chosen)
        text.line(f"br label %{label}.done")
        text.begin(f"{label}.not")
        self.values.assign(conditional.targets, self.values, conditional.carried)
        text.line(f"br label %{label}.done")
        text.begin(f"{label}.done")
        inner.values.give(set(body.results) - set(range(body.arguments)))

    def _select(
        self, condition: int, inner: StoredValues, choices: Sequence[tuple[int, int, int]]
    ) -> None:
        """Print a part that chooses (target, result of a body, value before) in each lane."""
        text = _PartText(self._text)
        name = f"@{text.new_label('clepsydra_part')}"
        text.begin("entry")
        chosen = self.values.load(text, condition)
        for target, result, start in choices:
            after, before = inner.load(text, result), self.values.load(text, start)
            self.values.store(text, target, text.choose(chosen, after, before))
        self._call(text, name)

    def _loop(self, loop: ForLoop) -> None:
        """Print a loop whose carried values stand in memory, around the parts of its body."""
        text, body, inner = self._text, loop.body, self._body(loop.body)
        rows = range(len(loop.tables))
        carried = range(rows.stop, rows.stop + len(loop.carried))
        oldest = range(carried.stop, carried.stop + len(loop.rings))
        held = range(oldest.stop, body.arguments)
        for argument, value in zip(held, loop.invariants, strict=True):
            inner.values.share(argument, self.values, value)
        following = body.results[: len(carried)]
        inner.values.take_together([*rows, *carried, *oldest])
        inner.values.take_together(following)
        inner.values.assign(carried, self.values, loop.carried)
        turns = TurnPrinter(text, loop, self._rings)
        turns.begin()
        for argument, row in zip(rows, turns.rows(), strict=True):
            inner.values[argument] = row
        places = turns.places()
        for argument, place in zip(oldest, places, strict=True):
            inner.values[argument] = text.load(place)
        inner.statements(body.statements, set(body.results))
        for value, place in zip(body.results[len(carried) :], places, strict=True):
            text.store(inner.values[value], place)
        inner.values.follow(carried, following)
        turns.end()
        self.values.assign(loop.targets, inner.values, carried)
        inner.values.give([*rows, *carried, *oldest])
        inner.values.give(set(body.results) - set(range(body.arguments)))


def _length(statement: Statement) -> int:
    """Return the number of operations in a statement."""
    if isinstance(statement, Operation):
        return 1
    return sum(1 for _ in Block(0, (statement,), ()).operations())


def _stands_between(statement: Statement, length: int) -> bool:
    """Whether a statement reaches for the rings or turns, or is printed in parts itself."""
    if isinstance(statement, ForLoop) and (statement.rings or statement.adjustable):
        return True
    return length > LARGEST_PART and isinstance(statement, (ForLoop, Conditional))
