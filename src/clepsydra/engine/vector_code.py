"""Prints a program as LLVM code: the whole time loop, one lane for each scenario."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

from clepsydra.engine.bounded_roots import with_bounded_roots
from clepsydra.engine.compiler import signature_of
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.likely_path import likely_path
from clepsydra.engine.staying import has_rings, staying
from clepsydra.engine.step_order import soonest_first
from clepsydra.engine.steps import Step
from clepsydra.engine.vector_likely import COUNTERS, print_twice
from clepsydra.engine.vector_noise import NOISE_COUNT, NOISE_POINTERS, NoiseReader
from clepsydra.engine.vector_parts import PartsPrinter, stands_in_parts
from clepsydra.engine.vector_rings import RingPrinter
from clepsydra.engine.vector_statements import StatementPrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.engine.workspace import Workspace
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Program, Statement, written_by

KERNEL = "clepsydra_kernel"
_POINTERS = "state", "parameters", "shared", "individual", "record", "rings"
_COUNTS = "groups", "samples", "every", "turns"


def vector_code(program: Program, form: KernelForm) -> str:
    """Return LLVM code of a kernel that runs a program for many samples and scenarios.

    The function has the C signature ::

        void clepsydra_kernel(double *state, const double *parameters, const double *shared,
                              const double *individual, double *record, double *rings,
                              int64_t groups, int64_t samples, int64_t every,
                              int64_t turns)

    with the last index a lane: state [groups, n, lanes] is read and left at its final value,
    parameters [groups, p, lanes], shared inputs [samples, s], individual inputs
    [groups, samples, i, lanes], record [groups, ceil(samples / every), q, lanes], rings
    [groups, sum of lengths, lanes], first those of the state, then those of loops. `turns` are
    those of adjustable loops.

    With noise it has further arguments: before the counts a function of `noise_code`, its plan,
    numbers [groups, lanes] and memory for a chunk; at the end the sample of the noise with which
    the run begins.

    Statements that read only parameters and constants stand outside the time loop. A large
    program is printed as many functions, so that compiling takes time in proportion to its size.
    """
    printer = _PartedKernelPrinter if stands_in_parts(program) else _KernelPrinter
    return printer(program, form).code()


def kernel_signature(form: KernelForm) -> Any:
    """Return the ctypes form of a kernel's signature."""
    return signature_of(*map(len, _arguments(form)))


def _arguments(form: KernelForm) -> tuple[Sequence[str], Sequence[str]]:
    """Return the names of pointers, and of whole numbers."""
    if not form.noisy:
        return _POINTERS, _COUNTS
    return (*_POINTERS, *NOISE_POINTERS), (*_COUNTS, NOISE_COUNT)


