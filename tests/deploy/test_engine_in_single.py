"""What the engine computes in single precision against C with float, NumPy and a loop by C."""

import numpy as np
import pytest
from deployed import CompiledC
from families import PROCESSES, bare, family
from plants import plant
from random_blocks import random_block
from single_precision import InSinglePrecision, single_bits

import clepsydra as cl
from clepsydra import Signal
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.precision import in_single_arithmetic
from clepsydra.program.program import Block, Program

SCANS = 1_000
#: Where a function has other arguments than those between 0 and 1.
_RANGE = {"pow": (0.0, 3.0), "acosh": (1.0, 9.0)}


def in_single(inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    with np.errstate(all="ignore"):
        return {
            name: column.astype(np.float32).astype(float) if column.dtype.kind == "f" else column
            for name, column in inputs.items()
        }


@pytest.mark.sampled
@pytest.mark.parametrize("shelled", [False, True], ids=["bare", "in its shell"])
@pytest.mark.parametrize("name", PROCESSES)
def test_the_engine_has_every_bit_of_the_c_with_float(name, shelled, tmp_path):
    ready = family(name)[1]
    program = ready.program if shelled else bare(name)
    period = ready.process.sampling_period
    inputs = in_single(random_scans(program, SCANS, seed=11, sampling_period=period))
    in_engine = engine_run(in_single_arithmetic(program), inputs)
    in_c = CompiledC(program, tmp_path, "single").run(inputs)
    np.testing.assert_array_equal(single_bits(in_engine), single_bits(in_c))
    if name == "Start/stop levels" and not shelled:
        return  # by comparisons alone, which rounded inputs leave as they are
    in_double = engine_run(program, inputs)
    assert not np.array_equal(single_bits(in_engine), single_bits(in_double.astype(np.float32)))


@pytest.mark.parametrize("seed", range(3))
def test_loops_branches_and_every_operation_are_rounded(seed):
    special = (0.0, -0.0, 1.0, -1.0, 1e30, -1e-30, 0.1)
    block, _ = random_block(7000 + seed, 4, 6, nesting=0.4, library=False, special=special)
    signals = tuple(Signal(f"x{i}") for i in range(4))
    program = Program("random", (), signals, (), tuple(Signal(f"y{i}") for i in range(6)), block)
    random = np.random.default_rng(seed)
    columns = random.normal(size=(4, 60)) * 10.0 ** random.integers(-20, 20, size=(4, 60))
    columns[:, ::7] = random.choice([0.0, -0.0, np.nan, np.inf], size=columns[:, ::7].shape)
    inputs = in_single(dict(zip((s.name for s in signals), columns, strict=True)))
    in_engine = engine_run(in_single_arithmetic(program), inputs)
    np.testing.assert_array_equal(
        single_bits(in_engine), single_bits(InSinglePrecision(program).run(inputs))
    )


@pytest.mark.parametrize("code", LIBRARY)
def test_a_function_is_that_of_the_c_library_within_two_units_in_the_last_place(code):
    """The engine's is the double rounded; tanhf and others of the GNU C library err by so much."""
    count = LIBRARY[code]
    names = [f"x{i}" for i in range(count)]
    block = Block(count, (Operation(count, code, tuple(range(count))),), (count,))
    program = Program("function", (), tuple(map(Signal, names)), (), (Signal("y"),), block)
    low, high = _RANGE.get(code, (0.01, 0.99))
    random = np.random.default_rng(1)
    inputs = in_single({name: random.uniform(low, high, 2000) for name in names})
    in_engine = engine_run(in_single_arithmetic(program), inputs)
    apart = single_bits(in_engine) - single_bits(InSinglePrecision(program).run(inputs))
    assert np.abs(apart).max() <= (0 if code in ("fmod", "copysign") else 2)


@pytest.mark.sampled
@pytest.mark.parametrize("shelled", [False, True], ids=["bare", "in its shell"])
@pytest.mark.parametrize("name", PROCESSES)
def test_a_loop_in_single_precision_moves_as_the_c_does(name, shelled, tmp_path):
    """With what never changes folded in the engine: the C is told it, with what it measures."""
    rig, ready = plant(PROCESSES[name]), family(name)[1]
    controller = ready.controller if shelled else cl.study(rig, only=name).best.controller
    program, loop = controller.program(), Loop(controller, rig.linear)
    scenario = default_scenario(rig.linear)
    run = loop.run(scenario, precision="single").values
    rest = loop.at_rest()
    told = [
        loop.law_inputs(rest | {key: column[k] for key, column in run.items()})
        for k in range(scenario.samples)
    ]
    inputs = in_single(dict(zip((s.name for s in program.inputs), np.array(told).T, strict=True)))
    outputs = CompiledC(program, tmp_path, "single").run(inputs)[:, : len(program.outputs)]
    moved = [loop.told_by_law(row) for row in outputs]
    wires = [wire for wire in moved[0] if wire in run]
    assert set(controller.manipulated) < set(wires)
    for wire in wires:
        np.testing.assert_array_equal([each[wire] for each in moved], run[wire])
