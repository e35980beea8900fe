"""Conditionals and loops with rings as statements: meaning, folding, dropping, refusals."""

import dataclasses
import math
from functools import cache, partial

import numpy as np
import pytest
from block_interpreter import bits, evaluate_block
from random_blocks import random_block, stimulus

from clepsydra import Signal
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.defaults import with_defaults
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Conditional, ForLoop, Program, read_by, written_by


def root_body() -> Block:
    """(x, y; a) → (√x, y + a)."""
    builder = BlockBuilder(3)
    return builder.finish([builder.operation("square_root", 0), builder.operation("add", 1, 2)])


def rooted(condition: str = "less") -> Block:
    """(x, y, a, limit) → where limit < x (√x, y + a), elsewhere (x, y)."""
    builder = BlockBuilder(4)
    above = builder.operation(condition, 3, 0)
    return builder.finish(builder.conditional("root", above, root_body(), [0, 1], [2]))


def kinds(block: Block) -> list[str]:
    return [type(statement).__name__ for statement in block.statements]


def test_the_body_counts_where_the_condition_is_true_and_only_there():
    block = rooted()
    assert evaluate_block(block, [9.0, 1.0, 0.5, 4.0]) == [3.0, 1.5]
    assert evaluate_block(block, [4.0, 1.0, 0.5, 4.0]) == [4.0, 1.0]
    assert evaluate_block(block, [-9.0, -0.0, 0.5, -4.0]) == [-9.0, -0.0]
    assert bits(evaluate_block(block, [-9.0, 1.0, 0.5, -16.0])) == bits([math.nan, 1.5])
    assert bits(evaluate_block(block, [math.nan, 1.0, 0.5, 0.0])) == bits([math.nan, 1.0])


SEEDS = range(5000, 5024)
nested = cache(partial(random_block, arguments=4, results=6, nesting=0.15))


@pytest.mark.sampled
@pytest.mark.parametrize("seed", SEEDS)
def test_folding_around_and_inside_conditionals_changes_no_bit(seed):
    plain, built = nested(seed)
    assert any(isinstance(s, Conditional) for s in walk(plain))
    for row in stimulus(seed, 5, 4):
        assert bits(evaluate_block(built, row)) == bits(evaluate_block(plain, row))


def walk(block: Block):
    for statement in block.statements:
        yield statement
        if not isinstance(statement, Operation):
            yield from walk(statement.body)


@pytest.mark.thorough
def test_the_random_blocks_nest_both_ways():
    found = {
        (type(outer), type(inner))
        for seed in SEEDS
        for outer in walk(nested(seed)[0])
        if not isinstance(outer, Operation)
        for inner in outer.body.statements
    }
    assert found >= {(a, b) for a in (ForLoop, Conditional) for b in (ForLoop, Conditional)}


def test_a_condition_that_is_known_while_building():
    builder = BlockBuilder(3)
    never = builder.operation("less", builder.constant(2.0), builder.constant(1.0))
    assert builder.conditional("never", never, root_body(), [0, 1], [2]) == (0, 1)
    always = builder.operation("less", builder.constant(1.0), builder.constant(2.0))
    block = builder.finish(builder.conditional("always", always, root_body(), [0, 1], [2]))
    assert evaluate_block(block, [9.0, 1.0, 0.5]) == [3.0, 1.5]


def test_a_number_as_condition_is_true_where_it_is_not_zero():
    builder = BlockBuilder(3)
    block = builder.finish(builder.conditional("root", 2, root_body(), [0, 1], [2]))
    assert evaluate_block(block, [9.0, 1.0, 0.0]) == [9.0, 1.0]
    assert evaluate_block(block, [9.0, 1.0, -2.0]) == [3.0, -1.0]


