"""CasADi's instruction lists read into programs, and what is refused."""

import math

import casadi as ca
import numpy as np
import pytest
from block_interpreter import bits, evaluate_block
from random_laws import random_law

from clepsydra import ClepsydraError, Kernel, Signal, program_of
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Block
from clepsydra.program.reader import inline
from clepsydra.program.step_law import Equations, step_law

NAN, INF = math.nan, math.inf
NUMBERS = [0.0, -0.0, 1.0, -2.5, 1e300, math.nextafter(1e300, INF), 1e308, INF, -INF, NAN]


def read(function: ca.Function) -> Block:
    size = sum(function.numel_in(i) for i in range(function.n_in()))
    builder = BlockBuilder(size)
    return builder.finish(inline(builder, function, range(size)))


def codes(block: Block) -> list[str]:
    return [operation.code for operation in block.operations()]


def unary(expression) -> Block:
    a = ca.SX.sym("a")
    return read(ca.Function("f", [a], [expression(a)]))


def binary(expression) -> Block:
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    return read(ca.Function("f", [a, b], [expression(a, b)]))


@pytest.mark.parametrize("seed", range(20))
def test_a_random_law_read_and_interpreted_is_casadi_bit_for_bit(seed):
    law = random_law(500 + seed, printed=True)
    program = program_of(law)
    random = np.random.default_rng(seed)
    size = len(law.state), len(law.inputs), len(law.parameters)
    for _ in range(20):
        state, inputs, parameters = (random.normal(size=n) for n in size)
        next_state, outputs, _ = law.function(state, inputs, parameters)
        expected = np.concatenate([np.array(next_state).ravel(), np.array(outputs).ravel()])
        got = evaluate_block(program.block, [*state, *inputs, *parameters])
        # Zeros may differ in sign: CasADi writes a choice as a sum.
        assert bits(np.array(got) + 0.0) == bits(expected + 0.0)


def test_maximum_and_minimum_are_a_comparison_and_a_choice():
    maximum, minimum = binary(ca.fmax), binary(ca.fmin)
    assert codes(maximum) == ["maximum"] and codes(minimum) == ["minimum"]
    for a in NUMBERS:
        for b in NUMBERS:
            assert bits(evaluate_block(maximum, [a, b])) == bits([a if a > b else b])
            assert bits(evaluate_block(minimum, [a, b])) == bits([a if a < b else b])


def test_a_choice_becomes_one_select_and_never_mixes_its_branches():
    block = binary(lambda a, b: ca.if_else(a > 0, b, 1 / a))
    assert codes(block).count("select") == 1
    assert evaluate_block(block, [2.0, 7.0]) == [7.0]
    assert evaluate_block(block, [-4.0, NAN]) == [-0.25]
    assert evaluate_block(block, [1.0, INF]) == [INF]
    assert evaluate_block(block, [NAN, 3.0])[0] != 3.0
    nested = binary(lambda a, b: ca.if_else(a > 0, ca.if_else(b > 0, 1.5, a), ca.if_else(b, b, 8)))
    assert codes(nested).count("select") == 3
    for a in NUMBERS:
        for b in NUMBERS:
            expected = (1.5 if b > 0 else a) if a > 0 else (b if b != 0 else 8.0)
            assert bits(evaluate_block(nested, [a, b])) == bits([expected])


def test_not_a_number_is_found_before_any_limit():
    block = unary(lambda a: ca.logic_not(ca.fabs(a) <= 1e300))
    for a in NUMBERS:
        expected = math.isnan(a) or abs(a) > 1e300
        assert evaluate_block(block, [a]) == [float(expected)]
    limited = unary(
        lambda a: ca.if_else(ca.logic_not(ca.fabs(a) <= 1e300), -1, ca.fmin(ca.fmax(a, 0), 10))
    )
    assert [evaluate_block(limited, [a])[0] for a in (NAN, INF, -INF, 4.0, -4.0, 40.0)] == [
        -1.0,
        -1.0,
        -1.0,
        4.0,
        0.0,
        10.0,
    ]


def test_the_sign_of_a_number():
    block = unary(ca.sign)
    expected = [(3.0, 1.0), (-3.0, -1.0), (INF, 1.0), (-INF, -1.0), (0.0, 0.0), (-0.0, -0.0)]
    for a, sign in [*expected, (5e-324, 1.0), (-5e-324, -1.0)]:
        assert bits(evaluate_block(block, [a])) == bits([sign])
    assert bits(evaluate_block(block, [NAN])) == bits([NAN])


