"""The builder's sharing, folding and dropping change no bit; the kernel computes the same."""

import itertools
import math

import numpy as np
import pytest
from block_interpreter import bits, evaluate_block
from random_blocks import SPECIAL, PlainBlock, random_block, stimulus

from clepsydra import Kernel, Signal
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import COMPARISONS, EXACT, LIBRARY, LOGIC
from clepsydra.program.program import Block, ForLoop, Program

ARGUMENTS, RESULTS = 4, 6


def count(block: Block) -> int:
    """Return the number of operations, those of loops' bodies included."""
    return sum(1 for _ in block.operations())


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(80))
def test_folding_changes_no_bit(seed):
    plain, built = random_block(seed, ARGUMENTS, RESULTS)
    assert count(built) < count(plain)
    for row in stimulus(seed, 25, ARGUMENTS):
        assert bits(evaluate_block(built, row)) == bits(evaluate_block(plain, row))


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(16))
def test_kernel_and_interpreter_agree_bit_for_bit(seed):
    """One argument is a state and one a parameter, so that some work leaves the time loop.

    The functions of a library are the engine's own: see tests/engine/test_elementary_functions.
    """
    plain, built = random_block(1000 + seed, ARGUMENTS, RESULTS, library=False)
    samples = 15
    rows = stimulus(seed, samples, ARGUMENTS)
    program = Program(
        f"random_{seed}",
        (Signal("x", initial=rows[0, 0]),),
        (Signal("u1"), Signal("u2")),
        (Signal("p"),),
        tuple(Signal(f"y{i}") for i in range(1, RESULTS)),
        built,
    )
    kernel = Kernel(program, fuse=False)
    inputs = {"u1": rows[:, 1], "u2": rows[:, 2]}
    given = [SPECIAL[seed % len(SPECIAL)], 0.7, -1.3]
    batch = kernel.run(samples, inputs=inputs, parameters={"p": np.array(given)})
    for scenario, p in enumerate(given):
        one = kernel.run(samples, inputs=inputs, parameters={"p": p})
        state = rows[0, 0]
        for k, row in enumerate(rows):
            state, *expected = evaluate_block(plain, [state, *row[1:-1], p])
            assert bits(one.record_of(0)[k]) == bits(expected)
            assert bits(batch.record_of(scenario)[k]) == bits(expected)
        assert bits(one.state("x")) == bits([state])
        assert bits(batch.state("x")[scenario : scenario + 1]) == bits([state])


EXACT_CODES = {
    code: 3 if code == "select" else 2
    for code in ["add", "subtract", "multiply", "divide", "minimum", "maximum", "select"]
} | {
    **dict.fromkeys(["negate", "square_root", "absolute", "floor", "ceiling"], 1),
    **dict.fromkeys(sorted(COMPARISONS | (LOGIC - {"not"})), 2),
    "not": 1,
}


def test_the_table_of_codes_is_complete():
    assert set(EXACT_CODES) | {"number", "truth", "constant"} == EXACT


@pytest.mark.parametrize("code", [*EXACT_CODES, *sorted(LIBRARY)])
def test_every_operation_on_special_constants_folds_to_the_bits_of_the_target(code):
    """All operands constant, and each operand alone constant: results as without folding."""
    arity = EXACT_CODES.get(code) or LIBRARY[code]
    values = [*SPECIAL, 0.3, -2.5]
    known = [[True] * arity, *[[i == j for j in range(arity)] for i in range(arity)]]
    for operands in itertools.product(values if arity < 3 else SPECIAL[:9], repeat=arity):
        if code == "copysign" and math.isnan(operands[1]):
            continue  # the sign of a not-a-number is nobody's
        for constant in known:
            plain, built = PlainBlock(arity), BlockBuilder(arity)
            results = [
                block.finish(
                    [
                        block.operation(
                            code,
                            *[
                                block.constant(value) if fixed else i
                                for i, (value, fixed) in enumerate(
                                    zip(operands, constant, strict=True)
                                )
                            ],
                        )
                    ]
                )
                for block in (plain, built)
            ]
            expected, got = (bits(evaluate_block(block, operands)) for block in results)
            assert got == expected, (code, operands, constant)


def test_operations_on_constants_are_computed_while_building():
    builder = BlockBuilder(1)
    eight = builder.operation("multiply", builder.constant(2.0), builder.constant(4.0))
    block = builder.finish([builder.operation("add", 0, eight)])
    assert [operation.code for operation in block.operations()] == ["constant", "add"]
    assert [o.constant for o in block.operations() if o.code == "constant"] == [8.0]


def test_equal_operations_are_computed_once_and_different_ones_are_not():
    builder = BlockBuilder(2)
    assert builder.operation("subtract", 0, 1) == builder.operation("subtract", 0, 1)
    assert builder.operation("subtract", 0, 1) != builder.operation("subtract", 1, 0)
    assert builder.constant(0.0) != builder.constant(-0.0)
    assert builder.constant(math.nan) == builder.constant(math.nan)


