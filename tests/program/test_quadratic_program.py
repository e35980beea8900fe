"""A quadratic program by interior points, beside what is known and beside an active-set method."""

import numpy as np
import pytest
from quadratic_programs import (
    KINDS,
    by_active_sets,
    off_the_optimum,
    polished,
    random_problem,
    soft,
)
from solved import least

from clepsydra import Kernel, program_of


def solved(problems):
    """Return solutions [k, n] and residuals [k] of problems (H, f, A, b) of one size."""
    law = least(problems[0][1].size, problems[0][3].size)
    parts = [np.concatenate([np.ravel(each) for each in problem]) for problem in problems]
    names = [signal.name for signal in law.inputs]
    given = dict(zip(names, np.array(parts).T[:, :, None], strict=True))
    run = Kernel(program_of(law), individual=names).run(1, inputs=given)
    values = np.column_stack([run.output(signal.name)[:, 0] for signal in law.outputs])
    return values[:, :-1], values[:, -1]


def test_the_nearest_point_of_a_box_is_each_number_within_its_limits():
    random = np.random.default_rng(1)
    rows = np.vstack([np.eye(4), -np.eye(4)])
    wanted = random.normal(scale=2.0, size=(40, 4))
    limits = random.uniform(0.1, 1.0, size=(40, 8))
    found, residual = solved(
        [(np.eye(4), -w, rows, b) for w, b in zip(wanted, limits, strict=True)]
    )
    assert found == pytest.approx(np.clip(wanted, -limits[:, 4:], limits[:, :4]), abs=1e-9)
    assert residual.max() < 1e-9


def test_where_no_row_is_in_the_way_it_is_the_unconstrained_optimum():
    random = np.random.default_rng(2)
    problems = [random_problem(random, 3, 5) for _ in range(20)]
    problems = [(h, f, a, a @ -np.linalg.solve(h, f) + 10.0) for h, f, a, _ in problems]
    found, _ = solved(problems)
    exact = np.array([-np.linalg.solve(h, f) for h, f, _, _ in problems])
    assert np.abs(found - exact).max() <= 1e-9 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("n", "m", "many"),
    [
        (2, 4, 200),
        (5, 20, 200),
        *(
            pytest.param(n, m, 2002, marks=pytest.mark.thorough)
            for n, m in ((2, 5), (3, 12), (4, 20), (7, 30), (10, 40))
        ),
    ],
)
def test_random_programs_are_solved_as_by_active_sets(n, m, many):
    """As DAQP does, whose solutions keep the conditions of an optimum, and ours more closely."""
    random = np.random.default_rng((n, m))
    problems = [KINDS[k % len(KINDS)](random, n, m) for k in range(many)]
    found, residual = solved(problems)
    exact = by_active_sets(problems)
    theirs, ours = (
        np.array([off_the_optimum(*each) for each in zip(problems, solutions, strict=True)])
        for solutions in (exact, found)
    )
    assert theirs.max() < 1e-6
    assert ours.max() < 1e-6
    assert np.median(ours) < np.median(theirs)
    exact = np.array([polished(*each) for each in zip(problems, exact, strict=True)])
    assert (np.abs(found - exact).max(axis=1) <= 1e-6 * np.abs(exact).max(axis=1)).all()
    assert residual.max() < 1e-4


def test_units_do_not_matter():
    """Powers of two, so that only the start and the floors could see them."""
    random = np.random.default_rng(3)
    plain = [random_problem(random, 4, 12) for _ in range(20)]
    found, _ = solved(plain)
    for unknown, row, cost in (
        (2.0**10, 1.0, 1.0),
        (1.0, 2.0**-600, 1.0),
        (2.0**-9, 2.0**60, 2.0**8),
    ):
        scaled = [
            (cost * h * unknown**2, cost * f * unknown, row * a * unknown, row * b)
            for h, f, a, b in plain
        ]
        again, _ = solved(scaled)
        assert again * unknown == pytest.approx(found, rel=1e-7, abs=1e-7)


def test_limits_that_leave_a_single_value_give_it():
    """An operator may set the lowest and the highest value to the same."""
    hessian, linear = np.array([[1.0, 0.5], [0.5, 1.0]]), np.array([-3.0, 1.0])
    rows = np.vstack([np.eye(2), -np.eye(2)])
    found, residual = solved(
        [(hessian, linear, rows, np.array(b)) for b in ([0.5, 2, -0.5, 2], [0, 0, 0, 0])]
    )
    assert found == pytest.approx(np.array([[0.5, -1.25], [0.0, 0.0]]), abs=1e-9)
    assert residual.max() < 1e-5


def test_rows_that_exclude_each_other_are_told():
    random = np.random.default_rng(4)
    problems = [random_problem(random, 4, 12) for _ in range(100)]
    for _, _, rows, bounds in problems:
        rows[-1], bounds[-1] = -rows[0], -bounds[0] - 10.0 ** random.uniform(-2, 1)
    for _, _, rows, bounds in problems[::4]:
        rows[-1], bounds[-1] = 0, -1
    found, residual = solved(problems)
    assert not (residual < 1e-3).any()
    assert np.isfinite(found).all()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_none_is_told(wrong):
    random = np.random.default_rng(5)
    problems, free = [], []
    for part in range(4):
        for _ in range(20):
            problem = [np.array(each) for each in soft(random, 3, 6)]
            problem[part].flat[random.integers(problem[part].size)] = wrong
            problems.append(tuple(problem))
            free.append(part == 3 and wrong == np.inf)
    found, residual = solved(problems)
    assert ((residual < 1e-4) == free).all()
    assert np.isfinite(found[free]).all()


def test_a_slope_beside_which_nothing_is_seen_of_the_rows_is_told():
    random = np.random.default_rng(7)
    problems = [random_problem(random, 4, 12) for _ in range(20)]
    for k, (_, linear, _, _) in enumerate(problems):
        linear[0] = (-1) ** k * 10.0 ** (30 + 10 * k)
    _, residual = solved(problems)
    assert not (residual < 1e-3).any()


def test_a_cost_that_is_not_convex_is_told():
    random = np.random.default_rng(6)
    problems = [random_problem(random, 4, 12) for _ in range(100)]
    for hessian, *_ in problems:
        curves, turned = np.linalg.eigh(hessian)
        curves[random.integers(4)] *= -1
        hessian[:] = turned @ np.diag(curves) @ turned.T
    saddle = np.array([[0.0, 1.0], [1.0, 0.0]])
    problems_of_two = [(h, np.zeros(2), np.eye(2), np.ones(2)) for h in (saddle, -np.eye(2))]
    for each in (problems, problems_of_two):
        _, residual = solved(each)
        assert not (residual < 1e-3).any()
