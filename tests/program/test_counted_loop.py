"""Counted loops: values against closed forms, and loops that stay loops on the way."""

import casadi as ca
import numpy as np
import pytest
from block_interpreter import bits, evaluate_block
from refusals import refused

from clepsydra import Kernel, Signal, program_of
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.counted_loop import counted_loop, recover_loop
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, ForLoop, Program
from clepsydra.program.reader import inline
from clepsydra.program.step_law import Equations, step_law


def read(function: ca.Function) -> Block:
    size = sum(function.numel_in(i) for i in range(function.n_in()))
    builder = BlockBuilder(size)
    return builder.finish(inline(builder, function, range(size)))


def loops(block: Block) -> list[ForLoop]:
    return [statement for statement in block.statements if isinstance(statement, ForLoop)]


def horner() -> ca.Function:
    row, total, x = ca.SX.sym("row"), ca.SX.sym("total"), ca.SX.sym("x")
    return ca.Function("horner", [row, total, x], [total * x + row])


def polynomial(x: ca.SX, coefficients) -> ca.SX:
    return counted_loop(
        "polynomial",
        len(coefficients),
        horner(),
        carried=ca.SX(0),
        tables=[coefficients],
        invariants=x,
    )


@pytest.mark.parametrize("count", [1, 2, 3, 25])
def test_a_polynomial_by_horners_rule(count):
    coefficients = [float(k % 5 - 2) for k in range(count)]
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [polynomial(x, coefficients)])
    block = read(function)
    (loop,) = loops(block)
    assert (loop.count, loop.tables, loop.name) == (count, (tuple(coefficients),), "polynomial")
    # Whole numbers stay exact, so every order of evaluation gives the same.
    for value in (-3.0, 2.0, 0.0):
        expected = float(sum(c * int(value) ** k for k, c in enumerate(coefficients[::-1])))
        assert float(function(value)) == expected
        assert evaluate_block(block, [value]) == [expected]


def test_a_loop_without_tables_and_invariants_counts():
    body = ca.Function(
        "fibonacci",
        [ca.SX.sym("row", 0), (pair := ca.SX.sym("pair", 2)), ca.SX.sym("held", 0)],
        [ca.vertcat(pair[1], pair[0] + pair[1])],
    )
    start = ca.SX.sym("start", 2)
    function = ca.Function("f", [start], [counted_loop("turns", 10, body, carried=start)])
    assert np.array(function([0, 1])).ravel().tolist() == [55.0, 89.0]
    assert evaluate_block(read(function), [0.0, 1.0]) == [55.0, 89.0]


def test_carried_values_may_be_structural_zeros():
    row, pair, held = ca.SX.sym("row", 2), ca.SX.sym("pair", 2), ca.SX.sym("held")
    body = ca.Function("sums", [row, pair, held], [pair + row * held])
    x = ca.SX.sym("x")
    sums = counted_loop(
        "sums", 3, body, carried=ca.SX(2, 1), tables=[[1, 2, 3], [10, 20, 30]], invariants=x
    )
    assert evaluate_block(read(ca.Function("f", [x], [sums])), [2.0]) == [12.0, 120.0]


def test_a_body_may_set_a_carried_value_to_a_structural_zero():
    row, pair = ca.SX.sym("row"), ca.SX.sym("pair", 2)
    following = ca.SX(2, 1)
    following[0] = pair[0] + pair[1] + row
    body = ca.Function("first", [row, pair, ca.SX.sym("held", 0)], [following])
    start = ca.SX.sym("start", 2)
    function = ca.Function(
        "f", [start], [counted_loop("first", 3, body, carried=start, tables=[[1, 2, 3]])]
    )
    assert np.array(function([10, 100])).ravel().tolist() == [116.0, 0.0]
    assert evaluate_block(read(function), [10.0, 100.0]) == [116.0, 0.0]


def nested(x: ca.SX) -> ca.SX:
    """Sum over k = 1, 2, 3 of k times the polynomial k + 2 z + z² at z = x + k."""
    row, total, held = ca.SX.sym("row"), ca.SX.sym("total"), ca.SX.sym("held")
    inner_row, inner = ca.SX.sym("inner_row", 2), ca.SX.sym("inner")
    both = ca.SX.sym("both", 2)
    turn = ca.Function(
        "turn", [inner_row, inner, both], [inner * both[0] + inner_row[0] + inner_row[1] * both[1]]
    )
    value = counted_loop(
        "inside",
        3,
        turn,
        carried=ca.SX(0),
        tables=[[1, 2, 0], [0, 0, 1]],
        invariants=ca.vertcat(held + row, row),
    )
    body = ca.Function("outer", [row, total, held], [total + row * value])
    return counted_loop("outside", 3, body, carried=ca.SX(0), tables=[[1, 2, 3]], invariants=x)


def nested_closed_form(x: float) -> float:
    return sum(k * (k + 2 * (x + k) + (x + k) ** 2) for k in (1, 2, 3))


