"""Conditionals in kernels: a plain interpreter in every lane, bit for bit."""

import math

import numpy as np
import pytest
from block_interpreter import bits, evaluate_block
from random_blocks import SPECIAL, random_block, stimulus

from clepsydra import Kernel, Signal
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.vector_code import vector_code
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Block, Program

ARGUMENTS, RESULTS, SAMPLES = 4, 6, 4


def random_program(seed: int, depth: int) -> tuple[Program, Block, np.ndarray]:
    plain, built = random_block(seed, ARGUMENTS, RESULTS, depth, nesting=0.3 / depth, library=False)
    rows = stimulus(seed, SAMPLES, ARGUMENTS)
    program = Program(
        f"random_{seed}",
        (Signal("x", initial=rows[0, 0]),),
        (Signal("u1"), Signal("u2")),
        (Signal("p"),),
        tuple(Signal(f"y{i}") for i in range(1, RESULTS)),
        built,
    )
    return program, plain, rows


@pytest.mark.parametrize(
    ("seed", "depth"),
    [
        *((seed, 1) for seed in range(3)),
        *(pytest.param(seed, 2, marks=pytest.mark.thorough) for seed in range(10)),
    ],
)
def test_kernel_and_interpreter_agree_bit_for_bit(seed, depth):
    """Nineteen scenarios fill one group of lanes or more; each has a parameter of its own."""
    program, plain, rows = random_program(9000 + seed, depth)
    kernel = Kernel(program, fuse=False)
    inputs = {"u1": rows[:, 1], "u2": rows[:, 2]}
    given = np.array([*SPECIAL, 0.7, -1.3, 3.1, 0.01, -0.2, 1.5, 25.0])
    batch = kernel.run(SAMPLES, inputs=inputs, parameters={"p": given}, threads=2)
    for scenario, p in enumerate(given):
        one = kernel.run(SAMPLES, inputs=inputs, parameters={"p": float(p)})
        state = rows[0, 0]
        for k, row in enumerate(rows):
            state, *expected = evaluate_block(plain, [state, *row[1:-1], p])
            assert bits(one.record_of(0)[k]) == bits(expected)
            assert bits(batch.record_of(scenario)[k]) == bits(expected)
        assert bits(batch.state("x")[scenario : scenario + 1]) == bits([state])


def root_program() -> Program:
    """x⁺ = x; y is √x by bisection of [0, 64] in a loop, where x is above the limit."""
    turn = BlockBuilder(3)
    middle = turn.operation("multiply", turn.constant(0.5), turn.operation("add", 0, 1))
    above = turn.operation("less", turn.operation("multiply", middle, middle), 2)
    halved = turn.finish(
        [
            turn.operation("select", above, middle, 0),
            turn.operation("select", above, 1, middle),
        ]
    )
    body = BlockBuilder(2)
    zero, top = body.constant(0.0), body.constant(64.0)
    _, root = body.loop("bisection", halved, 12, [], [zero, top], [1])
    builder = BlockBuilder(2)
    wanted = builder.operation("less", 1, 0)
    (found,) = builder.conditional("root", wanted, body.finish([root]), [0], [0])
    return Program(
        "root", (Signal("x"),), (Signal("limit"),), (), (Signal("y"),), builder.finish([0, found])
    )


@pytest.mark.parametrize("above", [(), (3,), (0, 5, 18), tuple(range(19))])
def test_a_loop_inside_a_conditional_in_some_lanes(above):
    """Squares of multiples of 1/8 below 32, so that twelve halvings hit the root exactly."""
    roots = 0.125 * np.arange(2.0, 21.0)
    x = np.where(np.isin(np.arange(19), above), roots**2, -1.0 - roots)
    run = Kernel(root_program()).run(3, inputs={"limit": 0.0}, state={"x": x})
    expected = np.where(x > 0, roots, x)
    assert np.array_equal(run.output("y"), np.repeat(expected[:, None], 3, axis=1))


def test_what_one_lane_makes_of_its_numbers_reaches_no_other():
    """The root of a negative number, and a division by zero, in lanes that do not need them."""
    body = BlockBuilder(1)
    root = body.finish([body.operation("divide", body.constant(1.0), body.operation(
        "square_root", 0))])  # fmt: skip
    builder = BlockBuilder(1)
    positive = builder.operation("less", builder.constant(0.0), 0)
    (found,) = builder.conditional("root", positive, root, [0], [])
    program = Program("p", (Signal("x"),), (), (), (Signal("y"),), builder.finish([0, found]))
    x = np.array([4.0, -4.0, 0.0, -0.0, math.nan, math.inf, -math.inf, 0.25] * 3)
    found = Kernel(program).run(1, state={"x": x}).output("y")[:, 0]
    assert bits(found) == bits([0.5, -4.0, 0.0, -0.0, math.nan, 0.0, -math.inf, 2.0] * 3)


def limited(condition_reads_state: bool) -> Program:
    """p, or its root where p (or x) is above 1; x⁺ = x + 1."""
    body = BlockBuilder(1)
    root = body.finish([body.operation("square_root", 0)])
    builder = BlockBuilder(2)
    one = builder.constant(1.0)
    above = builder.operation("less", one, 0 if condition_reads_state else 1)
    (found,) = builder.conditional("root", above, root, [1], [])
    block = builder.finish([builder.operation("add", 0, one), found])
    return Program("p", (Signal("x"),), (), (Signal("p"),), (Signal("y"),), block)


@pytest.mark.parametrize("lanes", [1, 8])
def test_what_depends_on_parameters_only_is_computed_once(lanes):
    once = vector_code(limited(False), KernelForm(lanes))
    every_sample = vector_code(limited(True), KernelForm(lanes))
    assert once.index("when1:") < once.index("sample.head:")
    assert every_sample.index("when1:") > every_sample.index("sample.body:")


@pytest.mark.parametrize("scenarios", [1, 11])
def test_a_hoisted_conditional_and_one_of_the_state(scenarios):
    p = np.arange(scenarios) ** 2.0
    root = np.arange(scenarios) * 1.0
    constant = Kernel(limited(False)).run(4, parameters={"p": p})
    assert np.array_equal(constant.output("y"), np.repeat(root[:, None], 4, axis=1))
    changing = Kernel(limited(True)).run(4, parameters={"p": p})
    assert np.array_equal(changing.output("y"), np.column_stack([p, p, root, root]))


@pytest.mark.parametrize("lanes", [1, 8])
def test_the_body_stands_behind_a_branch(lanes):
    """All that computes the body is between the branch and the end of the conditional."""
    code = vector_code(limited(True), KernelForm(lanes))
    call = code.index("call", code.index("@llvm.sqrt", code.index("define")) - 30)
    assert code.index("label %when1, label %when1.done") < code.index("when1:") < call
    assert call < code.index("when1.done:")
