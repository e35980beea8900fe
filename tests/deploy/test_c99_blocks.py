"""C of a law of blocks: a function each, printed once, with the same bits."""

import ctypes
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from deployed import STRICT, CompiledC
from driven_c import written
from law_of_blocks import law_of_blocks
from refusals import refused
from single_precision import InSinglePrecision
from tools import need, need_compiler

from clepsydra.base.signal import Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.write import write_fmu
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.imported_fmu import FmuError, run_fmu
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.reader import program_of, structured_program_of
from clepsydra.program.step_law import Equations, step_law

SCANS = 400


def scans():
    random = np.random.default_rng(3)
    return {
        "u": random.normal(0.0, 1.0, SCANS).astype(np.float32).astype(float),
        "cold": (random.random(SCANS) < 0.05) * 1.0,
        "most": random.integers(0, 9, SCANS) * 1.0,
    }


def both():
    """The law with its calls and without."""
    law = law_of_blocks()
    return structured_program_of(law), program_of(law)


def test_functions_compute_the_bits_of_the_kernel(tmp_path):
    structured, flat = both()
    found = CompiledC(structured, tmp_path).run(scans())
    assert np.ptp(found[:, 0]) > 1.0 and set(found[:, 1]) == {0.0, 1.0}
    np.testing.assert_array_equal(found, engine_run(flat, scans()))


def test_functions_compute_the_bits_of_single_precision(tmp_path):
    structured, flat = both()
    found = CompiledC(structured, tmp_path, "single").run(scans())
    np.testing.assert_array_equal(found, InSinglePrecision(flat).run(scans()))


PIPE = Block(
    "pipe",
    (Signal("inflow"),),
    (DelayRing(Signal("content", initial=0.5), 3), Signal("total")),
    (Signal("outflow"),),
    lambda s: Equations(
        {"content": s["inflow"], "total": s["total"] + s["content"]},
        {"outflow": s["content"] + s["total"]},
    ),
)


def test_what_no_instance_can_hold_stays_with_the_program(tmp_path):
    """A delay, and a state that is read beside its call."""

    def equations(s):
        state = {"content": s["content"], "total": s["total"]}
        pipe = PIPE("pipe", {"inflow": s["u"]}, state)
        return Equations(pipe.next_state, {"y": pipe.outputs["outflow"] + s["total"]})

    law = step_law(
        "law",
        inputs=[Signal("u")],
        parameters=[],
        state=PIPE.state,
        outputs=[Signal("y")],
        equations=equations,
    )
    structured = structured_program_of(law)
    inputs = {"u": scans()["u"]}
    found = CompiledC(structured, tmp_path).run(inputs)
    np.testing.assert_array_equal(found, engine_run(program_of(law), inputs))
    assert "_pipe_state" not in print_c(structured).header


def test_instances_that_keep_different_states_are_of_two_variants(tmp_path):
    law = law_of_blocks(shown=True)
    structured = structured_program_of(law)
    found = CompiledC(structured, tmp_path).run(scans())
    np.testing.assert_array_equal(found, engine_run(program_of(law), scans()))
    assert "two_filters_filter_2_step(&state->outer_filter" in print_c(structured).source


def test_a_scan_begins_from_any_state(tmp_path):
    structured, flat = both()
    expected = CompiledC(flat, tmp_path / "flat").run(scans())
    compiled = CompiledC(structured, tmp_path)
    before = np.array([compiled.state(), *expected[:-1, 2:]])
    assert compiled.state() == [signal.initial for signal in flat.state]
    np.testing.assert_array_equal(compiled.scan_by_scan(before, scans()), expected)


@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_an_fmu_computes_the_bits_of_the_kernel(version, tmp_path):
    need("fmpy")
    structured, flat = both()
    path = tmp_path / "filters.fmu"
    model = controller_model(structured, Origin("filters", "a process", "", 1.0))
    write_fmu(path, model, find_compiler("tests"), version=version)
    _, found = run_fmu(structured, path, tmp_path / "unpacked", 1.0, scans())
    np.testing.assert_array_equal(found, engine_run(flat, scans()))


def test_a_block_is_printed_once_before_those_that_call_it():
    printed = print_c(structured_program_of(law_of_blocks()))
    lines = printed.source.splitlines()
    functions = [line for line in lines if line.startswith("static void")]
    name = "two_filters"
    assert functions == [
        f"static void {name}_filter_step(",
        f"static void {name}_filter_pair_step(",
    ]
    assert printed.source.count(f"  {name}_filter_step(&state->") == 2
    assert printed.header.count(f"}} {name}_filter_state;") == 1
    assert "/* One sample of filter. Smooths its input. */" in lines
    assert max(map(len, [*lines, *printed.header.splitlines()])) <= 98


def test_a_state_stands_in_its_instance(tmp_path):
    program = structured_program_of(law_of_blocks())
    source = print_c(program).source
    assert (
        "  state->filter_pair.outer_filter.kept = 0.5; /* [1] */\n".replace("filter_pair", "pair")
        in source
    )
    for precision, size in (("double", 2 * 16), ("single", 2 * 12)):
        built = CompiledC(program, tmp_path / precision, precision)
        assert ctypes.sizeof(built.memory) == size


def test_two_controllers_of_the_same_blocks_stand_side_by_side(tmp_path):
    program, sources = structured_program_of(law_of_blocks()), []
    names = ("first_tank", "second_tank")
    for name in names:
        sources.append(written(print_c(replace(program, name=name)), tmp_path))
    user = tmp_path / "user.c"
    lines = [f'#include "{source.name}"' for source in sources]
    lines += ["int main(void)", "{"]
    lines += [f"  {name}_state {name};" for name in names]
    lines += [f"  {name}_initialise(&{name});" for name in names]
    user.write_text("\n".join([*lines, "  return 0;", "}", ""]))
    command = [need_compiler(), *STRICT, "-o", str(tmp_path / "user"), str(user)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_two_blocks_of_one_name_are_refused():
    other = Block(
        "filter", (Signal("x"),), (), (Signal("y"),), lambda s: Equations({}, {"y": s["x"]})
    )
    with pytest.raises(ValueError, match="two different blocks have the name filter"):
        print_c(structured_program_of(law_of_blocks(other)))


def test_a_block_whose_name_is_no_identifier_is_refused():
    other = Block("if", (Signal("x"),), (), (Signal("y"),), lambda s: Equations({}, {"y": s["x"]}))
    with refused(place="program if", expected="no word of C"):
        print_c(structured_program_of(law_of_blocks(other)))


@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_an_fmu_is_freed_where_it_does_not_run(version, tmp_path, monkeypatch):
    need("fmpy")
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave

    freed = []
    for kind in (FMU2Slave, FMU3Slave):
        free = kind.freeInstance
        monkeypatch.setattr(kind, "freeInstance", lambda fmu, free=free: freed.append(free(fmu)))
    structured, _ = both()
    path, origin = tmp_path / "filters.fmu", Origin("filters", "a process", "", 1.0)
    write_fmu(path, controller_model(structured, origin), find_compiler("tests"), version=version)
    more = replace(structured, outputs=(*structured.outputs, Signal("more")))
    with pytest.raises(FmuError, match="no variable more"):
        run_fmu(more, path, tmp_path / "unpacked", 1.0, scans())
    assert len(freed) == 1
