"""Sums that a loop of a routine adds up, among elements that other turns read or write."""

import casadi as ca
import numpy as np
import pytest

from clepsydra import Kernel, Signal
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program
from clepsydra.program.routine_writer import computed, routine

GIVEN = np.array([0.7, -1.3, 2.9, 0.3])


def of_others(loop, x, y):
    for j in loop("j", 0, 4):
        y[2] = y[2] + x[j] * x[1]


def with_itself_among_them(loop, x, y):
    for j in loop("j", 0, 4):
        y[2] = y[2] + y[j] * x[1]


def of_those_before(loop, x, y):
    for i in loop("i", 0, 4):
        for j in loop("j", 0, i):
            y[i] = y[i] - y[j] * x[i]


def of_those_behind(loop, x, y):
    for i in loop("i", 0, 4):
        for j in loop("j", i + 1, 4):
            y[i] = y[i] - y[j] * x[i]


def with_itself_at_last(loop, x, y):
    for i in loop("i", 0, 4):
        for j in loop("j", 0, i + 1):
            y[i] = y[i] - y[j] * x[i]


def that_another_step_begins_anew(loop, x, y):
    for j in loop("j", 0, 4):
        y[2] = y[2] + x[1]
        y[j] = x[j]


def of_two_that_read_each_other(loop, x, y):
    for j in loop("j", 0, 4):
        y[0] = y[0] + y[1] * x[j]
        y[1] = y[1] - y[0] * x[2]


def from_both_ends(loop, x, y):
    for i in loop("i", 0, 4):
        for j in loop("j", 0, 4):
            y[i] = y[i] + y[3 - j] * x[i]


def that_none_adds_to(loop, x, y):
    for i in loop("i", 0, 4):
        for j in loop("j", 2, i):
            y[i] = y[i] + x[j]


@pytest.mark.parametrize(
    "sums",
    [
        of_others, with_itself_among_them, of_those_before, of_those_behind, with_itself_at_last,
        that_another_step_begins_anew, of_two_that_read_each_other, from_both_ends,
        that_none_adds_to,
    ],
)  # fmt: skip
def test_a_kernel_adds_in_the_order_that_is_written(sums):
    def algorithm(loop, x, y):
        for i in loop("i", 0, 4):
            y[i] = x[3 - i]
        sums(loop, x, y)

    made = routine("sums", algorithm, arguments={"x": (4,)}, results={"y": (4,)})
    builder = BlockBuilder(4)
    block = builder.finish(list(builder.routine(made, range(4))))
    inputs, outputs = ([Signal(f"{name}_{k}") for k in range(4)] for name in "xy")
    program = Program("sums", (), tuple(inputs), (), tuple(outputs), block)
    expected = [float(ca.evalf(each)) for each in computed(made, algorithm, [ca.DM(GIVEN)])]
    names = [signal.name for signal in inputs]
    for lanes in (1, 3):
        given = {name: np.full((lanes, 1), x) for name, x in zip(names, GIVEN, strict=True)}
        run = Kernel(program, individual=names).run(1, inputs=given)
        found = [run.output(signal.name)[-1, 0] for signal in outputs]
        assert found == expected
