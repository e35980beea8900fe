"""Programs that are printed in parts, against the same program as one function, bit for bit."""

import numpy as np
import pytest
from block_interpreter import bits
from moving_processes import moving
from patched_printers import keep_nothing
from random_blocks import random_block, stimulus
from test_loop_rings import ring_program

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine import vector_parts
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.vector_code import vector_code
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import ForLoop, Program
from clepsydra.program.step_law import Equations, step_law

LANES = 8
SAMPLES = 12


def in_parts(monkeypatch, largest: int) -> None:
    keep_nothing(monkeypatch)
    monkeypatch.setattr(vector_parts, "LARGEST_WHOLE", 0)
    monkeypatch.setattr(vector_parts, "LARGEST_PART", largest)


def parts_of(program: Program, **form) -> int:
    return vector_code(program, KernelForm(LANES, **form)).count("@clepsydra_part") // 2


def everything(program: Program, scenarios: int, *, record=True, **given) -> list[np.ndarray]:
    """Return the final state, then what was recorded."""
    kernel = Kernel(program, lanes=LANES, record=record)
    run = kernel.run(SAMPLES, threads=1, **given)
    assert run.scenarios == scenarios
    records = [run.record_of(scenario) for scenario in range(scenarios)] if record else []
    return [run.final_state, *records]


def agree(monkeypatch, program: Program, largest: int, scenarios: int, **given) -> None:
    whole = everything(program, scenarios, **given)
    with monkeypatch.context() as patch:
        in_parts(patch, largest)
        parts = everything(program, scenarios, **given)
        state, *_ = everything(program, scenarios, record=False, **given)
    assert [bits(array.ravel()) for array in parts] == [bits(array.ravel()) for array in whole]
    assert bits(state.ravel()) == bits(whole[0].ravel())


@pytest.mark.thorough
@pytest.mark.parametrize(("seed", "largest"), list(enumerate([1, 3, 10, 40] * 4)))
def test_random_programs(seed, largest, monkeypatch):
    """With nested loops and conditionals, which stand between parts where they are larger."""
    _, block = random_block(7000 + seed, 4, 6, nesting=0.15, library=True)
    rows = stimulus(seed, SAMPLES, 4)
    outputs = tuple(Signal(f"y{i}") for i in range(1, 6))
    program = Program(
        f"random_{seed}", (Signal("x"),), (Signal("u1"), Signal("u2")), (Signal("p"),),
        outputs, block,
    )  # fmt: skip
    inputs = {"u1": rows[:, 1], "u2": rows[:, 2]}
    agree(monkeypatch, program, largest, 1, inputs=inputs, parameters={"p": 0.7})
    given = {"p": np.linspace(-2.0, 2.0, 11)}
    agree(monkeypatch, program, largest, 11, inputs=inputs, parameters=given)


@pytest.mark.parametrize(("length", "largest"), [(1, 1), (5, 2), (13, 5), (13, 1), (1, 5)])
def test_rings_of_loops_and_of_the_state(length, largest, monkeypatch):
    program = ring_program(length)
    u, gain = np.sin(np.arange(SAMPLES)), np.linspace(-1.0, 1.0, 9)
    agree(monkeypatch, program, largest, 1, inputs={"u": u})
    agree(monkeypatch, program, largest, 9, inputs={"u": u}, parameters={"gain": gain})


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "substeps"),
    [("quadruple-tank", 1), ("quadruple-tank", 3), ("wet-well", 2), ("three-tanks", 1)],
)
def test_processes_of_the_catalogue(name, substeps, monkeypatch):
    point, program = moving(name, substeps)
    process, outside = point.process, program.inputs
    at = point.as_dict()
    scale = np.linspace(0.5, 1.5, 10)
    start = motion_at_rest(point)
    inputs = {signal.name: at[signal.name] for signal in outside}
    level = process.motion.contents[0].name
    agree(monkeypatch, program, 50, 1, state=start, inputs=inputs)
    agree(monkeypatch, program, 50, 10, state=start | {level: scale * start[level]}, inputs=inputs)


