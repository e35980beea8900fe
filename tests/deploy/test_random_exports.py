"""Random programs, controllers and processes, exported to every target and proved equal."""

from __future__ import annotations

import math
import re
import subprocess
import tempfile
from collections.abc import Iterable
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_controllers import CONTROLLERS
from random_processes import ProcessFile, processes
from random_programs import EVERYTHING, Written, codes_of, library_programs, odd_scans, programs
from tools import need_compiler, need_grammar, need_importer

from clepsydra import InputError, Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.printing.identifiers import C_WORDS
from clepsydra.deploy.proof import interpreted_text
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.run import Run
from clepsydra.deploy.proof.targets import proved_targets, runs_of
from clepsydra.program.entries import signal_of
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Block, Program

FIXED = settings(
    derandomize=True,
    database=None,
    deadline=None,
    print_blob=False,
    suppress_health_check=list(HealthCheck),
)
SCANS = 300
PROCESS_SCANS = 200
TEXTS = ("Structured Text, matiec", "Structured Text, codesys", "Structured Text, scl")
#: What every random example runs on; FMUs take longest to build, so only some examples get one.
USUAL = ("C", *TEXTS, "Structured Text")


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@cache
def target_named(name: str, kind: str = "controller") -> Run:
    """Return a target; in single precision only for the text, which is compared with C."""
    wanted = "single" if name == "Structured Text" else "double"
    found = runs_of(kind, find_compiler("tests"), proved_targets(None))
    return next(t for t in found if (t.name, t.precision) == (name, wanted))


class OddJob(Job):
    """A job whose scans are odd numbers, and not those of a plant."""

    @cached_property
    def inputs(self) -> dict[str, np.ndarray]:
        return odd_scans(self.program, self.scans, self.seed)


def proved(
    item: ProofItem,
    targets: Iterable[str] = USUAL,
    *,
    job: type[Job] = Job,
    scans: int = SCANS,
    nasty: tuple[str, ...] = (),
) -> Job:
    """Run a program on targets and compare; a target may refuse it with a good reason only."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        work = job(item, scans, 1, Path(folder), find_compiler("tests"))
        for name in targets:
            target = target_named(name, item.kind)
            try:
                difference, bound, _ = target.measure(work, target.printed(work))
            except InputError as refusal:
                assert is_justified(refusal, work.program, target, nasty), f"{name}: {refusal}"
                continue
            differs = difference.decisions > 0 or difference.largest > (bound or 0.0)
            if bound == 0.0:
                differs = difference.differing > 0
            assert not differs, f"{name}: {difference}"
        return work


#: Functions of IEC 61131-3 among those of a library.
TEXT_FUNCTIONS = frozenset({"exp", "log", "pow", "sin", "cos", "tan", "asin", "acos", "atan"})
#: What every REAL can hold but zero.
SMALLEST, LARGEST = 2.0**-126, (2.0 - 2.0**-23) * 2.0**127


def is_justified(
    refusal: InputError, program: Program, target: Run, nasty: tuple[str, ...]
) -> bool:
    """Whether there is something in a program that a target has to refuse."""
    said = str(refusal)
    operations = list(program.block.operations())
    if any(f", {name}" in said for name in nasty):
        return True
    if "finite number" in said:
        return not all(math.isfinite(o.constant) for o in operations)
    if "an operation that Structured Text can write" in said:
        return any(f"operation {o.code}:" in said for o in operations
                   if o.code in LIBRARY and o.code not in TEXT_FUNCTIONS)  # fmt: skip
    if "an importer's integrator keeps no past" in said:
        return "delays" in said
    if "which OpenPLC and Beremiz can read" in said:
        values = [s.initial for s in (*map(signal_of, program.state), *program.parameters)]
        return any(x != 0.0 and not SMALLEST <= abs(x) <= LARGEST for x in values)
    return target.precision == "single" and "print it in double precision" in said


#: For many small programs: two targets each.
some_targets = st.sampled_from(
    [("C", TEXTS[0]), (TEXTS[1], "Structured Text"), ("C", TEXTS[2]), (TEXTS[0], "FMU 3.0")]
)
fmu_or_none = st.sampled_from([(), (), (), ("FMU 3.0",), ("FMU 2.0",)])


@pytest.mark.parametrize("examples", [2, pytest.param(30, marks=pytest.mark.thorough)])
def test_programs_of_every_statement(examples):
    @settings(FIXED, max_examples=examples)
    @given(programs(), some_targets)
    def every_program(written: Written, targets: tuple[str, ...]) -> None:
        proved(ProofItem("random", 1.0, written.program()), targets, job=OddJob)

    every_program()


@pytest.mark.thorough
def test_random_programs_leave_out_no_operation_and_no_statement():
    seen: set[str] = set()

    @settings(FIXED, max_examples=600)
    @given(programs())
    def every_program(written: Written) -> None:
        seen.update(codes_of(written.program()))

    every_program()
    assert seen >= EVERYTHING, EVERYTHING - seen


@pytest.mark.thorough
def test_names_that_a_language_cannot_have_are_refused_or_harmless():
    """Keywords, macros, names that differ in case, names of the printers' own variables."""

    @settings(FIXED, max_examples=8)
    @given(programs(wrong=True), fmu_or_none)
    def every_program(written: Written, more: tuple[str, ...]) -> None:
        item = ProofItem("random", 1.0, written.program())
        proved(item, USUAL + more, job=OddJob, nasty=written.nasty)

    every_program()


