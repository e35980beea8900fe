"""Routines in a kernel, one lane or many, and in a module of WebAssembly."""

import numpy as np
import pytest
from hosted_runs import assert_same
from solved import by_lists, least, solving
from tools import need

from clepsydra import program_of
from clepsydra.engine.kernel import Kernel


@pytest.mark.parametrize(("size", "sides"), [(1, 1), (2, 3), (5, 2), (10, 1)])
def test_a_kernel_computes_every_lane_as_lists_do(size, sides):
    """In every bit; and as LAPACK solves it, as far as the condition of the matrix lets it."""
    random = np.random.default_rng((size, sides))
    many = 19
    factors = random.normal(size=(many, size, size))
    a = factors @ factors.transpose(0, 2, 1) + np.eye(size)
    b = random.normal(size=(many, size, sides))
    program = program_of(solving(size, sides))
    expected = [by_lists(*each) for each in zip(a, b, strict=True)]
    given = {f"a_{i}_{j}": a[:, i, j, None] for i in range(size) for j in range(size)}
    given |= {f"b_{i}_{j}": b[:, i, j, None] for i in range(size) for j in range(sides)}
    for lanes in (many, 1):
        held = {name: values[:lanes] for name, values in given.items()}
        run = Kernel(program, individual=given).run(1, inputs=held)
        for place in range(lanes):
            x, pivot = expected[place]
            found = [run.output(f"x_{i}_{j}")[place, 0] for i in range(size) for j in range(sides)]
            assert found == x.ravel().tolist()
            assert [run.output(f"pivot_{i}")[place, 0] for i in range(size)] == pivot.tolist()
            exact = np.linalg.solve(a[place], b[place])
            bound = 50 * np.finfo(float).eps * np.linalg.cond(a[place])
            assert np.abs(x - exact).max() <= bound * np.abs(exact).max()


@pytest.mark.parametrize("law", [solving(4, 2), least(3, 6)], ids=["solving", "least"])
def test_a_page_solves_as_the_kernel_does(law):
    need("wasmtime")
    random = np.random.default_rng(5)
    program = program_of(law)
    inputs = {signal.name: random.normal(size=50) for signal in program.inputs}
    assert_same(program, 50, inputs=inputs)
