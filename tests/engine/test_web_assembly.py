"""Kernels as WebAssembly, run by Wasmtime: every recorded value is that of the native kernel."""

import numpy as np
import pytest
from hosted_runs import as_bits, assert_same, run_in_module
from patched_printers import keep_nothing
from random_laws import random_law
from tools import need

from clepsydra import Kernel, program_of
from clepsydra.base.signal import Signal
from clepsydra.engine.vector_code import KERNEL
from clepsydra.engine.web_assembly import HEAP, web_assembly
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Block, Program

SAMPLES = 50


@pytest.fixture(autouse=True)
def _tools():
    need("wasmtime")


@pytest.mark.parametrize("seed", [pytest.param(s, id=str(s)) for s in range(60)])
@pytest.mark.sampled
def test_random_laws_compute_the_same_in_every_bit(seed):
    assert_same(program_of(random_law(seed, printed=True)), SAMPLES)


def imports_and_exports(module: bytes) -> tuple[list[str], set[str]]:
    import wasmtime

    found = wasmtime.Module(wasmtime.Engine(), module)
    imported = [f"{each.module}.{each.name}" for each in found.imports]
    return imported, {each.name for each in found.exports}


def many_numbers(seed: int) -> np.ndarray:
    """Return numbers of every size, and special ones."""
    random = np.random.default_rng(seed)
    found = np.concatenate([
        random.normal(scale=3.0, size=3000), random.uniform(-1.0, 1.0, 3000),
        random.uniform(-750.0, 720.0, 3000), 2.0 ** random.uniform(-1074.0, 1023.0, 3000),
        np.repeat([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan], 20),
    ])  # fmt: skip
    return random.permutation(found)


@pytest.mark.parametrize("code", ["square_root", *LIBRARY])
def test_every_function_is_in_the_module(code):
    """At many arguments, also where a result is below the normal range, infinite or none."""
    arguments = LIBRARY.get(code, 1)
    block = Block(arguments, (Operation(arguments, code, tuple(range(arguments))),), (arguments,))
    inputs = tuple(Signal(f"u{place}") for place in range(arguments))
    program = Program(f"{code}_of_u", (), inputs, (), (Signal("y"),), block)
    given = {signal.name: many_numbers(place) for place, signal in enumerate(inputs)}
    job = Kernel(program, fuse=False).prepare(len(given["u0"]), inputs=given)
    module = web_assembly(program)
    record, _ = run_in_module(module, job)
    assert np.array_equal(as_bits(record), as_bits(job.run().record_of(0)))
    assert imports_and_exports(module) == (["env.memory"], {KERNEL, HEAP})


def test_a_large_program_has_its_memory_from_the_machine(monkeypatch):
    """Its values stand in memory, which a second call uses again."""
    program = program_of(random_law(1))
    keep_nothing(monkeypatch)
    monkeypatch.setattr("clepsydra.engine.vector_code.stands_in_parts", lambda _: True)
    assert_same(program, SAMPLES)
    assert imports_and_exports(web_assembly(program))[0] == ["env.memory"]
