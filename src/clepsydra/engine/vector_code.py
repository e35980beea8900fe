"""Prints a program as LLVM code: the whole time loop, one lane for each scenario."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.engine.vector_statements import StatementPrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Loop, Program, Statement, read_by

KERNEL = "clepsydra_kernel"


@dataclass(frozen=True)
class KernelForm:
    """How a program becomes a kernel.

    Parameters
    ----------
    lanes : int
        Scenarios that one pass computes side by side; 1 for a single run.
    individual : frozenset of str
        Inputs that differ from scenario to scenario; all others are shared.
    fuse : bool
        Whether operations marked as fused become fused multiply-adds.
    record : bool
        Whether the outputs are stored.
    """

    lanes: int
    individual: frozenset[str] = frozenset()
    fuse: bool = True
    record: bool = True


def vector_code(program: Program, form: KernelForm) -> str:
    """Return LLVM code of a kernel that runs a program for many samples and scenarios.

    The function has the C signature ::

        void clepsydra_kernel(double *state, const double *parameters, const double *shared,
                              const double *individual, double *record, double *rings,
                              int64_t groups, int64_t samples, int64_t every)

    with the last index a lane: state [groups, n, lanes] is read and left at its final value,
    parameters [groups, p, lanes], shared inputs [samples, s], individual inputs
    [groups, samples, i, lanes], record [groups, ceil(samples / every), q, lanes], rings
    [groups, sum of lengths, lanes].

    Operations that read only parameters and constants stand outside the time loop.
    """
    return _KernelPrinter(program, form).code()


class _KernelPrinter:
    def __init__(self, program: Program, form: KernelForm) -> None:
        self.program = program
        self.form = form
        self.text = VectorText(form.lanes)
        self.values: dict[int, str] = {}
        self.hoisted = _constant_in_time(program)
        entries = list(zip(program.state, program.state_arguments, program.next_state, strict=True))
        self.rings = [
            (entry.length, value, result)
            for entry, value, result in entries
            if isinstance(entry, DelayRing)
        ]
        self.plain = [
            (index, value, result)
            for index, (entry, value, result) in enumerate(entries)
            if not isinstance(entry, DelayRing)
        ]

    def code(self) -> str:
        self._groups()
        text = self.text
        pointers = ", ".join(
            f"ptr noalias %{name}"
            for name in ("state", "parameters", "shared", "individual", "record", "rings")
        )
        counts = ", ".join(f"i64 %{name}" for name in ("groups", "samples", "every"))
        return "\n".join(
            [
                *text.globals,
                *sorted(text.declarations),
                f"define void @{KERNEL}({pointers}, {counts}) #0 {{",
                *text.lines,
                "}",
                'attributes #0 = { nounwind "prefer-vector-width"="512" }',
                "attributes #1 = { nobuiltin nounwind }",
                "",
            ]
        )

    def _groups(self) -> None:
        text = self.text
        text.begin("entry")
        text.line("%records.up = add i64 %samples, %every")
        text.line("%records.top = sub i64 %records.up, 1")
        text.line("%records = sdiv i64 %records.top, %every")
        text.line("br label %group.head")
        text.begin("group.head")
        text.line("%group = phi i64 [ 0, %entry ], [ %group.next, %group.end ]")
        text.line("%group.more = icmp slt i64 %group, %groups")
        text.line("br i1 %group.more, label %group.body, label %done")
        text.begin("group.body")
        self._once_a_group()
        self._samples()
        text.begin("group.end")
        text.line("%group.next = add i64 %group, 1")
        text.line("br label %group.head")
        text.begin("done")
        text.line("ret void")

    def _once_a_group(self) -> None:
        """Load parameters, print what depends on nothing else, load the initial state."""
        program, text = self.program, self.text
        base = text.row("%parameters", "%group", len(program.parameters))
        for index, value in enumerate(program.parameter_arguments):
            self.values[value] = text.load(base, index)
        self._statements(hoisted=True)
        base = text.row("%state", "%group", len(program.state))
        for index, value, _ in self.plain:
            self.values[value] = text.load(base, index)

    def _statements(self, *, hoisted: bool) -> None:
        block = self.program.block
        printer = StatementPrinter(self.text, block, self.values, fuse=self.form.fuse)
        for statement in block.statements:
            if (_targets(statement) <= self.hoisted) == hoisted:
                printer.statement(statement)

    def _samples(self) -> None:
        text, before = self.text, self.text.label
        text.line("br label %sample.head")
        text.begin("sample.head")
        counters = ["sample", "slot", "wait", *(f"ring{n}" for n in range(len(self.rings)))]
        for name in counters:
            text.line(f"%{name} = phi i64 [ 0, %{before} ], [ %{name}.next, %sample.end ]")
        initial = [self.values[value] for _, value, _ in self.plain]
        gaps = [text.gap() for _ in self.plain]
        for index, value, _ in self.plain:
            self.values[value] = f"%x{index}"
        text.line("%sample.more = icmp slt i64 %sample, %samples")
        text.line("br i1 %sample.more, label %sample.body, label %sample.done")
        text.begin("sample.body")
        self._inputs()
        places = self._read_rings()
        self._statements(hoisted=False)
        for place, (_, _, result) in zip(places, self.rings, strict=True):
            text.store(self.values[result], place)
        if self.form.record and self.program.outputs:
            self._record()
        text.line("br label %sample.end")
        text.begin("sample.end")
        self._count()
        text.line("br label %sample.head")
        for gap, start, (index, _, result) in zip(gaps, initial, self.plain, strict=True):
            text.fill(
                gap,
                f"%x{index} = phi {text.real} [ {start}, %{before} ], "
                f"[ {self.values[result]}, %sample.end ]",
            )
        text.begin("sample.done")
        base = text.row("%state", "%group", len(self.program.state))
        for index, value, _ in self.plain:
            text.store(self.values[value], base, index)
        text.line("br label %group.end")

    def _inputs(self) -> None:
        text, individual = self.text, self.form.individual
        values = dict(zip(self.program.inputs, self.program.input_arguments, strict=True))
        shared = [value for signal, value in values.items() if signal.name not in individual]
        own = [value for signal, value in values.items() if signal.name in individual]
        if shared:
            offset = text.assign(f"mul i64 %sample, {len(shared)}")
            base = text.assign(f"getelementptr double, ptr %shared, i64 {offset}")
            for index, value in enumerate(shared):
                self.values[value] = text.load_spread(base, str(index))
        if own:
            row = text.assign("mul i64 %group, %samples")
            row = text.assign(f"add i64 {row}, %sample")
            base = text.row("%individual", row, len(own))
            for index, value in enumerate(own):
                self.values[value] = text.load(base, index)

    def _read_rings(self) -> list[str]:
        """Load the oldest value of every ring and return where each stands."""
        text = self.text
        total = sum(length for length, _, _ in self.rings)
        places, offset = [], 0
        for number, (length, value, _) in enumerate(self.rings):
            row = text.assign(f"mul i64 %group, {total}")
            row = text.assign(f"add i64 {row}, {offset}")
            row = text.assign(f"add i64 {row}, %ring{number}")
            places.append(text.row("%rings", row, 1))
            self.values[value] = text.load(places[-1])
            offset += length
        return places

    def _record(self) -> None:
        text = self.text
        text.line("%record.now = icmp eq i64 %wait, 0")
        text.line("br i1 %record.now, label %record.body, label %record.end")
        text.begin("record.body")
        row = text.assign("mul i64 %group, %records")
        row = text.assign(f"add i64 {row}, %slot")
        base = text.row("%record", row, len(self.program.outputs))
        for index, value in enumerate(self.program.output_values):
            text.store(self.values[value], base, index)
        text.line("br label %record.end")
        text.begin("record.end")

    def _count(self) -> None:
        """Advance the sample, the wait for the next record, its slot, and the rings."""
        text = self.text
        text.line("%sample.next = add i64 %sample, 1")
        text.line("%wait.over = icmp eq i64 %wait, 0")
        text.line("%wait.full = sub i64 %every, 1")
        text.line("%wait.less = sub i64 %wait, 1")
        text.line("%wait.next = select i1 %wait.over, i64 %wait.full, i64 %wait.less")
        text.line("%slot.up = add i64 %slot, 1")
        text.line("%slot.next = select i1 %wait.over, i64 %slot.up, i64 %slot")
        for number, (length, _, _) in enumerate(self.rings):
            ring = f"%ring{number}"
            text.line(f"{ring}.up = add i64 {ring}, 1")
            text.line(f"{ring}.end = icmp eq i64 {ring}.up, {length}")
            text.line(f"{ring}.next = select i1 {ring}.end, i64 0, i64 {ring}.up")


def _targets(statement: Statement) -> set[int]:
    return set(statement.targets) if isinstance(statement, Loop) else {statement.target}


def _constant_in_time(program: Program) -> set[int]:
    """Return the values that depend on parameters and constants only."""
    constant = set(program.parameter_arguments)
    for statement in program.block.statements:
        if constant.issuperset(read_by(statement)):
            constant |= _targets(statement)
    return constant
