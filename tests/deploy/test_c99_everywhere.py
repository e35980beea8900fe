"""Printed C by gcc, clang and for ARM: it is the engine in every bit, whatever it is built with."""

import platform
import shutil
import subprocess
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from deployed import all_bits
from driven_c import built, run, written
from families import PROCESSES, family

from clepsydra import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.proof.comparison import compare, shown_signals
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

#: With the fused multiply-add of this machine, where it has one.
NATIVE = ["-O2", "-march=native"]
ARM = ["-O2", "-static"]
#: Compiler, flags, and what runs the program. gcc fuses by default without -std=c99, and clang
#: within a statement; the ARM of 64 bits has the fused operation in any case.
BUILDS = {
    "gcc": ("gcc", NATIVE, ()),
    "gcc, gnu99": ("gcc", [*NATIVE, "-std=gnu99"], ()),
    "gcc, told to fuse": ("gcc", [*NATIVE, "-ffp-contract=fast"], ()),
    "clang": ("clang", NATIVE, ()),
    "clang, gnu99": ("clang", [*NATIVE, "-std=gnu99"], ()),
    "ARM": ("aarch64-linux-gnu-gcc", ARM, ("qemu-aarch64",)),
    "ARM, gnu99": ("aarch64-linux-gnu-gcc", [*ARM, "-std=gnu99"], ("qemu-aarch64",)),
}
#: The law in which rounding shows most.
SENSITIVE = "Feedback linearisation"
FUSED = Program(
    "fused", (), (Signal("u"),), (), (Signal("y"),),
    Block(1, (Operation(1, "multiply", (0, 0)), Operation(2, "subtract", (1, 0))), (2,)),
)  # fmt: skip


def tool(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


@cache
def expected(name: str, scans: int):
    ready = family(name)[1]
    inputs = random_scans(ready.program, scans, 8, ready.process.sampling_period)
    return inputs, engine_run(ready.program, inputs)


def check(name, build, scans, folder):
    compiler, flags, runner = BUILDS[build]
    command, prefix = [tool(compiler), *flags], [tool(each) for each in runner]
    if "-march=native" in flags and platform.machine() != "x86_64":
        command.remove("-march=native")
    inputs, engine = expected(name, scans)
    ready = family(name)[1]
    driver = built(command, ready.program, print_c(ready.program, origin=ready.origin), folder)
    found = run([*prefix, str(driver)], ready.program, inputs)
    np.testing.assert_array_equal(all_bits(found), all_bits(engine))


def test_it_equals_the_engine_in_every_bit(tmp_path):
    check(SENSITIVE, "gcc", 2000, tmp_path)


@pytest.mark.thorough
@pytest.mark.parametrize("build", BUILDS)
@pytest.mark.parametrize("name", PROCESSES)
def test_every_family_equals_the_engine_in_every_bit(name, build, tmp_path):
    check(name, build, 2000, tmp_path)


@pytest.mark.thorough
@pytest.mark.parametrize("name", PROCESSES)
def test_where_operations_are_fused_all_the_same_outputs_move_by_rounding_only(name, tmp_path):
    """As a runtime may do that compiles Structured Text: no branch hangs on a last bit."""
    ready = family(name)[1]
    printed = print_c(ready.program)
    fused = replace(printed, source=printed.source.replace("fp-contract=off", "fp-contract=fast"))
    assert fused != printed
    inputs, engine = expected(name, 10_000)
    driver = built([tool("gcc"), *NATIVE], ready.program, fused, tmp_path)
    found = compare(shown_signals(ready.program), engine, run([str(driver)], ready.program, inputs))
    assert found.largest < 1e-12, found


@pytest.mark.parametrize("compiler", ["gcc", "clang", "aarch64-linux-gnu-gcc"])
def test_what_it_cannot_undo_it_refuses(compiler, tmp_path):
    command, source = tool(compiler), written(print_c(FUSED), tmp_path)

    def said(flag: str) -> str:
        build = [command, "-std=c99", flag, "-fsyntax-only", str(source)]
        return subprocess.run(build, capture_output=True, text=True).stderr

    assert said("-O2") == ""
    for flag in ("-ffast-math", "-Ofast"):
        assert "compile without -ffast-math and its parts" in said(flag)
    assert "compile without -ffinite-math-only" in said("-ffinite-math-only")
    if "gcc" in compiler:
        for flag in ("-funsafe-math-optimizations", "-freciprocal-math", "-fno-signed-zeros"):
            assert "compile without -ffast-math and its parts" in said(flag)
