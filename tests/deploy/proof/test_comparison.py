"""Differences, bits and decisions of two runs, and the bounds that they are held to."""

import dataclasses
import math

import numpy as np
import pytest
from spoilt_programs import level_control

from clepsydra import Signal
from clepsydra.deploy.proof.comparison import Difference, compare, double_bound, is_exact
from clepsydra.deploy.proof.comparison import verdict as verdict_of
from clepsydra.deploy.proof.coverage import coverage
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

SIGNALS = (
    Signal("level", "m", low=0.0, high=4.0),
    Signal("status", kind="integer", low=0.0, high=7.0),
    Signal("integral", "V"),
)


def table(*rows):
    return np.array(rows, dtype=float)


def test_the_largest_difference_is_a_share_of_the_range():
    expected = table([1.0, 1, 50.0], [2.0, 1, -200.0], [3.0, 1, 0.0])
    found = expected.copy()
    found[1, 0] += 0.02  # 0.005 of 4
    found[2, 2] += 2.0  # 0.01 of the largest magnitude, 200
    difference = compare(SIGNALS, expected, found)
    assert difference == Difference(pytest.approx(0.01), "integral", 2, 2, 0)


def test_decisions_are_counted_apart_from_differences():
    expected = table([1.0, 1, 0.0], [1.0, 2, 0.0], [1.0, 4, 0.0])
    found = expected.copy()
    found[1:, 1] = 5
    difference = compare(SIGNALS, expected, found)
    assert (difference.largest, difference.decisions) == (0.0, 2)


@pytest.mark.parametrize(
    ("first", "second", "largest", "differing"),
    [
        (math.nan, -math.nan, 0.0, 0),
        (math.nan, 1.0, math.inf, 1),
        (1.0, math.nan, math.inf, 1),
        (math.inf, math.inf, 0.0, 0),
        (math.inf, -math.inf, math.inf, 1),
        (0.0, -0.0, 0.0, 1),
        (1.0, math.nextafter(1.0, 2.0), 2.0**-52 / 4.0, 1),
    ],
)
def test_numbers_that_are_none(first, second, largest, differing):
    found = compare(SIGNALS[:1], table([first]), table([second]))
    assert (found.largest, found.differing) == (largest, differing)
    assert found.overflows == (math.isfinite(first) and not math.isfinite(second))


def test_a_table_of_another_shape_is_a_mistake():
    with pytest.raises(ValueError, match="3 signals"):
        compare(SIGNALS, np.zeros((4, 3)), np.zeros((4, 2)))


def test_the_bound_is_zero_where_every_operation_is_exact():
    program = level_control()
    power = Operation(program.block.arguments, "exp", (0,))
    block = Block(program.block.arguments, (power,), (power.target,))
    assert is_exact(program) and double_bound(program) == 0.0
    library = Program("law", (), (*program.state, *program.inputs, *program.parameters), (),
                      (Signal("y"),), block)  # fmt: skip
    assert not is_exact(library) and double_bound(library) == 1e-12


EQUAL = Difference(0.0, "", -1, 0, 0)


@pytest.mark.parametrize(
    ("difference", "bound", "verdict"),
    [
        (EQUAL, 0.0, "equal"),
        (dataclasses.replace(EQUAL, differing=1), 0.0, "differs"),  # the sign of a zero
        (dataclasses.replace(EQUAL, differing=9, largest=1e-13), 1e-12, "within the bound"),
        (dataclasses.replace(EQUAL, differing=9, largest=1e-11), 1e-12, "differs"),
        (dataclasses.replace(EQUAL, differing=9, largest=1e-13, decisions=1), 1e-12, "differs"),
        (dataclasses.replace(EQUAL, differing=9, largest=1.0), None, "reported"),
        (dataclasses.replace(EQUAL, differing=9, largest=4e24), None, "diverges"),
        (dataclasses.replace(EQUAL, differing=9, largest=math.inf), None, "diverges"),
        (dataclasses.replace(EQUAL, differing=9, largest=math.inf, overflows=1), None, "differs"),
    ],
)
def test_verdicts(difference, bound, verdict):
    assert verdict_of(difference, bound) == verdict


def test_coverage_names_the_bits_that_lay_still():
    program = Program(
        "law", (), (), (),
        (Signal("pump_1.status", kind="integer", low=0.0, high=7.0), Signal("good", kind="boolean"),
         Signal("y")),
        Block(0, (), ()),
    )  # fmt: skip
    seen = coverage(program, table([1, 1, 2.0], [3, 1, 2.0], [3, 1, np.nan]))
    assert seen.seen == ("pump_1.status bit 1",)
    assert seen.unseen == ("pump_1.status bit 0", "pump_1.status bit 2", "good")
    assert seen.still == ("y",) and seen.moved == ()
    # A bit of a status word alone does not make a proof.
    assert seen.is_idle and "never moved: y" in seen.sentence


@pytest.mark.parametrize(
    ("outputs", "rows", "idle", "still"),
    [
        (("y", "z"), ([1.0, 2.0], [1.0, 3.0]), False, ("y",)),
        (("y", "z"), ([1.0, 2.0], [1.0, 2.0]), True, ("y", "z")),
        (("y", "z"), ([1.0, 2.0], [math.nan, 2.0]), True, ("y", "z")),
        (("y",), ([1.0], [2.0]), False, ()),
        (("good",), ([1.0], [0.0]), False, ()),
        (("good",), ([1.0], [1.0]), True, ()),
        ((), ([], []), True, ()),
    ],
)
def test_idle_is_what_moves_no_real_output(outputs, rows, idle, still):
    signals = tuple(Signal(name, kind="boolean" if name == "good" else "real") for name in outputs)
    program = Program("law", (), (), (), signals, Block(0, (), ()))
    seen = coverage(program, np.array(rows).reshape(2, len(outputs)))
    assert (seen.is_idle, seen.still) == (idle, still)


def test_a_counter_alone_does_not_make_a_proof():
    counter = Signal("watchdog", kind="integer", low=0.0, high=32767.0)
    program = Program("law", (), (), (), (counter, Signal("y")), Block(0, (), ()))
    assert coverage(program, table([0, 5.0], [1, 5.0], [2, 5.0])).is_idle
