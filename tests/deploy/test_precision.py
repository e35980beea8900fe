"""Single precision: numbers are rounded, read back, and whole where that was proved."""

import dataclasses
import struct
from fractions import Fraction

import numpy as np
import pytest
from deployed import CompiledC
from hypothesis import given
from hypothesis import strategies as st
from refusals import refused

from clepsydra import InputError, Signal
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.whole_numbers import check_whole_results
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.precision import check_precision, in_precision
from clepsydra.program.program import Block, Conditional, ForLoop, Program


def rounded(value: float) -> float:
    """The nearest single-precision number."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def with_numbers_everywhere(value: float) -> Program:
    inner = Block(1, (Operation(1, "constant", (), value),), (1,))
    turn = Block(4, (Operation(4, "add", (0, 1)),), (4, 2))
    ring = DelayRing(Signal("late", initial=value), 2)
    statements = (
        Operation(3, "constant", (), value),
        ForLoop((4,), 2, turn, ((value, value),), (0,), (0,), "turns", (ring,)),
        Operation(5, "less", (0, 1)),
        Conditional((6,), 5, inner, (0,), (), "choice"),
    )
    u, k, y, x = (Signal(name, initial=value) for name in "ukyx")
    block = Block(3, statements, (6, 4), frozenset({5}))
    return Program("law", (x,), (u,), (k,), (y,), block)


def numbers(program: Program) -> list[float]:
    found = [s.initial for s in (*program.inputs, *program.parameters, *program.outputs)]
    found += [entry.initial for entry in program.state]
    found += [ring.signal.initial for ring in program.rings]
    found += [o.constant for o in program.block.operations() if o.code == "constant"]
    loops = (s for s in program.block.statements if isinstance(s, ForLoop))
    return found + [value for loop in loops for table in loop.tables for value in table]


@pytest.mark.parametrize("value", [0.1, -1e-7, 1 / 3, 1e38, 16777217.0, 1.2e-38, 0.0, -0.0])
def test_every_number_is_rounded_to_the_nearest(value):
    program = with_numbers_everywhere(value)
    assert in_precision(program, "double") is program
    found = numbers(in_precision(program, "single"))
    assert len(found) == len(numbers(program)) == 9
    assert {struct.pack("<d", number) for number in found} == {struct.pack("<d", rounded(value))}


@pytest.mark.parametrize(
    ("value", "instead"),
    [
        (1e300, rounded(3e38)),
        (-1e300, -rounded(3e38)),
        (1e-300, 2.0**-126),
        (-1e-300, -(2.0**-126)),
        (float("inf"), float("inf")),
    ],
)
def test_bounds_and_infinity_have_counterparts(value, instead):
    assert set(numbers(in_precision(with_numbers_everywhere(value), "single"))) == {instead}


def test_a_precision_that_there_is_not():
    for make in (check_precision, lambda precision: print_c(_counter(), precision=precision)):
        with refused(value="half", expected="double or single"):
            make("half")


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_the_decimal_is_the_shortest_that_reads_back(value):
    text = decimal(value, single=True)
    read = Fraction(text)
    if value == 0.0:
        assert text == ("-0.0" if struct.pack("<f", value)[-1] else "0.0")
        return
    # Read at once it is the nearest number; read as a double first, it is too.
    assert rounded(float(text)) == value
    with np.errstate(over="ignore"):
        beside = [float(np.nextafter(np.float32(value), np.float32(s))) for s in (-np.inf, np.inf)]
    for neighbour in filter(np.isfinite, beside):
        assert abs(read - Fraction(value)) <= abs(read - Fraction(neighbour))
    digits = len(text.partition("E")[0].replace(".", "").strip("-0"))
    if 1 < digits < 10:
        assert rounded_or_inf(f"{value:.{digits - 2}e}") != value


def rounded_or_inf(text: str) -> float:
    with np.errstate(over="ignore"):
        return float(np.float32(float(text)))


def test_the_one_number_whose_shortest_decimal_is_rounded_twice():
    """7.038531E-26 is nearest to it, but as a double lies halfway to its neighbour."""
    value = rounded(7.038530691851209e-26)
    assert str(np.float32(value)) == "7.038531e-26"
    assert rounded(7.038531e-26) != value
    assert rounded(float(decimal(value, single=True))) == value


def test_a_compiler_reads_back_the_numbers(tmp_path):
    random = np.random.default_rng(2)
    bits = random.integers(0x00800000, 0x7F800000, size=60, dtype=np.uint32)
    values = [float(v) for v in bits.view(np.float32)]
    values += [-v for v in values[:5]] + [rounded(7.038530691851209e-26), 2.0**-126, rounded(0.1)]
    constants = tuple(Operation(k, "constant", (), value) for k, value in enumerate(values))
    outputs = tuple(Signal(f"y{k}") for k in range(len(values)))
    block = Block(0, constants, tuple(range(len(values))))
    program = Program("numbers", (), (), (), outputs, block)
    assert CompiledC(program, tmp_path, "single")({}) == values


def _counter(*limits: float, step: float = 1.0, initial: float = 0.0) -> Program:
    """count = count + step, limited from above and from below where limits are given."""
    operations = [Operation(1, "constant", (), step), Operation(2, "add", (0, 1))]
    for limit, code in zip(limits, ("minimum", "maximum"), strict=False):
        target = len(operations) + 1
        operations += [
            Operation(target, "constant", (), limit),
            Operation(target + 1, code, (target - 1, target)),
        ]
    count = Signal("count", kind="integer", initial=initial)
    return Program("law", (count,), (), (), (), Block(1, tuple(operations), (len(operations),)))


@pytest.mark.parametrize("limit", [1e9, 2.0**24 + 2, 2.0**30])
def test_a_count_that_single_precision_would_lose_is_refused(limit):
    """At 2^24 a count of single-precision numbers stands still."""
    assert np.float32(2**24) + np.float32(1) == np.float32(2**24)
    check_whole_results(_counter(limit, 0.0))
    with refused(
        place="count", expected="from -16777216 to 16777216 in single", remedy="double precision"
    ):
        check_whole_results(_counter(limit, 0.0), "single")


def test_a_count_that_it_holds_is_printed(tmp_path):
    for program in (_counter(1e7, 0.0), _counter(2.0**24, -(2.0**24))):
        check_whole_results(program, "single")
    program = _counter(3.0, 0.0)
    compiled = CompiledC(program, tmp_path, "single")
    assert [(compiled({}), compiled.state())[1] for _ in range(5)] == [
        [1.0],
        [2.0],
        [3.0],
        [3.0],
        [3.0],
    ]


def test_a_count_without_a_limit_is_refused_though_rounding_would_limit_it():
    for step in (1.0, -1.0):
        with pytest.raises(InputError, match="count: got"):
            check_whole_results(_counter(step=step), "single")


def test_other_integers_are_within_24_bits_too():
    passes = Block(1, (), (0,))
    wide = Signal("n", kind="integer", low=0.0, high=2.0**31 - 1)
    narrow = dataclasses.replace(wide, high=2.0**24)
    for signal in (Signal("n", kind="integer"), wide):
        program = Program("law", (), (signal,), (), (Signal("y"),), passes)
        print_c(program)
        with pytest.raises(InputError, match=r"law, n: got 'an integer from .*declare its range"):
            print_c(program, precision="single")
    print_c(Program("law", (), (narrow,), (), (Signal("y"),), passes), precision="single")
    # Whoever calls it may still give any integer: what is stored must be proved.
    program = Program("law", (), (narrow,), (), (Signal("y", kind="integer"),), passes)
    print_c(program)
    with pytest.raises(InputError, match="law, y: got 'a whole number from -2147483648 to"):
        print_c(program, precision="single")
    for group in ("state", "parameters"):
        late = Signal("n", kind="integer", initial=2.0**24 + 1)
        lists = {"state": (), "parameters": (), group: (late,)}
        results = (0,) if group == "state" else ()
        program = Program("law", lists["state"], (), lists["parameters"], (), Block(1, (), results))
        print_c(program)
        with pytest.raises(InputError, match="initial value of n: got 16777217"):
            print_c(program, precision="single")


def test_an_integer_state_that_is_handed_on_stays_whole():
    """It starts within 24 bits and every branch keeps it there."""
    statements = (
        Operation(2, "constant", (), 2.0),
        Operation(3, "less", (1, 2)),
        Operation(4, "select", (3, 2, 0)),
    )
    block = Block(2, statements, (4,), frozenset({3}))
    duty = Signal("duty", kind="integer", initial=1.0)
    check_whole_results(Program("law", (duty,), (Signal("u"),), (), (), block), "single")
