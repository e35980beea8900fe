"""A quotient of what is chosen is the chosen one of two quotients."""

import casadi as ca
import numpy as np
import pytest
from moving_processes import moving

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine import kernel as kernels
from clepsydra.engine.choice_first import choosing_first
from clepsydra.program.operation import Operation
from clepsydra.program.program import ForLoop
from clepsydra.program.step_law import Equations, step_law


def law(equation, parameters=()):
    return step_law(
        "chosen",
        inputs=[Signal(name) for name in "abcd"],
        parameters=[Signal(name, initial=2.0) for name in parameters],
        state=[Signal("x", initial=1.0)],
        outputs=[Signal("y")],
        equations=lambda s: Equations({"x": s["c"]}, {"y": equation(s)}),
    )


def segments(s):
    """A curve of three pieces, each a quotient."""
    last = ca.if_else(s["a"] < 0.3, s["c"] / s["d"], s["d"] / s["x"])
    return ca.if_else(s["a"] < 0.1, s["b"] / s["d"], last)


def roots(s):
    return ca.if_else(s["a"] < s["b"], ca.sqrt(s["c"]), ca.sqrt(s["d"])) + s["x"] / s["d"]


def shared(s):
    """A quotient that is read elsewhere too."""
    quotient = s["b"] / s["d"]
    return ca.if_else(s["a"] < 0.1, quotient, s["c"] / s["d"]) + quotient


def of_parameters(s):
    """Quotients that are computed once."""
    return ca.if_else(s["a"] < 0.1, s["p"] / s["q"], s["q"] / s["p"]) * s["b"]


def mixed(s):
    return ca.if_else(s["a"] < 0.1, s["b"] / s["d"], ca.sqrt(s["c"]))


def slow(program):
    codes = [each.code for each in program.block.operations()]
    return sum(code in ("divide", "square_root") for code in codes)


@pytest.mark.parametrize(
    ("equation", "parameters", "before", "after"),
    [
        (segments, "", 3, 1), (roots, "", 3, 2), (shared, "", 2, 2), (of_parameters, "pq", 2, 2),
        (mixed, "", 2, 2),
    ],
)  # fmt: skip
@pytest.mark.parametrize("fuse", [False, True])
def test_no_bit_changes(equation, parameters, before, after, fuse, monkeypatch):
    program = program_of(law(equation, parameters))
    assert (slow(program), slow(choosing_first(program))) == (before, after)
    random = np.random.default_rng(5)
    values = [0.0, -0.0, 0.1, 0.2, 0.3, 0.5, -2.0, 1e300, 1e-310, np.inf, np.nan]
    inputs = {name: random.choice(values, size=(21, 400)) for name in "abcd"}

    def found():
        ran = Kernel(program, individual=list("abcd"), fuse=fuse).run(400, inputs=inputs)
        return ran.output("y")

    chosen = found()
    monkeypatch.setattr(kernels, "choosing_first", lambda program: program)
    plain = found()
    as_bits = [np.where(np.isnan(each), np.nan, each).view(np.int64) for each in (chosen, plain)]
    np.testing.assert_array_equal(*as_bits)
    assert np.isfinite(plain).mean() > 0.1


def test_a_pump_with_a_curve_divides_once_for_its_pieces():
    _, program = moving("wet-well", 10)

    def quotients(program):
        [turns] = [each for each in program.block.statements if isinstance(each, ForLoop)]
        codes = [each.code for each in turns.body.statements if isinstance(each, Operation)]
        return codes.count("divide")

    # Two pumps in four stages, each with a curve of two pieces.
    assert quotients(program) - quotients(choosing_first(program)) == 8
