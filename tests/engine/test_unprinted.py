"""Code that is printed only where it is not kept: what is kept is found by the content alone."""

import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from random_laws import random_law
from test_loop_rings import ring_program

import clepsydra
from clepsydra import Kernel, Signal, program_of
from clepsydra.engine import batch_noise, compiler, host, unprinted
from clepsydra.engine.batch_noise import BatchNoise, InputNoise
from clepsydra.engine.kernel_code import kernel_code
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.noise_code import noise_code
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.unprinted import Unprinted, source_digest
from clepsydra.engine.vector_code import vector_code
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program


class Printed(Exception):
    """Something was printed."""


@pytest.fixture
def no_printer(monkeypatch):
    """Let no printer print from the call on."""

    def refuse(_):
        raise Printed

    def stop():
        monkeypatch.setattr("clepsydra.engine.vector_code._KernelPrinter.code", refuse)
        monkeypatch.setattr("clepsydra.engine.noise_code._NoisePrinter.code", refuse)

    return stop


def test_what_is_kept_is_not_printed(tmp_path, no_printer):
    program, cache = program_of(random_law(1)), ObjectCache(tmp_path / "kernels")
    first = Kernel(program, cache=cache).run(20).record_of(0)
    no_printer()
    assert np.array_equal(Kernel(program, cache=cache).run(20).record_of(0), first, equal_nan=True)
    with pytest.raises(Printed):
        Kernel(program, fuse=False, cache=cache).run(20)


def test_the_noise_of_a_kernel_that_is_kept_is_not_printed(tmp_path, no_printer):
    program, cache = program_of(random_law(2)), ObjectCache(tmp_path / "kernels")
    name = program.inputs[0].name
    noise = BatchNoise({name: InputNoise(1, 0.1, 0, 20)}, seed=1)
    first = Kernel(program, cache=cache).run(20, noise=noise).record_of(0)
    batch_noise._function.cache_clear()
    no_printer()
    again = Kernel(program, cache=cache).run(20, noise=noise).record_of(0)
    assert np.array_equal(again, first, equal_nan=True)
    batch_noise._function.cache_clear()
    (object_of_noise,) = (
        file
        for file in cache.folder.iterdir()
        if b"clepsydra_noise" in file.read_bytes()
    )  # fmt: skip
    object_of_noise.unlink()
    with pytest.raises(Printed):
        Kernel(program, cache=cache).run(20, noise=noise)


def test_a_page_that_is_kept_is_not_printed(tmp_path, no_printer, monkeypatch):
    monkeypatch.setenv("CLEPSYDRA_CACHE", str(tmp_path / "kernels"))
    program = program_of(random_law(3))
    module = web_assembly(program)
    no_printer()
    assert web_assembly(program) == module
    with pytest.raises(Printed):
        web_assembly(program, record=False)


def scaled(constant: float) -> Program:
    statements = Operation(1, "constant", (), constant), Operation(2, "multiply", (0, 1))
    block = Block(1, statements, (2,))
    return Program("scaled", (), (Signal("u", initial=1.0),), (), (Signal("y"),), block)


def test_a_constant_that_differs_in_its_last_bit_is_compiled(tmp_path):
    cache = ObjectCache(tmp_path / "kernels")
    constants = [0.1, math.nextafter(0.1, 1.0), 0.0, -0.0]
    for constant in constants:
        kernel = Kernel(scaled(constant), cache=cache)
        assert kernel.function(1).was_cached is False
        assert kernel.run(1).output("y").tobytes() == np.array([[constant]]).tobytes()
    assert all(Kernel(scaled(each), cache=cache).function(1).was_cached for each in constants)


def test_whatever_a_kernel_is_made_for_is_part_of_its_key(tmp_path, monkeypatch):
    cache, program = ObjectCache(tmp_path / "kernels"), program_of(random_law(4))
    one, another = program.inputs[0].name, program.inputs[1].name
    settings = [
        {}, {"fuse": False}, {"record": False}, {"individual": [one]}, {"individual": [another]},
    ]  # fmt: skip

    def were_kept() -> list[bool]:
        return [
            Kernel(program, cache=cache, **each).function(lanes, noisy).was_cached
            for each in settings
            for lanes in (1, 4)
            for noisy in (frozenset(), frozenset({one}), frozenset({another}))
        ]

    if not host.host().fuses:  # nothing to leave out
        settings.remove({"fuse": False})
    assert not any(were_kept())
    assert all(were_kept())
    monkeypatch.setattr(compiler, "host", lambda: replace(host.host(), features="of another"))
    assert not any(were_kept())


