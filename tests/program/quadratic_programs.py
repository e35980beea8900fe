"""Random quadratic programs (H, f, A, b) of many kinds, each of which has a solution."""

from collections.abc import Callable

import casadi as ca
import numpy as np
from scipy.optimize import nnls

from benchmarks.programs.problems import Problem, random_problem


def far(random, n, m) -> Problem:
    """The unconstrained optimum is hundreds of times as far away as the bounds."""
    hessian, _, rows, bounds = random_problem(random, n, m)
    return hessian, -hessian @ (random.uniform(100, 1000) * random.normal(size=n)), rows, bounds


def soft(random, n, m) -> Problem:
    """The last unknown is a slack of half of the rows, which contradict the other half."""
    hessian, linear, rows, _ = random_problem(random, n, m)
    inside, half = random.normal(size=n), m // 2
    hessian[-1, :] = hessian[:, -1] = 0
    hessian[-1, -1], linear[-1] = 10.0 ** random.uniform(-3, 3), 10.0 ** random.uniform(0, 3)
    rows[:, -1] = np.where(np.arange(m) < half, -1, 0)
    rows[0, :-1], inside[-1] = 0, 2.0
    gaps = random.uniform(size=m) * (random.uniform(size=m) > 0.1)
    return hessian, linear, rows, np.where(np.arange(m) == 0, 0.0, rows @ inside + gaps)


def doubled(random, n, m) -> Problem:
    """Half of the rows are the others once more, in another unit."""
    hessian, linear, rows, bounds = random_problem(random, n, m)
    half, unit = m // 2, random.choice([1.0, 1e-3, 7.0], size=m // 2)
    rows[half : 2 * half], bounds[half : 2 * half] = (
        rows[:half] * unit[:, None],
        bounds[:half] * unit,
    )
    return hessian, linear, rows, bounds


def with_zeros(random, n, m) -> Problem:
    """Some rows are zero, with a bound of zero or more."""
    hessian, linear, rows, bounds = random_problem(random, n, m)
    empty = random.choice(m, size=max(1, m // 4), replace=False)
    rows[empty], bounds[empty] = 0, random.choice([0.0, 1.0], size=empty.size)
    return hessian, linear, rows, bounds


def thin(random, n, m) -> Problem:
    """Half of the rows bound the other half from below, as closely as a millionth."""
    hessian, linear, rows, _ = random_problem(random, n, m)
    half, width = m // 2, 10.0 ** random.uniform(-6, -1)
    rows[half : 2 * half] = -rows[:half]
    inside = random.normal(size=n)
    return hessian, linear, rows, rows @ inside + width * random.uniform(0.5, 1, size=m)


def loose(random, n, m) -> Problem:
    """A third of the bounds are out of reach, as a limit is that nobody has set."""
    hessian, linear, rows, bounds = random_problem(random, n, m)
    away = random.uniform(size=m) < 1 / 3
    return hessian, linear, rows, np.where(away, random.choice([1e4, 1e9, np.inf], size=m), bounds)


KINDS: tuple[Callable[..., Problem], ...] = (
    random_problem, far, soft, doubled, with_zeros, thin, loose,
)  # fmt: skip


def by_active_sets(problems):
    """Return the solutions by DAQP, which comes with CasADi."""
    n, m = problems[0][1].size, problems[0][3].size
    structure = {"h": ca.Sparsity.dense(n, n), "a": ca.Sparsity.dense(m, n)}
    tolerances = ({"primal_tol": 1e-11, "dual_tol": 1e-12}, {})
    solvers = [
        ca.conic("solver", "daqp", structure, {"daqp": each, "error_on_fail": False})
        for each in tolerances
    ]
    found = []
    for hessian, linear, rows, bounds in problems:
        for solver in solvers:
            x = solver(h=hessian, g=linear, a=rows, uba=bounds, lba=-np.inf)["x"]
            if solver.stats()["success"]:
                break
        found.append(np.array(x).ravel())
    return np.array(found)


def polished(problem, x):
    """Return a solution with the equations of the rows that hold it solved anew.

    A method of active sets knows these rows better than the point, where its tolerance for a row
    is a millionth of the point or the pulls of rows nearly take each other away.
    """
    hessian, linear, rows, bounds = problem
    _, pulls = _pulls(problem, x)
    held = np.flatnonzero(pulls)
    equations = np.block([[hessian, rows[held].T], [rows[held], np.zeros((held.size, held.size))]])
    found = np.linalg.lstsq(equations, np.append(-linear, bounds[held]))[0][: x.size]
    return min(x, found, key=lambda point: off_the_optimum(problem, point))


def off_the_optimum(problem, x):
    """Return by how much a point fails the conditions of an optimum.

    The larger of: by how much it crosses a row, as a share of the point; and what no pull of the
    rows that it touches takes away of the slope, as a share of that slope's terms.
    """
    hessian, linear, _, _ = problem
    crossed, pulls = _pulls(problem, x)
    terms = np.abs(linear).max() + np.abs(hessian @ x).max()
    left = hessian @ x + linear + problem[2].T @ pulls
    return max(crossed / np.abs(x).max(), np.linalg.norm(left) / terms)


def _pulls(problem, x):
    """By how much the worst row is crossed, and the pulls [m] of rows that take away the slope."""
    hessian, linear, rows, bounds = problem
    kept = np.flatnonzero(rows.any(axis=1))
    length = np.linalg.norm(rows[kept], axis=1)
    crossed = (rows[kept] @ x - bounds[kept]) / length
    touched = crossed > -1e-6 * np.abs(x).max()
    pulls = np.zeros(len(rows))
    if touched.any():
        found, _ = nnls((rows[kept][touched].T / length[touched]), -hessian @ x - linear)
        pulls[kept[touched]] = found / length[touched]
    return crossed.max(), pulls