class _KernelPrinter:
    def __init__(self, program: Program, form: KernelForm) -> None:
        self.program = program
        self.form = form
        self.text = VectorText(form.lanes)
        self.values: dict[int, str] = {}
        self.carried: list[tuple[int, str, str]] = []
        self.hoisted = staying(program.block, program.parameter_arguments)
        entries = list(zip(program.state, program.state_arguments, program.next_state, strict=True))
        self.delayed = [
            (entry, value, result)
            for entry, value, result in entries
            if isinstance(entry, DelayRing)
        ]
        self.rings = RingPrinter(
            self.text, [*(ring for ring, _, _ in self.delayed), *program.rings]
        )
        arguments = zip(program.inputs, program.input_arguments, strict=True)
        self.noise = NoiseReader(
            self.text, [value for signal, value in arguments if signal.name in form.noisy]
        )
        self.plain = [
            (index, value, result)
            for index, (entry, value, result) in enumerate(entries)
            if not isinstance(entry, DelayRing)
        ]

    def code(self) -> str:
        self._groups()
        text = self.text
        names, others = _arguments(self.form)
        pointers = ", ".join(f"ptr noalias %{name}" for name in names)
        counts = ", ".join(f"i64 %{name}" for name in others)
        return "\n".join(
            [
                *text.globals,
                *sorted(text.declarations),
                f"define void @{KERNEL}({pointers}, {counts}) #0 {{",
                *text.lines,
                "}",
                f"attributes #0 = {{ {self.form.attributes} }}",
                "attributes #1 = { nobuiltin nounwind }",
                "",
            ]
        )

    def _groups(self) -> None:
        text = self.text
        text.begin("entry")
        self._begin()
        text.line("%records.up = add i64 %samples, %every")
        text.line("%records.top = sub i64 %records.up, 1")
        text.line("%records = sdiv i64 %records.top, %every")
        text.line("br label %group.head")
        before = text.label
        text.begin("group.head")
        text.line(f"%group = phi i64 [ 0, %{before} ], [ %group.next, %group.end ]")
        text.line("%group.more = icmp slt i64 %group, %groups")
        text.line("br i1 %group.more, label %group.body, label %done")
        text.begin("group.body")
        self._once_a_group()
        self._samples()
        text.begin("group.end")
        text.line("%group.next = add i64 %group, 1")
        text.line("br label %group.head")
        text.begin("done")
        self._end()
        text.line("ret void")

    def _begin(self) -> None:
        """Print what stands before everything else."""

    def _end(self) -> None:
        """Print what stands after everything else."""

    def _once_a_group(self) -> None:
        """Load parameters, print what depends on nothing else, load the initial state."""
        program, text = self.program, self.text
        base = text.row("%parameters", "%group", len(program.parameters))
        self._fill(base, enumerate(program.parameter_arguments))
        self._statements(hoisted=True)
        base = text.row("%state", "%group", len(program.state))
        self._fill(base, [(index, value) for index, value, _ in self.plain])

    def _fill(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        """Load values from a row (index, value)."""
        for index, value in entries:
            self.values[value] = self.text.load(base, index)

    def _empty(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        """Store values into a row (index, value)."""
        for index, value in entries:
            self.text.store(self.values[value], base, index)

    def _statements(self, *, hoisted: bool) -> None:
        statements = self.program.block.statements
        self._printer.print_all(
            each for each in statements if _is_within(each, self.hoisted) == hoisted
        )

    @cached_property
    def _printer(self) -> StatementPrinter:
        block = self.program.block
        return StatementPrinter(
            self.text, block, self.values, fuse=self.form.fuse, rings=self.rings,
            processor=self.form.processor,
        )  # fmt: skip

    def _samples(self) -> None:
        text, before = self.text, self.text.label
        text.line("br label %sample.head")
        text.begin("sample.head")
        counters = dict.fromkeys(["sample", "slot", "wait", *self.rings.counters], 0)
        for name, first in (counters | (COUNTERS if self._likely else {})).items():
            text.line(f"%{name} = phi i64 [ {first}, %{before} ], [ %{name}.next, %sample.end ]")
        self._carry(before)
        text.line("%sample.more = icmp slt i64 %sample, %samples")
        text.line("br i1 %sample.more, label %sample.body, label %sample.done")
        text.begin("sample.body")
        self._inputs()
        places = self._read_rings()
        self._sample()
        for place, (_, _, result) in zip(places, self.delayed, strict=True):
            text.store(self.values[result], place)
        if self.form.record and self.program.outputs:
            self._record()
        self._follow()
        text.line("br label %sample.end")
        text.begin("sample.end")
        self._count()
        text.line("br label %sample.head")
        text.begin("sample.done")
        base = text.row("%state", "%group", len(self.program.state))
        self._empty(base, [(index, value) for index, value, _ in self.plain])
        text.line("br label %group.end")

    @cached_property
    def _likely(self) -> Sequence[Step]:
        """The likely path of a sample."""
        if self.form.processor is None:
            return ()
        block, printer = self.program.block, self._printer
        path = likely_path(
            [each for each in block.statements if not _is_within(each, self.hoisted)],
            {
                each.target: each.constant
                for each in block.statements
                if isinstance(each, Operation) and each.code == "constant"
            },
            self.hoisted,
            {value: result for _, value, result in self.plain},
            self._results,
            printer.read_by,
        )
        return soonest_first([*with_bounded_roots(path, block.made)], printer.form())

    @cached_property
    def _results(self) -> list[int]:
        """Values of a sample that it is computed for."""
        asked = [*self.program.next_state]
        if self.form.record:
            asked += self.program.output_values
        arguments = self.program.block.arguments
        found = (each for each in asked if each >= arguments and each not in self.hoisted)
        return list(dict.fromkeys(found))

    def _sample(self) -> None:
        """Print what a sample computes."""
        every = partial(self._statements, hoisted=False)
        if self._likely:
            printed = self._printer.step
            print_twice(self.text, self.values, self._likely, every, printed, self._results)
        else:
            every()

    def _carry(self, before: str) -> None:
        """Name the state of this sample; what it becomes is filled in by `_follow`."""
        for index, value, _ in self.plain:
            self.carried.append((self.text.gap(), self.values[value], before))
            self.values[value] = f"%x{index}"

    def _follow(self) -> None:
        """Let the next state be that of the next sample."""
        text = self.text
        for (gap, start, before), (index, _, result) in zip(self.carried, self.plain, strict=True):
            text.fill(
                gap,
                f"%x{index} = phi {text.real} [ {start}, %{before} ], "
                f"[ {self.values[result]}, %sample.end ]",
            )

    def _inputs(self) -> None:
        text, individual, noise = self.text, self.form.individual, self.noise
        if self.form.noisy:
            noise.make()
        values = dict(zip(self.program.inputs, self.program.input_arguments, strict=True))
        shared = [value for signal, value in values.items() if signal.name not in individual]
        own = [value for signal, value in values.items() if signal.name in individual]
        if shared:
            offset = text.assign(f"mul i64 %sample, {len(shared)}")
            base = text.assign(f"getelementptr double, ptr %shared, i64 {offset}")
            for index, value in enumerate(shared):
                self.values[value] = noise.added(value, text.load_spread(base, str(index)))
        if own:
            row = text.assign("mul i64 %group, %samples")
            row = text.assign(f"add i64 {row}, %sample")
            base = text.row("%individual", row, len(own))
            self._fill(base, [(k, value) for k, value in enumerate(own) if value not in noise])
            for index, value in enumerate(own):
                if value in noise:
                    self.values[value] = noise.added(value, text.load(base, index))

    def _read_rings(self) -> list[str]:
        """Load the oldest value of every ring of the state and return where each stands."""
        places = []
        for number, (_, value, _) in enumerate(self.delayed):
            places.append(self.rings.place(number, f"%ring{number}"))
            self.values[value] = self.text.load(places[-1])
        return places

    def _record(self) -> None:
        text = self.text
        text.line("%record.now = icmp eq i64 %wait, 0")
        text.line("br i1 %record.now, label %record.body, label %record.end")
        text.begin("record.body")
        row = text.assign("mul i64 %group, %records")
        row = text.assign(f"add i64 {row}, %slot")
        base = text.row("%record", row, len(self.program.outputs))
        self._empty(base, enumerate(self.program.output_values))
        text.line("br label %record.end")
        text.begin("record.end")

    def _count(self) -> None:
        """Advance the sample, the wait for the next record, its slot, and the state's rings."""
        text = self.text
        text.line("%sample.next = add i64 %sample, 1")
        text.line("%wait.over = icmp eq i64 %wait, 0")
        text.line("%wait.full = sub i64 %every, 1")
        text.line("%wait.less = sub i64 %wait, 1")
        text.line("%wait.next = select i1 %wait.over, i64 %wait.full, i64 %wait.less")
        text.line("%slot.up = add i64 %slot, 1")
        text.line("%slot.next = select i1 %wait.over, i64 %slot.up, i64 %slot")
        for number in range(len(self.delayed)):
            self.rings.advance(number, f"%ring{number}")


class _PartedKernelPrinter(_KernelPrinter):
    """Prints the same loops, with all values in memory and the statements in functions."""

    def __init__(self, program: Program, form: KernelForm) -> None:
        super().__init__(program, form)
        block = program.block
        self.workspace = Workspace()
        self.memory = 0
        self.parts = PartsPrinter(
            self.text, block, self.workspace, fuse=form.fuse, rings=self.rings
        )
        self.values = self.parts.values
        results = block.results if form.record else program.next_state
        live = replace(block, results=results).without_unread().statements
        self.needed = set(results) | {value for _, value, _ in self.plain}
        self.once = [s for s in live if _is_within(s, self.hoisted)]
        self.every_sample = [s for s in live if not _is_within(s, self.hoisted)]
        read = self.needed | self.parts.reads(live)
        self.parts.values.take_together(v for v in range(block.arguments) if v in read)
        self.parts.values.take_together(program.next_state)

    def _fill(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        self.parts.values.fill(base, entries)

    def _empty(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        self.parts.values.empty(base, entries)

    def _begin(self) -> None:
        self.memory = self.workspace.begin(self.text)

    def _end(self) -> None:
        self.workspace.end(self.text, self.memory)

    def _statements(self, *, hoisted: bool) -> None:
        if hoisted:
            kept = self.needed | self.parts.reads(self.every_sample)
            self.parts.statements(self.once, kept)
        else:
            self.parts.statements(self.every_sample, self.needed)

    @property
    def _likely(self) -> Sequence[Step]:
        """None: what stands in functions is not printed twice."""
        return ()

    def _carry(self, before: str) -> None:
        """The state stands in memory from sample to sample."""

    def _follow(self) -> None:
        arguments = [value for _, value, _ in self.plain]
        results = [result for _, _, result in self.plain]
        self.parts.values.follow(arguments, results)


def _is_within(statement: Statement, values: set[int]) -> bool:
    """Whether a statement only assigns values of a set; what a ring holds is never constant."""
    if isinstance(statement, Operation):
        return statement.target in values
    return not has_rings(statement) and values.issuperset(written_by(statement))