@pytest.mark.parametrize(
    ("place", "name"),
    [
        (unprinted, "_PRINTED_BY"), (host.llvmlite, "__version__"),
        (host.llvm, "llvm_version_info"),
    ],
    ids=["source", "llvmlite", "LLVM"],
)  # fmt: skip
def test_another_version_of_what_prints_and_compiles_is_a_miss(tmp_path, monkeypatch, place, name):
    cache, program = ObjectCache(tmp_path / "kernels"), program_of(random_law(1))

    def was_kept() -> bool:
        return Kernel(program, cache=cache).function(1).was_cached

    assert (was_kept(), was_kept()) == (False, True)
    monkeypatch.setattr(place, name, "99")
    assert (was_kept(), was_kept()) == (False, True)


def test_any_change_of_the_source_changes_its_digest(tmp_path):
    source = Path(clepsydra.__file__).parent
    for package in ("base", "engine", "program"):
        shutil.copytree(source / package, tmp_path / package)
    whole = source_digest(tmp_path)
    assert whole == source_digest(source) == unprinted._PRINTED_BY.partition(" ")[0]
    shutil.rmtree(tmp_path / "engine" / "__pycache__", ignore_errors=True)
    assert source_digest(tmp_path) == whole
    for name in ("engine/step_order.py", "program/program.py", "program/routines/__init__.py"):
        file = tmp_path / name
        content = file.read_bytes()
        file.write_bytes(content + b"#")
        assert source_digest(tmp_path) != whole
        file.write_bytes(content)
        moved = file.rename(file.with_name("moved.py"))
        assert source_digest(tmp_path) != whole
        moved.rename(file)
    assert source_digest(tmp_path) == whole


def test_names_units_and_initial_values_are_no_part_of_a_kernel():
    program = ring_program(3)
    other = program.with_signals(
        lambda each: replace(each, name=f"other.{each.name}", unit="m", initial=each.initial + 1)
    )
    other = replace(other, name="other", description=("Rings.",), words={"out": "flows"})
    forms = KernelForm(4, frozenset({"u"})), KernelForm(4, frozenset({"other.u"}))
    one, same = kernel_code(program, forms[0]), kernel_code(other, forms[1])
    assert one.content == same.content
    code = vector_code(program, forms[0])
    assert code == vector_code(other, forms[1]) == one.code() == same.code()


@pytest.mark.parametrize("seed", range(6))
def test_the_content_differs_where_the_code_does(seed):
    """Each constant of a law by its last bit, each sum by what it adds; and back again."""
    program = program_of(random_law(100 + seed, printed=True))
    form = KernelForm(2)

    def changed(each: Operation) -> Operation:
        if each.code == "constant":
            return replace(each, constant=math.nextafter(each.constant, math.inf))
        return replace(each, code={"add": "subtract", "subtract": "add"}.get(each.code, each.code))

    statements = program.block.statements
    programs = [
        replace(program, block=replace(program.block, statements=(
            *statements[:place], changed(each), *statements[place + 1 :]
        )))
        for place, each in enumerate(statements)
    ]  # fmt: skip
    found = [kernel_code(each, form) for each in [program, *programs]]
    contents, codes = [each.content for each in found], [each.code() for each in found]
    assert len(set(codes)) > 5
    by_content = dict(zip(contents, codes, strict=True))
    assert [by_content[content] for content in contents] == codes


CHILD = """
import sys
sys.path[:0] = sys.argv[1:]
from random_laws import random_law
from test_loop_rings import ring_program
from clepsydra import program_of
from clepsydra.engine.host import host
from clepsydra.engine.kernel_code import kernel_code
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.noise_code import noise_code
from clepsydra.engine.unprinted import Unprinted
form = KernelForm(8, frozenset("abcdefu"), processor=host(), noisy=frozenset({"u", "i", "j"}))
laws = random_law(1), random_law(2, printed=True)
for program in (*map(program_of, laws), ring_program(3)):
    print(kernel_code(program, form).content)
print(Unprinted.by(noise_code, form).content)
"""


def test_every_process_finds_the_same_content():
    """However it hashes words, which orders its sets."""
    here = Path(__file__).parent
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    answers = {
        subprocess.run(
            [sys.executable, "-c", CHILD, str(here)],
            env={**environment, "PYTHONHASHSEED": seed}, capture_output=True, check=True, text=True,
        ).stdout
        for seed in ("0", "1", "2")
    }  # fmt: skip
    (answer,) = answers
    form = KernelForm(
        8, frozenset("abcdefu"), processor=host.host(), noisy=frozenset({"u", "i", "j"})
    )
    *kernels, noise = answer.split()
    assert len(set(kernels)) == 3
    assert kernels[2] == kernel_code(ring_program(3), form).content
    assert noise == Unprinted.by(noise_code, form).content
