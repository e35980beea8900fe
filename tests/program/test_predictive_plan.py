"""The plan of a predictive controller against another solver."""

import casadi as ca
import numpy as np
import pytest

from clepsydra.program.routines.predictive_plan import (
    SOFTNESS,
    PlanningTables,
    Request,
    bounded_plan,
    linear_plan,
)

#: Blocks, inputs, outputs, what is known, levels with a bound.
BLOCKS, M, Q, C, K = np.array([1, 2, 4]), 2, 2, 5, 2
N = len(BLOCKS) * M


@pytest.fixture(scope="module")
def tables():
    random = np.random.default_rng(3)
    roots = random.normal(size=(Q, 8, N))
    curves = np.einsum("qki,qkj->qij", roots, roots)
    slopes = np.einsum("qki,qkc->qic", roots, random.normal(size=(Q, 8, C)))
    reached, moved = (random.normal(size=(K, len(BLOCKS), size)) for size in (C, N))
    return curves, slopes, reached, moved


@pytest.fixture(scope="module", params=[False, True], ids=["limits", "limits and rates"])
def planned(request, tables):
    """Return a function of numbers that plans, and whether rates are limited."""
    flat = [ca.DM(each.reshape(-1, each.shape[-1])) for each in tables]
    known = PlanningTables(flat[0], flat[1], ca.DM(BLOCKS), flat[2], flat[3], ca.DM([2.0, 3.0]))
    sizes = {"errors": Q, "moves": M, "free": M, "known": C, "up": M, "down": M}
    sizes |= {"rise": M if request.param else 0, "above": K}
    symbols = [ca.SX.sym(name, size) for name, size in sizes.items()]
    asked = Request(*symbols)
    line, plan = linear_plan(known, asked), bounded_plan(known, asked, ca.SX(1))
    found = ca.Function("plan", symbols, [line.moves, line.excess, plan.moves, plan.residual])
    return found, request.param


def numbers(random, rates, free=(1.0, 1.0)):
    return {
        "errors": random.uniform(0.1, 3.0, Q), "moves": random.uniform(0.01, 1.0, M),
        "free": np.array(free), "known": random.normal(size=C), "up": random.uniform(0.05, 1.0, M),
        "down": random.uniform(0.05, 1.0, M),
        "rise": random.uniform(0.05, 0.5, M) if rates else np.zeros(0),
        "above": random.uniform(-0.5, 3.0, K),
    }  # fmt: skip


def program(tables, given):
    """The quadratic program of a plan, written down without the routine: H, f, A, b."""
    curves, slopes, reached, moved = tables
    changes = np.eye(N) - np.eye(N, k=-M)
    H = np.tensordot(given["errors"], curves, 1)
    H = H + changes.T @ np.diag(np.tile(given["moves"], len(BLOCKS))) @ changes
    f = np.tensordot(given["errors"], slopes, 1) @ given["known"]
    H = np.block([[H, np.zeros((N, 1))], [np.zeros((1, N)), SOFTNESS * BLOCKS.sum()]])
    rows = [*np.eye(N), *-np.eye(N)]
    bounds = [*np.tile(given["up"], len(BLOCKS)), *np.tile(given["down"], len(BLOCKS))]
    if len(given["rise"]):
        lengths = np.repeat([1, *BLOCKS[:-1]], M) * np.tile(given["rise"], len(BLOCKS))
        rows, bounds = [*rows, *changes, *-changes], [*bounds, *lengths, *lengths]
    A = np.hstack([rows, np.zeros((len(rows), 1))])
    ends = moved.reshape(-1, N)
    A = np.vstack([A, np.hstack([ends, -np.repeat([[2.0], [3.0]], len(BLOCKS), 0)])])
    above = np.repeat(given["above"], len(BLOCKS))
    b = [*bounds, *(above - reached.reshape(-1, C) @ given["known"])]
    return H, np.append(f, 0.0), A, np.array(b)


def by_daqp(H, f, A, b):
    shapes = {"h": ca.Sparsity.dense(*H.shape), "a": ca.Sparsity.dense(*A.shape)}
    found = ca.conic("daqp", "daqp", shapes)(h=H, g=f, a=A, lba=-1e9, uba=b)
    return found["x"].full().ravel()


def test_the_linear_plan_solves_the_linear_equations(planned, tables):
    found, rates = planned
    given = numbers(np.random.default_rng(5), rates)
    line, excess, *_ = (each.full().ravel() for each in found(*given.values()))
    H, f, A, b = program(tables, given)
    assert line == pytest.approx(np.linalg.solve(H[:N, :N], -f[:N]), rel=1e-9)
    overstepped = A[:, :N] @ line - b
    assert excess.item() == pytest.approx(max(0.0, overstepped.max()), rel=1e-9)


def test_the_bounded_plan_is_that_of_another_solver(planned, tables):
    found, rates = planned
    random = np.random.default_rng(11)
    for _ in range(30):
        given = numbers(random, rates)
        _, _, plan, residual = (each.full().ravel() for each in found(*given.values()))
        expected = by_daqp(*program(tables, given))
        assert residual.item() < 1e-4
        assert plan == pytest.approx(expected[:N], abs=1e-6)


def test_an_input_that_is_not_free_does_not_move(planned):
    found, rates = planned
    given = numbers(np.random.default_rng(13), rates, free=(0.0, 1.0))
    line, _, plan, residual = (each.full().ravel() for each in found(*given.values()))
    assert line[::2] == pytest.approx(0.0, abs=1e-12) and np.all(line[1::2] != 0.0)
    assert residual.item() < 1e-4
    assert np.abs(plan[1::2]).max() > 1e-3
