"""Random programs, controllers and processes, exported to every target and proved equal."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterable
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest
from deployed import need_compiler, need_grammar, need_importer
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_programs import EVERYTHING, Written, codes_of, odd_scans, programs

from clepsydra.base.errors import InputError
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.targets import Target, targets_of
from clepsydra.program.program import Program

FIXED = settings(
    derandomize=True,
    database=None,
    deadline=None,
    print_blob=False,
    suppress_health_check=list(HealthCheck),
)
SCANS = 300
TEXTS = ("Structured Text, matiec", "Structured Text, codesys", "Structured Text, scl")
#: What every random example runs on; FMUs take longest to build, so only some examples get one.
USUAL = ("C", *TEXTS, "Structured Text")


def in_tiers(few: int, many: int):
    """A few examples in the fast tier, many in the thorough one."""
    return pytest.mark.parametrize(
        "examples", [few, pytest.param(many, marks=pytest.mark.thorough)]
    )


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@cache
def target_named(name: str, kind: str = "controller") -> Target:
    """Return a target; in single precision only for the text, which is compared with C."""
    wanted = "single" if name == "Structured Text" else "double"
    found = targets_of(kind, find_compiler("tests"))
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
                difference, bound, _ = target.measure(work)
            except InputError as refusal:
                assert is_justified(refusal, work.program, target, nasty), f"{name}: {refusal}"
                continue
            differs = difference.decisions > 0 or difference.largest > (bound or 0.0)
            if bound == 0.0:
                differs = difference.differing > 0
            assert not differs, f"{name}: {difference}"
        return work


def is_justified(
    refusal: InputError, program: Program, target: Target, nasty: tuple[str, ...]
) -> bool:
    """Whether there is something in a program that a target has to refuse."""
    said = str(refusal)
    if any(f", {name}" in said for name in nasty):
        return True
    constants = [o.constant for o in program.block.operations() if o.code == "constant"]
    if not all(map(math.isfinite, constants)) and "finite number" in said:
        return True
    return target.precision == "single" and "print it in double precision" in said


fmu_or_none = st.sampled_from([(), (), (), ("FMU 3.0",), ("FMU 2.0",)])


@in_tiers(8, 120)
def test_programs_of_every_statement(examples):
    seen: set[str] = set()

    @settings(FIXED, max_examples=examples)
    @given(programs(), fmu_or_none)
    def every_program(written: Written, more: tuple[str, ...]) -> None:
        program = written.program()
        seen.update(codes_of(program))
        proved(ProofItem("random", 1.0, program), USUAL + more, job=OddJob)

    every_program()
    if examples > 50:
        assert seen >= EVERYTHING, EVERYTHING - seen
