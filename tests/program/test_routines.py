"""Routines: what is written from an algorithm, and that every reading of it computes the same."""

import pickle

import casadi as ca
import numpy as np
import pytest
from patched_printers import keep_nothing
from solved import solving

from clepsydra import program_of
from clepsydra.engine.kernel import Kernel
from clepsydra.program.routine import Index, RoutineCall, Turns
from clepsydra.program.routine_writer import computed, routine

INDICES = {"i": 3, "k": 5}


def test_an_index_counts_with_whole_numbers():
    i, k = Index(0, (("i", 1),)), Index(0, (("k", 1),))
    for index, expected in (
        (i + 2, 5), (2 + i, 5), (k - i, 2), (7 - k, 2), (4 * i + k - 1, 16), (i - i, 0), (0 * k, 0),
        (3 * (2 * i - k), 3),
    ):  # fmt: skip
        assert index.at(INDICES) == expected
    assert i - i == Index()
    assert 0 * k == Index()


def prefix_sums(loop, x, y):
    """y_i = x_0 + … + x_i."""
    y[0] = x[0]
    for i in loop("i", 1, 4):
        y[i] = y[i - 1] + x[i]


def test_a_loop_is_written_once_and_computed_in_every_turn():
    made = routine("sums", prefix_sums, arguments={"x": (4,)}, results={"y": (4,)})
    _, loop = made.steps
    assert isinstance(loop, Turns)
    assert (loop.first, loop.stop, len(loop.steps)) == (Index(1), Index(4), 1)
    assert made.read() == {"x": {0, 1, 2, 3}, "y": {0, 1, 2}}
    found = computed(made, prefix_sums, [ca.DM([1, 2, 4, 8])])
    assert [float(each) for each in found] == [1, 3, 7, 15]


def square(loop, x, y):
    """Two sums, in every one of 2 × 3 turns."""
    for i in loop("i", 0, 2):
        for _ in loop("k", 0, 3):
            y[i] = y[i] + x[i] + x[0]


def triangle(loop, x, y):
    """A sum for every k below i: none, 1, 2 and 3; then the loops behind it, which are empty."""
    for i in loop("i", 0, 4):
        for k in loop("k", 0, i):
            y[i] = y[i] + x[k]
    for i in loop("i", 2, 4):
        for _ in loop("k", i, 2):
            y[i] = y[i] + x[i]


def tetrahedron(loop, x, y):
    """A sum for every j from k on that is below i, and k any of two: i = 0, 1, 2, 3."""
    for i in loop("i", 0, 4):
        for k in loop("k", 0, 2):
            for j in loop("j", k, i):
                y[i] = y[i] + x[j]


@pytest.mark.parametrize(
    ("algorithm", "extent"),
    [(prefix_sums, 3), (square, 12), (triangle, 6), (tetrahedron, 1 + (2 + 1) + (3 + 2))],
)
def test_the_extent_of_a_routine_is_what_a_call_computes(algorithm, extent):
    made = routine("sums", algorithm, arguments={"x": (4,)}, results={"y": (4,)})
    assert made.extent() == extent == len([*made.computed()])


def test_what_only_feeds_what_nobody_reads_is_left_out():
    def algorithm(loop, x, y, z, idle):
        for i in loop("i", 0, 3):
            idle[i] = x[i]
            z[i] = 2 * x[i]
            y[i] = -x[i]

    arrays = {"arguments": {"x": (3,)}, "results": {"y": (3,), "z": (3,)}, "local": {"idle": (3,)}}
    made = routine("turned", algorithm, **arrays)
    assert {step.written.array for step in made.every_step()} == {"y", "z"}
    assert {step.written.array for step in made.needed(["y"]).every_step()} == {"y"}


def test_mistakes_of_who_writes_an_algorithm_are_refused():
    def stale(loop, x, y):
        before = y[0] = x[0]
        y[1] = x[1]
        y[1] = before + y[0]
        kept = y[1]
        y[0] = x[0]
        y[1] = kept

    def beyond(loop, x, y):
        for i in loop("i", 0, 3):
            y[i] = x[i]

    def unwritten(loop, x, y):
        y[0] = y[1]

    def other(loop, x, y):
        y[0, 0] = x[0]

    def before_a_loop(loop, x, y):
        y[0] = x[0]
        first = y[0]
        for i in loop("i", 0, 2):
            y[i] = first + x[i]

    def after_a_loop(loop, x, y):
        for i in loop("i", 0, 2):
            last = x[i]
        y[0] = last

    def same_index(loop, x, y):
        for i in loop("i", 0, 2):
            for _ in loop("i", 0, 2):
                y[i] = x[i]

    def given(loop, x, y):
        x[0] = 1
        y[0] = x[0]

    shapes = {"arguments": {"x": (2,)}, "results": {"y": (2,)}}
    for algorithm, words in (
        (stale, "y was written since it was read"), (before_a_loop, "y was .* in another loop"),
        (after_a_loop, "x was .* in another loop"), (same_index, "i: a loop around this one"),
        (given, "x is an argument, which is only read"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=words):
            routine("r", algorithm, **shapes)
    with pytest.raises(ValueError, match="2 indices for"):
        routine("r", other, **shapes)
    for algorithm, words in ((beyond, "index 2 outside"), (unwritten, "read before it is written")):
        made = routine("r", algorithm, **shapes)
        with pytest.raises(ValueError, match=words):
            computed(made, algorithm, [ca.SX.sym("x", 2)])


def test_an_array_of_numbers_is_a_table():
    matrix = np.array([[4.0, 2.0], [2.0, 3.0]])
    program = program_of(solving(2, 1, matrix))
    (call,) = (each for each in program.block.statements if isinstance(each, RoutineCall))
    assert call.tables == ((4.0, 2.0, 2.0, 3.0), ())
    run = Kernel(program).run(1, inputs={"b_0_0": [2.0], "b_1_0": [5.0]})
    assert [run.output(name)[0, 0] for name in ("x_0_0", "x_1_0")] == [-0.5, 2.0]


def test_a_law_that_is_pickled_keeps_its_routines():
    law = solving(3, 1)
    assert program_of(pickle.loads(pickle.dumps(law))).block == program_of(law).block


def test_a_routine_longer_than_a_part_is_a_part_of_its_own(monkeypatch):
    program = program_of(solving(4, 2))
    random = np.random.default_rng(8)
    inputs = {each.name: random.normal(size=50) for each in program.inputs}
    inputs |= {f"a_{i}_{i}": random.uniform(4.0, 9.0, 50) for i in range(4)}

    def found():
        return Kernel(program).run(50, inputs=inputs).record_of(0)

    usual = found()
    keep_nothing(monkeypatch)
    monkeypatch.setattr("clepsydra.engine.vector_parts.LARGEST_PART", 5)
    np.testing.assert_array_equal(found(), usual)
    assert np.all(np.isfinite(usual)) and np.any(usual)