def test_what_nobody_reads_is_dropped_with_all_that_only_it_reads():
    builder = BlockBuilder(2)
    unread = builder.operation("square_root", builder.operation("multiply", 0, 1))
    body = BlockBuilder(2)
    turn = body.finish([body.operation("add", 0, 1)])
    builder.loop("unread", turn, 3, [[1, 2, 3]], [unread], [])
    kept = builder.operation("add", 0, 1)
    block = builder.finish([kept])
    assert [operation.code for operation in block.operations()] == ["add"]
    assert len(block.statements) == 1


def test_a_loop_stays_when_one_of_its_values_is_read():
    body = BlockBuilder(3)
    turn = body.finish([body.operation("add", 1, 0), body.operation("multiply", 2, 0)])
    builder = BlockBuilder(1)
    _, product = builder.loop("both", turn, 4, [[1, 2, 3, 4]], [0, builder.constant(1.0)], [])
    block = builder.finish([product])
    assert [type(statement) for statement in block.statements if isinstance(statement, ForLoop)]
    assert evaluate_block(block, [7.0]) == [24.0]


def test_a_block_whose_results_are_arguments_and_constants_has_no_arithmetic():
    builder = BlockBuilder(2)
    block = builder.finish([1, builder.constant(2.5), 0, 1])
    assert evaluate_block(block, [3.0, 4.0]) == [4.0, 2.5, 3.0, 4.0]
    assert {operation.code for operation in block.operations()} <= {"constant"}


def test_truth_values_become_numbers_at_the_results():
    builder = BlockBuilder(2)
    less = builder.operation("less", 0, 1)
    block = builder.finish([less, builder.operation("add", less, less)])
    assert evaluate_block(block, [1.0, 2.0]) == [1.0, 2.0]
    assert evaluate_block(block, [2.0, 1.0]) == [0.0, 0.0]


def test_a_choice_in_two_halves_is_read_as_one_select():
    """(c ? a : 0) + (c ? 0 : b) is c ? a : b, but for the sign of zero."""
    builder = BlockBuilder(4)
    condition, zero = builder.operation("less", 0, 1), builder.constant(0.0)
    first = builder.operation("select", condition, 2, zero)
    other = builder.operation("select", builder.operation("not", condition), 3, zero)
    block = builder.finish([builder.operation("add", first, other)])
    assert sorted(operation.code for operation in block.operations()) == ["less", "select"]
    for a, b in [(math.nan, 1.0), (5.0, math.inf), (0.1, -0.2)]:
        assert bits(evaluate_block(block, [0.0, 1.0, a, b])) == bits([a])
        assert bits(evaluate_block(block, [1.0, 0.0, a, b])) == bits([b])
        assert bits(evaluate_block(block, [math.nan, 0.0, a, b])) == bits([b])


def test_what_only_looks_like_a_choice_in_two_halves_stays_a_sum():
    """Halves of two different conditions, and halves the wrong way round, are added."""
    nothing = None
    halves = [
        (0, 1, (2, nothing), (nothing, 3)),  # (c ? a : 0) + (d ? 0 : b)
        (0, 0, (2, nothing), (3, nothing)),  # (c ? a : 0) + (c ? b : 0)
        (0, 0, (nothing, 2), (nothing, 3)),  # (c ? 0 : a) + (c ? 0 : b)
        (0, 0, (2, 3), (nothing, 3)),  # (c ? a : b) + (c ? 0 : b)
        (0, 0, (2, nothing), (2, 3)),  # (c ? a : 0) + (c ? a : b)
    ]
    for one, other, left, right in halves:
        blocks = []
        for block in (PlainBlock(4), BlockBuilder(4)):
            zero = block.constant(0.0)
            conditions = [block.operation("less", i, zero) for i in (0, 1)]
            first, second = (
                block.operation(
                    "select", conditions[i], *(zero if v is nothing else v for v in pair)
                )
                for i, pair in ((one, left), (other, right))
            )
            blocks.append(block.finish([block.operation("add", first, second)]))
        for signs in itertools.product([-1.0, 1.0], repeat=2):
            row = [*signs, 0.1, 0.2]
            plain, built = (bits(evaluate_block(block, row)) for block in blocks)
            assert plain == built, (one, other, left, right, signs)


def test_uses_counts_every_reading_and_the_results():
    builder = BlockBuilder(2)
    total = builder.operation("add", 0, 1)
    square = builder.operation("multiply", total, total)
    block = builder.finish([square, square, total])
    uses = block.uses()
    by_code = {operation.code: operation.target for operation in block.operations()}
    assert uses[by_code["add"]] == 3
    assert uses[by_code["multiply"]] == 2
    assert uses[0] == uses[1] == 1
