"""Printed text through matiec, the compiler of OpenPLC and Beremiz: it runs as the engine does.

Skipped where the compiler is not: name iec2c by CLEPSYDRA_MATIEC, or put it on the path.
"""

import numpy as np
import pytest
from matiec import CompiledByMatiec, Matiec
from structured_text_programs import every_kind, flow_of_pipe, pipe
from test_operations import NASTY, NUMBERS, TRUTHS, every_operation, program_of_block
from test_proof_of_structures import FORMS, program_under_test
from tools import need

from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.interpreted_text import InterpretedText
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS

SCANS = 1000
CONTROLLERS = [
    *(("quadruple-tank", name) for name in (
        "PI, SIMC", "PI, SIMC, dynamic decoupling", "PI, variable structure", "PID, phase margin",
        "LQI, Bryson", "LQI with Kalman filter", "LQI with extended Kalman filter",
        "LQI, gain scheduling", "LQI, recomputed", "LQR with precompensator",
        "2DOF polynomial, LQ", "Feedback linearisation", "Glover-McFarlane on PI, SIMC",
        "Fuzzy PI", "State feedback, pole placement")),
    ("averaging-tank", "PI, gain scheduling"),
    ("wet-well:start-stop", "Start/stop levels"),
]  # fmt: skip

pytestmark = pytest.mark.thorough


def bits(values: np.ndarray) -> np.ndarray:
    """The bits of numbers; every not-a-number counts as the same one."""
    values = np.ascontiguousarray(values, dtype=float)
    return np.where(np.isnan(values), -1, values.view(np.int64))


def designed(process: str, name: str):
    analysis = analyse(load_process(process))
    period = analysis.operating_point.process.sampling_period
    return analysis, with_plant_shell(DESIGNS[name](analysis), period), period


@pytest.mark.parametrize(("process", "name"), CONTROLLERS)
def test_a_controller_runs_as_in_the_engine(process, name, tmp_path):
    """With whatever goes wrong in a plant, bit for bit; in single precision as interpreted."""
    need("tree_sitter_iec61131_3_st")
    Matiec()
    _, controller, period = designed(process, name)
    program = controller.program()
    inputs = random_scans(program, SCANS, 1, period)
    found = CompiledByMatiec(program, tmp_path / "double").run(inputs)
    assert np.array_equal(bits(found), bits(engine_run(program, inputs)))
    single = CompiledByMatiec(program, tmp_path / "single", "single").run(inputs)
    interpreted = InterpretedText(program, "single").run(inputs)
    assert np.array_equal(bits(single), bits(interpreted))
    assert not np.array_equal(single, found)


@pytest.mark.parametrize("name", [*FORMS, "scheme"])
def test_every_form_of_pid_and_a_scheme_of_all_blocks(name, tmp_path):
    Matiec()
    program = program_under_test(name)
    inputs = random_scans(program, SCANS, 3, 1.0)
    found = CompiledByMatiec(program, tmp_path).run(inputs)
    assert np.array_equal(bits(found), bits(engine_run(program, inputs)))


@pytest.mark.parametrize("name", ["quadruple-tank", "equalisation-tank:relief", "wet-well",
                                  "averaging-tank", "laboratory-four-tanks"])  # fmt: skip
def test_a_process_moves_as_in_the_engine(name, tmp_path):
    Matiec()
    process = load_process(name)
    program = process_program(find_equilibrium(process), 2)
    inputs = random_scans(program, SCANS, 2, process.sampling_period, broken=False)
    found = CompiledByMatiec(program, tmp_path).run(inputs)
    assert np.array_equal(bits(found), bits(engine_run(program, inputs)))


def test_every_exact_operation_on_nasty_numbers(tmp_path):
    Matiec()
    a, b = (grid.ravel() for grid in np.meshgrid(NASTY, NASTY))
    with np.errstate(all="ignore"):
        expected = np.column_stack([f(a, b) for f in [*NUMBERS.values(), *TRUTHS.values()]])
    found = CompiledByMatiec(program_of_block(every_operation(), 2), tmp_path)
    assert np.array_equal(bits(found.run({"u0": a, "u1": b})), bits(expected))


@pytest.mark.parametrize("precision", ["double", "single"])
def test_all_types_tables_and_rings(precision, tmp_path):
    need("tree_sitter_iec61131_3_st")
    Matiec()
    random = np.random.default_rng(4)
    inputs = {"u": random.normal(scale=1e6, size=200), "good": random.integers(2, size=200) * 1.0}
    found = CompiledByMatiec(every_kind(), tmp_path, precision).run(inputs)
    expected = InterpretedText(every_kind(), precision).run(inputs)
    assert np.array_equal(bits(found), bits(expected))


def test_rings_of_loops(tmp_path):
    Matiec()
    given = np.random.default_rng(2).normal(size=40)
    found = CompiledByMatiec(pipe(), tmp_path).run({"u": given})[:, 0]
    assert found.tolist() == flow_of_pipe(given.tolist())
