"""The test project of every family as OpenPLC compiles it: with matiec, as it stands in the file.

Skipped where the compiler is not: name iec2c by CLEPSYDRA_MATIEC, or put it on the path.
"""

import ctypes
import re

import numpy as np
import pytest
from families import IN_DOUBLE, family
from matiec import HEAD, OPENPLC, Matiec
from schemes import SCHEMES, scheme
from tools import need

from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.text.interpreter import StructuredText
from clepsydra.deploy.structured_text.project import Project, print_test_project
from clepsydra.deploy.structured_text.time_literal import time_literal

SCANS = 300
POINTER = ctypes.POINTER(ctypes.c_double)
PROJECT = (
    HEAD
    + """#include "Config0.c"
#include "Res0.c"
void start(void) {{ config_init__(); }}
void scan(const double *given, double *found)
{{
{writes}
    config_run__(0);
{reads}
}}
"""
)

pytestmark = pytest.mark.thorough


def test_project(name: str, precision: str) -> Project:
    """What an export writes as NAME_test.st."""
    ready = (scheme if name in SCHEMES else family)(name)[1]
    tank = process_program(ready.point)
    period = ready.process.sampling_period
    return Project(
        ready.program, tank, ready.wires, period, ready.origin, precision=precision,
        dialect="matiec",
    )  # fmt: skip


test_project.__test__ = False


@pytest.mark.parametrize(
    ("name", "precision"),
    [*((name, "double") for name in (*IN_DOUBLE, *SCHEMES)),
     ("PI, SIMC", "single"), ("cascade", "single")],
)  # fmt: skip
def test_a_test_project_is_compiled_as_a_whole_and_runs_as_it_is_read(name, precision, tmp_path):
    """matiec takes blocks, process, program and task, and runs what the interpreter runs.

    Setpoints, modes, values in manual and disturbances are moved as an engineer would.
    """
    need("tree_sitter_iec61131_3_st")
    matiec = Matiec()
    project = test_project(name, precision)
    text = print_test_project(project)
    matiec.translate(text, tmp_path, OPENPLC)
    program = project.units[-1]
    ticks = round(project.sampling_period * 1e9)
    assert f"common_ticktime__ = {ticks}ULL" in (tmp_path / "Config0.c").read_text()
    assert time_literal(project.sampling_period) in text
    real = "REAL" if precision == "single" else "LREAL"
    _, given, shown = program.sections[0].groups
    given = [e for e in given[1] if e.type == real or e.name.endswith("_mode")]
    seen = [e.name for e in shown[1] if e.type in (real, "DINT")]
    interpreted = StructuredText(text).instance(program.name)
    place = f"RES0__INSTANCE_OF_{program.name.upper()}"
    library = matiec.build(
        PROJECT.format(
            writes="\n".join(f"    {place}.{e.name.upper()}.value = given[{k}];"
                             for k, e in enumerate(given)),
            reads="\n".join(f"    found[{k}] = {place}.{name.upper()}.value;"
                            for k, name in enumerate(seen)),
        ), tmp_path, "project",
    )  # fmt: skip
    library.start()
    rest = np.array([float(re.sub("^.*#", "", e.initial[0])) for e in given])
    number = np.float32 if precision == "single" else float
    random, moved, rows = np.random.default_rng(3), set(), np.zeros(len(seen))
    numbers = rest.copy()
    for scan in range(SCANS):
        if scan % 50 == 0:
            for k, each in enumerate(given):
                mode = each.name.endswith("_mode")
                near = rest[k] * random.uniform(0.95, 1.05)
                numbers[k] = random.integers(2) if mode else number(near)
        for each, value in zip(given, numbers, strict=True):
            exact = int(value) if each.name.endswith("_mode") else number(value)
            interpreted.state[each.name] = exact
        library.scan(numbers.ctypes.data_as(POINTER), rows.ctypes.data_as(POINTER))
        interpreted.run()
        assert rows.tolist() == [float(interpreted.state[name]) for name in seen]
        moved.add(tuple(rows))
    assert len(moved) > SCANS / 2
    assert interpreted.state["watchdog"] == SCANS
