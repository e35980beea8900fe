"""The bounds against every value that random programs of whole numbers really take."""

import math
from itertools import product

import numpy as np
import pytest

from clepsydra import Signal
from clepsydra.deploy.printing.whole_numbers import WholeRange, whole_ranges
from clepsydra.program.operation import Operation
from clepsydra.program.program import Block, Program

COMPUTE = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "maximum": lambda a, b: a if a > b else b,
    "minimum": lambda a, b: a if a < b else b,
    "negate": lambda a, b: -a,
    "absolute": lambda a, b: abs(a),
    "floor": lambda a, b: float(np.floor(a)),
    "ceiling": lambda a, b: float(np.ceil(a)),
}
INTEGERS = [-(2.0**31), -5.0, -1.0, 0.0, 1.0, 3.0, 2.0**31 - 1.0]
REALS = [-math.inf, -0.5, 0.0, 2.5, math.inf, math.nan]
#: Of each precision: its type, a large constant, and what is whole or real beside the usual.
PRECISIONS = {
    "double": (np.float64, 7.0, [], [-1e300, 1e300]),
    "single": (
        np.float32, 2.0**24 - 1.0, [-(2.0**24) - 1, 2.0**24, 2.0**24 + 3],
        [-3e38, 2.0**24 + 2, 3e38],
    ),
}  # fmt: skip


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("seed", range(30))
def test_no_value_leaves_its_bounds(seed, precision):
    kind, large, integers, reals = PRECISIONS[precision]
    random = np.random.default_rng(seed)
    operations = [
        Operation(3, "constant", (), -2.0),
        Operation(4, "constant", (), large),
        Operation(5, "constant", (), 0.5),
    ]
    for target in range(6, 30):
        code = list(COMPUTE)[random.integers(len(COMPUTE))]
        operands = tuple(int(v) for v in random.integers(target, size=2))
        one = code in ("negate", "absolute", "floor", "ceiling")
        operations.append(Operation(target, code, operands[:1] if one else operands))
    inputs = (Signal("i", kind="integer"), Signal("b", kind="boolean"), Signal("r"))
    program = Program("p", (), inputs, (), (), Block(3, tuple(operations), ()))
    ranges = whole_ranges(program, precision)
    assert 5 not in ranges and 2 not in ranges
    with np.errstate(all="ignore"):
        for given in product([*INTEGERS, *integers], (0.0, 1.0), [*REALS, *reals]):
            values = [kind(value) for value in given]
            for operation in operations:
                a, b = (*(values[v] for v in operation.arguments), kind(0.0), kind(0.0))[:2]
                compute = COMPUTE.get(operation.code)
                made = operation.constant if compute is None else compute(a, b)
                values.append(kind(made))
            for place, bound in ranges.items():
                check(float(values[place]), bound)


def check(value: float, bound: WholeRange) -> None:
    if math.isnan(value):
        assert bound.maybe_nan
    else:
        assert bound.low <= value <= bound.high
        assert math.isinf(value) or value == math.floor(value)


def test_a_limited_rounded_real_is_whole_and_within_bounds():
    def bounds(*operations: Operation) -> WholeRange | None:
        block = Block(1, operations, ())
        program = Program("p", (), (Signal("r"),), (), (), block)
        return whole_ranges(program).get(operations[-1].target)

    low, high = Operation(1, "constant", (), -3.0), Operation(2, "constant", (), 9.0)
    rounded = Operation(3, "floor", (0,))
    # max(a, b) is b where a is not a number: with the limit second nothing bad gets through.
    inside = Operation(4, "maximum", (3, 1)), Operation(5, "minimum", (4, 2))
    assert bounds(low, high, rounded, *inside) == WholeRange(-3.0, 9.0)
    outside = Operation(4, "maximum", (1, 3)), Operation(5, "minimum", (2, 4))
    found = bounds(low, high, rounded, *outside)
    assert found is not None and found.maybe_nan
    assert bounds(low, high, Operation(3, "add", (0, 1))) is None
