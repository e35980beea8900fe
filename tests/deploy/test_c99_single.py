"""C with float against NumPy's float32, operation by operation, in every bit."""

import dataclasses

import deployed
import numpy as np
import pytest
from block_interpreter import evaluate_block
from deployed import CompiledC
from families import PROCESSES, bare, family
from random_blocks import random_block
from single_precision import InSinglePrecision, single_bits

from clepsydra import Signal
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.operation import EXACT
from clepsydra.program.program import Program

SCANS = 1_500


def equal_in_every_bit(program: Program, folder, inputs: dict[str, np.ndarray]) -> np.ndarray:
    in_c = CompiledC(program, folder, "single").run(inputs)
    second = InSinglePrecision(program).run(inputs)
    np.testing.assert_array_equal(single_bits(in_c), single_bits(second))
    return in_c


@pytest.mark.thorough
@pytest.mark.parametrize("name", PROCESSES)
def test_a_bare_law_in_float_is_its_operations_in_single_precision(name, tmp_path):
    program = bare(name)
    # exp, pow and others are the C library's own single-precision ones on both sides.
    inputs = random_scans(program, SCANS // 3, seed=5, sampling_period=1.0)
    found = equal_in_every_bit(program, tmp_path, inputs)
    assert len({tuple(row) for row in found[:, : len(program.outputs)]}) > 100


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["PI, SIMC", "LQI with Kalman filter", "Start/stop levels"])
def test_a_law_in_its_plant_shell_is_too(name, tmp_path):
    ready = family(name)[1]
    assert all(operation.code in EXACT for operation in ready.program.block.operations())
    period = ready.process.sampling_period
    inputs = random_scans(ready.program, SCANS, seed=6, sampling_period=period)
    equal_in_every_bit(ready.program, tmp_path, inputs)


def test_single_precision_differs_from_double_by_its_rounding_only(tmp_path):
    """So it is computed in single precision, and the law is the same one."""
    program = bare("PI, SIMC")
    period = family("PI, SIMC")[1].process.sampling_period
    inputs = random_scans(program, 500, seed=7, sampling_period=period, broken=False)
    in_float = CompiledC(program, tmp_path / "f", "single").run(inputs)
    in_double = CompiledC(program, tmp_path / "d").run(inputs)
    difference = np.max(np.abs(in_float - in_double)[:, : len(program.outputs)])
    assert 0.0 < difference < 1e-3


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
def test_random_blocks(seed, tmp_path, monkeypatch):
    """Loops, branches and every operation, with constants of both signs and of all sizes."""
    unread = [f"-Wno-unused-{what}" for what in ("but-set-variable", "variable", "const-variable")]
    monkeypatch.setattr(deployed, "STRICT", [*deployed.STRICT, *unread])
    special = (0.0, -0.0, 1.0, -1.0, 1e30, -1e-30, 0.1)
    plain, _ = random_block(9000 + seed, 4, 6, nesting=0.1, library=False, special=special)
    signals = tuple(Signal(f"x{i}") for i in range(4))
    outputs = tuple(Signal(f"y{i}") for i in range(6))
    program = Program("random", (), signals, (), outputs, plain)
    random = np.random.default_rng(seed)
    columns = random.normal(size=(4, 60)) * 10.0 ** random.integers(-20, 20, size=(4, 60))
    columns[:, ::7] = random.choice(
        [0.0, -0.0, np.nan, np.inf, -np.inf], size=columns[:, ::7].shape
    )
    inputs = {signal.name: column for signal, column in zip(signals, columns, strict=True)}
    found = equal_in_every_bit(program, tmp_path, inputs)
    # The statements compute what the plain interpreter of doubles does, but for the rounding.
    exact = evaluate_block(plain, [1.0, 2.0, -3.0, 0.5])
    ones = {f"x{i}": np.array([value]) for i, value in enumerate([1.0, 2.0, -3.0, 0.5])}
    again = CompiledC(dataclasses.replace(program, name="again"), tmp_path / "a").run(ones)
    np.testing.assert_array_equal(np.array([exact]), again)
    assert found.shape == (60, 6)