def shifted() -> Program:
    """x1⁺ = u, x2⁺ = x1, x3⁺ = x2, x4⁺ = x4, x5⁺ = 3: next states that are no new values."""
    law = step_law(
        "shifted",
        inputs=[Signal("u")],
        parameters=[],
        state=[Signal(f"x{i}", initial=float(i)) for i in range(1, 6)],
        outputs=[Signal("y")],
        equations=lambda s: Equations(
            {"x1": s["u"], "x2": s["x1"], "x3": s["x2"], "x4": s["x4"], "x5": 3.0},
            {"y": s["x3"] * s["x4"]},
        ),
    )
    return program_of(law)


def test_states_that_move_on_do_not_overwrite_each_other(monkeypatch):
    in_parts(monkeypatch, 1)
    run = Kernel(shifted()).run(4, inputs={"u": np.array([10.0, 20.0, 30.0, 40.0])})
    assert run.output("y").tolist() == [[12.0, 8.0, 4.0, 40.0]]
    assert run.final_state.ravel().tolist() == [40.0, 30.0, 20.0, 4.0, 3.0]


def fused_across_parts() -> Program:
    """Products at the start, the sums that absorb them at the end, roots in between."""
    builder = BlockBuilder(4)
    products = [builder.operation("multiply", i, 3, fused=True) for i in range(3)]
    roots = [builder.operation("square_root", i) for i in range(3)]
    sums = [
        builder.operation(code, *(pair if code == "add" else pair[::-1]), fused=True)
        for code, pair in zip(
            ("add", "subtract", "add"), zip(products, roots, strict=True), strict=True
        )
    ]
    state, inputs = (
        (Signal("x", initial=0.1),),
        (Signal("u", initial=0.3), Signal("v", initial=7.1)),
    )
    outputs = tuple(Signal(f"y{i}") for i in range(3))
    block = builder.finish([sums[0], *sums])
    return Program("fused", state, inputs, (Signal("k", initial=1 / 3),), outputs, block)


def test_what_is_fused_in_one_function_is_fused_in_parts(monkeypatch):
    program = fused_across_parts()
    agree(monkeypatch, program, 1, 1)
    agree(monkeypatch, program, 1, 5, parameters={"k": np.linspace(0.1, 0.7, 5)})
    in_parts(monkeypatch, 1)
    code = vector_code(program, KernelForm(LANES))
    assert code.count("call <8 x double> @llvm.fma") == 3
    assert "fmul" not in code


def test_parts_are_as_large_as_they_may_be(monkeypatch):
    """Six operations that are printed: three roots and three sums with their products."""
    program = fused_across_parts()
    assert parts_of(program) == 0
    for largest, parts in ((1, 6), (2, 3), (4, 2), (6, 1)):
        in_parts(monkeypatch, largest)
        assert parts_of(program) == parts


def test_a_loop_that_is_larger_than_a_part_stands_between_parts(monkeypatch):
    turn = BlockBuilder(2)
    value = 0
    for _ in range(6):
        value = turn.operation("square_root", turn.operation("add", value, 1))
    builder = BlockBuilder(2)
    (value,) = builder.loop("roots", turn.finish([value]), 5, (), [0], [1])
    block = builder.finish([value, value])
    assert isinstance(block.statements[0], ForLoop)
    program = Program(
        "roots", (Signal("x"),), (Signal("u", initial=2.0),), (), (Signal("y"),), block
    )
    in_parts(monkeypatch, 4)
    assert parts_of(program) == 3
    root = Kernel(program).run(1).output("y")[0, 0]
    assert root == pytest.approx(2.0, rel=1e-15)  # x = √(x + 2)


@pytest.mark.parametrize("largest", [1, 4])
def test_an_adjustable_loop_makes_the_turns_of_the_run(largest, monkeypatch):
    """x = 2x + 1 in each turn, which is a part of its own or smaller than one."""
    turn, builder = BlockBuilder(1), BlockBuilder(1)
    body = turn.finish([turn.operation("add", turn.operation("add", 0, 0), turn.constant(1.0))])
    block = builder.finish(builder.loop("steps", body, 2, (), [0], [], adjustable=True))
    program = Program("steps", (Signal("x"),), (), (), (), block)
    in_parts(monkeypatch, largest)
    kernel = Kernel(program)
    assert [kernel.run(1, turns=n).state("x")[0] for n in (None, 1, 5)] == [3.0, 1.0, 31.0]


def test_what_only_outputs_need_is_not_computed_where_none_are_recorded(monkeypatch):
    in_parts(monkeypatch, 1)
    program = fused_across_parts()
    assert parts_of(program, record=False) == 2
