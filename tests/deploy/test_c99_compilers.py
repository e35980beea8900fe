"""Printed C by compilers at their strictest, as C++, under sanitizers, and by zig."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from deployed import CompiledC, all_bits
from driven_c import built, written
from driven_c import run as run_driver
from families import PROCESSES, bare, family
from tools import need, need_compiler

from clepsydra import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.proof.compiled_c import CompiledC as Compiled
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

STRICT = [
    "-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Wshadow",
    "-Wdouble-promotion", "-Wfloat-conversion", "-Werror", "-ffp-contract=off",
]  # fmt: skip
ROOT = Program(
    "root", (), (Signal("u"),), (), (Signal("y"),),
    Block(1, (Operation(1, "square_root", (0,)),), (1,)),
)  # fmt: skip
PRECISIONS = ["double", "single"]
#: Each law in one precision, in turn.
CASES = [(name, PRECISIONS[place % 2]) for place, name in enumerate(PROCESSES)]
#: A PID, a delay ring, and counted loops with tables.
DIFFERENT = ("PI, SIMC", "Smith predictor, PI", "Fuzzy PI")

pytestmark = pytest.mark.thorough


def run(command: list[str]) -> subprocess.CompletedProcess:
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize(("name", "precision"), CASES)
def test_no_warning_at_all(name, precision, tmp_path):
    ready = family(name)[1]
    printed = print_c(ready.program, origin=ready.origin, precision=precision)
    source = written(printed, tmp_path)
    done = run([need_compiler(), *STRICT, "-c", "-o", str(tmp_path / "law.o"), str(source)])
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("precision", PRECISIONS)
def test_the_header_is_one_of_cpp_too(precision, tmp_path):
    compiler, user = need_compiler(), tmp_path / "user.cpp"
    strict = [compiler, "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    user.write_text("")
    if run([*strict, str(user)]).returncode != 0:
        pytest.skip("the C compiler has no C++")
    ready = family("LQI with Kalman filter")[1]
    written(print_c(ready.program, origin=ready.origin, precision=precision), tmp_path)
    name = ready.program.name
    user.write_text(
        f'#include "{name}.h"\n#include "{name}.h"\n'
        f"void begin({name}_state &state) {{ {name}_initialise(&state); }}\n"
    )
    done = run([*strict, "-Wconversion", "-Wshadow", str(user)])
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("precision", "accepted"), [("double", {0, 1, 16, 32, 64}), ("single", {0, 16, 32})]
)
def test_a_compiler_that_evaluates_otherwise_is_stopped(precision, accepted, tmp_path):
    source = written(print_c(ROOT, precision=precision), tmp_path)
    found = set()
    for method in (-1, 0, 1, 2, 16, 32, 64, 128):
        other = ["-U__FLT_EVAL_METHOD__", f"-D__FLT_EVAL_METHOD__={method}"]
        done = run([need_compiler(), "-std=c99", "-fsyntax-only", *other, str(source)])
        if done.returncode == 0:
            found.add(method)
        else:
            assert "this compiler does not evaluate" in done.stderr
    assert found == accepted
    done = run([need_compiler(), "-std=c99", "-fsyntax-only", "-ffast-math", str(source)])
    assert "compile without -ffast-math" in done.stderr


@pytest.mark.parametrize(
    ("precision", "macro"), [("double", "__DBL_MANT_DIG__"), ("single", "__FLT_MANT_DIG__")]
)
def test_a_compiler_with_other_numbers_is_stopped(precision, macro, tmp_path):
    source = written(print_c(ROOT, precision=precision), tmp_path)
    other = [f"-U{macro}", f"-D{macro}=11"]
    done = run([need_compiler(), "-std=c99", "-fsyntax-only", *other, str(source)])
    assert "another number than that of IEEE 754" in done.stderr


SANITIZED = [
    "-std=c99", "-O1", "-g", "-ffp-contract=off", "-fsanitize=address,undefined",
    "-fsanitize=float-cast-overflow", "-fno-sanitize-recover=all",
]  # fmt: skip


def need_sanitizers(folder: Path) -> None:
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    program = str(folder / "empty")
    if run([need_compiler(), *SANITIZED, "-o", program, f"{program}.c"]).returncode != 0:
        pytest.skip("the C compiler has no sanitizers")


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("name", DIFFERENT)
def test_nothing_is_undefined_whatever_comes_in(name, precision, tmp_path):
    """Outside of any range too: no address, no conversion and no sum of integers goes wrong."""
    need_sanitizers(tmp_path)
    ready = family(name)[1]
    program, scans = ready.program, 1000
    inputs = random_scans(program, scans, 4, ready.process.sampling_period)
    inputs = {signal.name: inputs[signal.name] for signal in program.inputs}
    if precision == "single":  # no overflow in the driver's own conversion
        with np.errstate(over="ignore"):
            inputs = {name: row.astype(np.float32).astype(float) for name, row in inputs.items()}
    printed = print_c(program, precision=precision)
    driver = built([need_compiler(), *SANITIZED], program, printed, tmp_path)
    found = run_driver([str(driver)], program, inputs)
    expected = CompiledC(program, tmp_path / "plain", precision).run(inputs)
    np.testing.assert_array_equal(all_bits(found), all_bits(expected))


@pytest.mark.parametrize("precision", PRECISIONS)
def test_another_compiler_makes_the_same_bits(precision, tmp_path):
    """The C of the package ziglang, which is clang, with all its warnings."""
    need("ziglang")
    program = bare("PID, phase margin")
    zig = Compiler((sys.executable, "-m", "ziglang", "cc"), "zig", tuple(STRICT))
    inputs = random_scans(program, 500, 8, 1.0)
    found = Compiled(program, tmp_path / "zig", precision, zig).run(inputs)
    expected = CompiledC(program, tmp_path / "plain", precision).run(inputs)
    np.testing.assert_array_equal(all_bits(found), all_bits(expected))