def test_kernels_keep_these_meanings_for_one_run_and_for_a_batch():
    law = step_law(
        "meanings",
        inputs=[],
        parameters=[Signal("a"), Signal("b")],
        state=[Signal("turn")],
        outputs=[Signal(n) for n in ("maximum", "minimum", "select", "bad", "limited", "sign")],
        equations=lambda s: Equations(
            {"turn": s["turn"] + 1},
            {
                "maximum": ca.fmax(s["a"] + 0 * s["turn"], s["b"]),
                "minimum": ca.fmin(s["a"], s["b"] + 0 * s["turn"]),
                "select": ca.if_else(s["a"] > s["b"], s["a"], s["turn"]),
                "bad": ca.logic_not(ca.fabs(s["a"]) <= 1e300),
                "limited": ca.fmin(s["b"], ca.fmax(0, s["a"])),
                "sign": ca.sign(s["a"]),
            },
        ),
    )
    pairs = [(a, b) for a in NUMBERS for b in NUMBERS]
    kernel = Kernel(program_of(law), fuse=False)
    given = {name: np.array([pair[i] for pair in pairs]) for i, name in enumerate("ab")}
    batch = kernel.run(2, parameters=given)
    for scenario, (a, b) in enumerate(pairs):
        low = 0.0 if a < 0 else a  # max(0, a) is 0 > a ? 0 : a, so not a number stays
        expected = [
            a if a > b else b,
            a if a < b else b,
            a if a > b else 1.0,
            float(math.isnan(a) or abs(a) > 1e300),
            b if b < low else low,
            math.copysign(1.0, a) if a else a,
        ]
        if math.isnan(a):
            expected[-1] = NAN
        got = batch.record_of(scenario)[1]
        assert bits(got + 0.0) == bits(np.array(expected) + 0.0), (a, b)
        if scenario % 7 == 0:
            one = kernel.run(2, parameters={"a": a, "b": b})
            assert bits(one.record_of(0)[1]) == bits(got), (a, b)


def test_structural_zeros_of_outputs_are_zeros():
    a, b = ca.SX.sym("a"), ca.SX.sym("b", 2)
    sparse = ca.SX(3, 2)
    sparse[0, 1], sparse[2, 0] = a * b[0], b[1]
    block = read(ca.Function("f", [a, b], [sparse, ca.SX(2, 1), a]))
    assert evaluate_block(block, [2.0, 3.0, 5.0]) == [0, 0, 5, 6, 0, 0, 0, 0, 2]


def test_a_call_that_is_no_loop_is_read_in_place():
    x = ca.SX.sym("x", 2)
    called = ca.Function("called", [x], [x[0] * x[1], x[0] - x[1]], {"never_inline": True})
    y = ca.SX.sym("y", 2)
    product, difference = called(ca.vertcat(y[1], 3 * y[0]))
    whole = ca.Function("whole", [y], [product + 1, difference])
    assert any(whole.instruction_id(k) == ca.OP_CALL for k in range(whole.n_instructions()))
    block = read(whole)
    assert len(block.statements) == len(codes(block))
    assert evaluate_block(block, [2.0, 5.0]) == [31.0, -1.0]


def test_a_call_with_structural_zeros_is_read_in_place():
    x = ca.SX.sym("x", 2)
    sparse = ca.SX(3, 1)
    sparse[0], sparse[2] = x[1], x[0] * 2
    called = ca.Function("called", [x], [sparse, x[0] + x[1]], {"never_inline": True})
    y = ca.SX.sym("y", 2)
    column, total = called(y)
    block = read(ca.Function("whole", [y], [column, total]))
    assert evaluate_block(block, [3.0, 4.0]) == [4.0, 0.0, 6.0, 7.0]


@pytest.mark.parametrize(
    "expression",
    [
        lambda a: ca.erfinv(a),
        lambda a: ca.remainder(a, 3),
        lambda a: ca.SX.binary(ca.OP_PRINTME, a, 1),
    ],
)
def test_an_operation_that_no_target_prints_is_refused_by_name_of_the_law(expression):
    a = ca.SX.sym("a")
    with pytest.raises(ClepsydraError, match=r"^strange: .*operation.*; write the law with"):
        read(ca.Function("strange", [a], [expression(a)]))


def test_a_function_over_mx_is_refused():
    a = ca.MX.sym("a")
    with pytest.raises(ClepsydraError, match=r"^matrix: .*MXFunction.*casadi\.SX"):
        read(ca.Function("matrix", [a], [2 * a]))
    x = ca.SX.sym("x")
    decay = ca.Function("decay", [x], [-x])
    carried = ca.integrator("carried", "rk", {"x": x, "ode": decay(x)}, 0.0, 1.0)
    with pytest.raises(ClepsydraError, match=r"^carried: .*casadi\.SX"):
        inline(BlockBuilder(1), carried, [0])


def test_a_wrong_number_of_values_is_refused():
    a = ca.SX.sym("a", 3)
    with pytest.raises(ClepsydraError, match="2 values for 3 scalar arguments"):
        inline(BlockBuilder(2), ca.Function("f", [a], [a]), [0, 1])


def test_program_of_keeps_the_order_and_the_names_of_the_law():
    law = step_law(
        "ordered",
        inputs=[Signal("u")],
        parameters=[Signal("p")],
        state=[Signal("x"), Signal("z")],
        outputs=[Signal("sum"), Signal("late")],
        equations=lambda s: Equations(
            {"z": s["x"], "x": s["z"] * s["p"]},
            {"late": s["u"], "sum": (s["u"] + s["p"]) * 2},
            {"inner": s["u"] + s["p"]},
        ),
    )
    program = program_of(law)
    x, z, u, p = 2.0, 3.0, 5.0, 7.0
    assert evaluate_block(program.block, [x, z, u, p]) == [z * p, x, (u + p) * 2, u]
    assert list(program.state_arguments) == [0, 1]
    assert list(program.input_arguments) == [2] and list(program.parameter_arguments) == [3]
    assert program.next_state == program.block.results[:2]
    assert program.output_values == program.block.results[2:]
    (named,) = program.names
    statements = {operation.target: operation for operation in program.block.operations()}
    assert program.names[named] == "inner"
    assert statements[named].code == "add" and set(statements[named].arguments) == {2, 3}