@pytest.mark.parametrize("value", [0.0, 4.0, -7.0])
def test_a_loop_inside_a_loop_stays_a_loop_inside_a_loop(value):
    x = ca.SX.sym("x")
    block = read(ca.Function("f", [x], [nested(x)]))
    (outer,) = loops(block)
    (inner,) = loops(outer.body)
    assert (outer.count, inner.count, inner.name) == (3, 3, "inside")
    assert evaluate_block(block, [value]) == [nested_closed_form(value)]


@pytest.mark.parametrize("scenarios", [1, 21])
def test_kernels_run_loops_in_the_time_loop_and_before_it(scenarios):
    """One loop reads only a parameter, one only an input, one both and the state."""
    law = step_law(
        "loops",
        inputs=[Signal("u")],
        parameters=[Signal("p")],
        state=[Signal("x", initial=1.0)],
        outputs=[Signal("of_p"), Signal("of_u"), Signal("mixed")],
        equations=lambda s: Equations(
            {"x": s["x"] + 1},
            {
                "of_p": nested(s["p"]),
                "of_u": nested(s["u"]),
                "mixed": polynomial(s["p"], [1, 2, 3]) + polynomial(s["u"] + s["x"], [2, 0, 1]),
            },
        ),
    )
    samples = 6
    u = np.array([0.0, 1.0, -2.0, 5.0, 3.0, -4.0])
    p = np.arange(scenarios) - 4.0
    program = program_of(law)
    run = Kernel(program).run(samples, inputs={"u": u}, parameters={"p": p})
    for scenario in range(scenarios):
        for k in range(samples):
            a, z = p[scenario], u[k] + 1.0 + k
            expected = [
                nested_closed_form(a),
                nested_closed_form(u[k]),
                a * a + 2 * a + 3 + 2 * z * z + 1,
            ]
            got = run.record_of(scenario)[k]
            assert got.tolist() == expected
            interpreted = evaluate_block(program.block, [1.0 + k, u[k], a])[1:]
            assert bits(interpreted) == bits(expected)


def test_a_loop_has_derivatives():
    """d/dx (1 + 2x + 3x²) = 2 + 6x."""
    x = ca.SX.sym("x")
    slope = ca.Function("slope", [x], [ca.jacobian(polynomial(x, [3, 2, 1]), x)])
    assert float(slope(2.0)) == 14.0


def test_only_counted_loops_are_recovered():
    x = ca.SX.sym("x")
    other = ca.Function("other", [x], [2 * x], {"never_inline": True})
    assert recover_loop(other) is None
    assert recover_loop(ca.Function("counted", [x], [other(x) + 1])) is None


def test_a_recovered_loop_is_what_was_written():
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [polynomial(x, [3, 2, 1])])
    nodes = function.instructions_sx()
    calls = [
        nodes[k].which_function()
        for k in range(function.n_instructions())
        if function.instruction_id(k) == ca.OP_CALL
    ]
    (loop,) = [recover_loop(called) for called in calls]
    assert loop is not None
    assert (loop.name, loop.count, loop.tables) == ("polynomial", 3, [[3.0, 2.0, 1.0]])
    assert float(loop.body(5.0, 2.0, 10.0)) == 2.0 * 10.0 + 5.0


@pytest.mark.parametrize("count", [0, -1])
def test_a_count_below_one_is_refused(count):
    with pytest.raises(ValueError, match=r"polynomial|count"):
        counted_loop("polynomial", count, horner(), carried=ca.SX(0), tables=[[]])


@pytest.mark.parametrize("table", [[1.0, 2.0], [1.0, 2.0, 3.0, 4.0]])
def test_a_table_of_another_length_is_refused(table):
    with pytest.raises(ValueError, match=r"polynomial.*3"):
        counted_loop(
            "polynomial", 3, horner(), carried=ca.SX(0), tables=[table], invariants=ca.SX(1)
        )


def test_an_adjustable_loop_has_no_tables_and_stands_at_the_top_only():
    turn = Block(2, (), (1,))
    with pytest.raises(ValueError, match="sum: the length of rings and tables fixes its turns"):
        BlockBuilder(1).loop("sum", turn, 2, [[1.0, 2.0]], [0], [], adjustable=True)
    builder, outer = BlockBuilder(1), BlockBuilder(1)
    inner = builder.finish(
        builder.loop("keep", Block(1, (), (0,)), 2, (), [0], [], adjustable=True)
    )
    with pytest.raises(ValueError, match="outer: the loop keep is adjustable"):
        outer.loop("outer", inner, 3, (), [0], [])


def test_an_adjustable_loop_makes_the_turns_of_the_run():
    doubled = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    builder = BlockBuilder(1)
    block = builder.finish(builder.loop("doubled", doubled, 3, (), [0], [], adjustable=True))
    kernel = Kernel(Program("doubled", (Signal("x", initial=1.0),), (), (), (), block))
    assert [kernel.run(1, turns=n).state("x")[0] for n in (None, 1, 5)] == [8.0, 2.0, 32.0]
    assert kernel.run(2, turns=2, state={"x": np.arange(20.0)}).state("x")[7] == 16 * 7.0
    with refused(place="run of doubled, turns", value=0):
        kernel.run(1, turns=0)