def test_a_truth_value_is_carried_as_a_number():
    builder = BlockBuilder(2)
    less = builder.operation("less", 0, 1)
    invert = BlockBuilder(1)
    body = invert.finish([invert.operation("subtract", invert.constant(1.0), 0)])
    block = builder.finish(builder.conditional("invert", less, body, [less], []))
    assert evaluate_block(block, [1.0, 2.0]) == evaluate_block(block, [2.0, 1.0]) == [0.0]


def test_what_a_conditional_reads_and_writes():
    (statement,) = (s for s in rooted().statements if isinstance(s, Conditional))
    assert read_by(statement) == (statement.condition, 0, 1, 2)
    assert written_by(statement) == statement.targets
    assert rooted().uses()[statement.condition] == 1
    codes = [operation.code for operation in rooted().operations()]
    assert codes == ["less", "square_root", "add"]


def test_a_conditional_goes_with_its_condition_when_nothing_reads_it():
    builder = BlockBuilder(4)
    above = builder.operation("less", 3, 0)
    root, total = builder.conditional("root", above, root_body(), [0, 1], [2])
    assert kinds(builder.finish([0])) == []
    assert kinds(builder.finish([total])) == ["Operation", "Conditional"]
    assert evaluate_block(builder.finish([root]), [16.0, 0.0, 0.0, 4.0]) == [4.0]


def delaying(name: str = "pipe", length: int = 2) -> tuple[BlockBuilder, tuple[int, ...]]:
    """Two turns that put x into a ring and add up what comes out."""
    body, builder = BlockBuilder(3), BlockBuilder(2)
    turn = body.finish([body.operation("add", 0, 1), 2])
    ring = DelayRing(Signal(name, initial=7.0), length)
    return builder, builder.loop("delay", turn, 2, [], [0], [1], rings=[ring])


def test_a_loop_with_rings_stays_when_nothing_reads_its_values():
    builder, _ = delaying()
    assert kinds(builder.finish([1])) == ["ForLoop"]


def test_a_ring_of_a_loop_belongs_to_the_program():
    builder, (total,) = delaying()
    block = builder.finish([total])
    program = Program("p", (Signal("x"),), (Signal("u"),), (), (), block)
    assert [(ring.name, ring.length) for ring in program.rings] == [("pipe", 2)]
    started = with_defaults(program, {"pipe": 3.5, "x": 1.0})
    assert [ring.signal.initial for ring in started.rings] == [3.5]
    assert [ring.signal.initial for ring in program.rings] == [7.0]
    assert dataclasses.replace(started, block=block, state=program.state) == program


@pytest.mark.parametrize("state", [Signal("pipe"), DelayRing(Signal("pipe"), 3)])
def test_a_ring_of_a_loop_has_a_name_of_its_own(state):
    builder, (total,) = delaying()
    with pytest.raises(ValueError, match=r"pipe.*more than one state or ring"):
        Program("p", (state,), (Signal("u"),), (), (), builder.finish([total]))


def test_a_loop_with_rings_stands_at_the_top_only():
    builder, (total,) = delaying()
    inner, outer = builder.finish([total]), BlockBuilder(2)
    with pytest.raises(ValueError, match="outer: the loop delay has rings"):
        outer.loop("outer", inner, 3, [], [0], [1])
    with pytest.raises(ValueError, match="outer: the loop delay has rings"):
        outer.conditional("outer", outer.operation("less", 0, 1), inner, [0], [1])


def test_the_interpreter_gives_what_was_written_so_many_turns_before():
    """The oracle itself, by hand: a ring of three turns, two turns a sample."""
    from collections import deque

    builder, (total,) = delaying(length=3)
    block = builder.finish([total])
    rings = {"pipe": deque([7.0] * 3)}
    found = [evaluate_block(block, [0.0, u], rings)[0] for u in (1.0, 10.0, 100.0)]
    assert found == [14.0, 7.0 + 1.0, 1.0 + 10.0]
    assert np.array_equal(rings["pipe"], [10.0, 100.0, 100.0])
