"""Whatever a PLC does to a block: it is the engine in every bit, within limits, and says so.

Late, missing and absurd time steps, absurd parameters, lost state and sensors that come and go.
"""

from functools import cache

import numpy as np
import pytest
from deployed import all_bits
from driven_c import built, run
from families import IN_DOUBLE, family
from matiec import OPENPLC, CompiledByMatiec, Matiec
from strained_scans import FAILED_SAFE, Expected, lives, strained_scans
from test_c99_everywhere import BUILDS, tool

from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.structured_text.project import Project, print_test_project


@cache
def strained(name):
    """Scans of a family's block, and what the engine makes of each life of it."""
    ready = family(name)[1]
    scans = strained_scans(ready.program, 5, ready.process.sampling_period)
    return scans, [engine_run(ready.program, life) for life in lives(scans)]


@pytest.mark.sampled
@pytest.mark.parametrize("name", IN_DOUBLE)
def test_outputs_stay_within_limits_and_the_status_says_what_happened(name):
    program = family(name)[1].program
    scans, found = strained(name)
    shown = dict(zip((s.name for s in program.outputs), np.vstack(found).T, strict=False))
    expected = Expected(program, scans)
    for signal, low, high in expected.limits():
        out, word = shown[signal.name], shown[f"{signal.owner}.status"].astype(int)
        assert np.all((out >= low) & (out <= high)), signal.name
        for bit, told in expected.status.items():
            np.testing.assert_array_equal((word & bit) > 0, told, err_msg=f"{signal.owner} {bit}")
            assert told.any() and not told.all()
        safe = (word & FAILED_SAFE > 0) & (scans[f"{signal.owner}.mode"] == 1)
        value = expected.in_force(f"{signal.owner}.fail_safe")
        np.testing.assert_array_equal(out[safe], np.clip(value, low, high)[safe])
        assert safe.sum() > 100 and len(np.unique(out[~safe])) > 1


@pytest.mark.sampled
@pytest.mark.parametrize("build", ["gcc", "clang", "ARM"])
@pytest.mark.parametrize("name", IN_DOUBLE)
def test_compiled_c_is_the_engine_in_every_bit(name, build, tmp_path):
    ready = family(name)[1]
    compiler, flags, runner = BUILDS[build]
    command, prefix = [tool(compiler), *flags], [tool(each) for each in runner]
    driver = built(command, ready.program, print_c(ready.program, origin=ready.origin), tmp_path)
    scans, engine = strained(name)
    for life, expected in zip(lives(scans), engine, strict=True):
        found = run([*prefix, str(driver)], ready.program, life)
        np.testing.assert_array_equal(all_bits(found), all_bits(expected))


@pytest.mark.thorough
@pytest.mark.parametrize("name", IN_DOUBLE)
def test_the_whole_project_by_matiec_is_the_engine_in_every_bit(name, tmp_path):
    """The block of the text that OpenPLC compiles, with process, program and task."""
    Matiec()
    ready = family(name)[1]
    project = Project(
        ready.program, process_program(ready.point), ready.wires, ready.process.sampling_period,
        ready.origin, dialect="matiec",
    )  # fmt: skip
    text = print_test_project(project)
    scans, engine = strained(name)
    block = CompiledByMatiec(ready.program, tmp_path, text=text, options=OPENPLC)
    for life, expected in zip(lives(scans), engine, strict=True):
        block.begin()
        np.testing.assert_array_equal(all_bits(block.run(life)), all_bits(expected))