@pytest.mark.thorough
def test_functions_of_a_library():
    """Within 1e-12 of the range, and no decision differs."""

    @settings(FIXED, max_examples=8)
    @given(library_programs(), fmu_or_none)
    def every_program(written: Written, more: tuple[str, ...]) -> None:
        proved(ProofItem("random", 1.0, written.program()), USUAL + more, job=OddJob)

    every_program()


@pytest.mark.thorough
@pytest.mark.parametrize("kind", CONTROLLERS)
def test_controllers(kind):
    """Random laws behind the plant shell or bare, in a plant that goes wrong in every way."""

    @settings(FIXED, max_examples=2)
    @given(CONTROLLERS[kind](), fmu_or_none)
    def every_controller(written: Written, more: tuple[str, ...]) -> None:
        proved(ProofItem("random", written.period, written.program()), USUAL + more)

    every_controller()


#: Every target of a process; a process is large, so an example runs on some of them.
process_targets = st.tuples(
    st.just("C"),
    st.sampled_from(TEXTS),
    st.sampled_from(["FMU 3.0", "FMU 2.0", "FMU 3.0 exchange", "FMU 2.0 exchange"]),
)


@pytest.mark.thorough
def test_processes():
    @settings(FIXED, max_examples=3)
    @given(processes(most=1), process_targets)
    def every_process(written: ProcessFile, targets: tuple[str, ...]) -> None:
        item = process_item(written.point())
        # Nearly empty, the tip of a cone fills too quickly for any step.
        assume(not item.refusal)
        work = proved(item, targets, scans=PROCESS_SCANS)
        assert np.isfinite(work.engine).all()

    every_process()


@pytest.mark.thorough
def test_a_mistake_of_a_printer_is_found_and_made_small(monkeypatch):
    """A sum is printed as a difference: the program that shows it is down to a few lines."""
    printed = interpreted_text.print_structured_text

    def wrong(program, **more):
        return printed(program, **more).replace(" + ", " - ")

    monkeypatch.setattr(interpreted_text, "print_structured_text", wrong)

    @settings(FIXED, max_examples=300, report_multiple_bugs=False)
    @given(programs())
    def every_program(written: Written) -> None:
        proved(ProofItem("random", 1.0, written.program()), TEXTS[1:2], job=OddJob, scans=60)

    with pytest.raises(AssertionError, match=r"codesys: Difference") as caught:
        every_program()
    shown = "\n".join(caught.value.__notes__)
    assert "program = Program(" in shown
    assert 'b.operation("add"' in shown
    assert shown.count("b.operation(") <= 5, shown


def test_a_random_program_is_what_its_text_says():
    """What is shown of a failing example can be run again: it gives the same program."""

    @settings(FIXED, max_examples=20)
    @given(programs())
    def every_program(written: Written) -> None:
        assert digest(Written(str(written)).program()) == digest(written.program())

    every_program()


def test_every_macro_of_the_headers_is_refused_as_a_name(tmp_path):
    """A member of a structure that has the name of a macro is no member."""
    block = Block(1, (Operation(1, "square_root", (0,)),), (1,))
    printed = print_c(Program("law", (), (Signal("x"),), (), (Signal("y"),), block))
    for name, text in (
        (printed.header_name, printed.header),
        (printed.source_name, printed.source),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
    compiler = need_compiler()
    for standard in ("c99", "gnu99"):
        command = [compiler, f"-std={standard}", "-dM", "-E", str(tmp_path / printed.source_name)]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        macros = re.findall(r"^#define ([A-Za-z]\w*) ", said, re.MULTILINE)
        assert len(macros) > 50
        assert set(macros) <= C_WORDS | {"LAW_H"}
