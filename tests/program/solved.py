"""Laws that solve equations and quadratic programs by routines, and the former by lists."""

import casadi as ca
import numpy as np

from clepsydra import Signal
from clepsydra.program.routines.quadratic_program import quadratic_program
from clepsydra.program.routines.symmetric_solution import symmetric_solution
from clepsydra.program.step_law import Equations, step_law


def solving(size: int, sides: int, numbers: np.ndarray | None = None):
    """A law that solves A X = B; what is not known of A (NaN) is an input, as is all of B."""
    numbers = np.full((size, size), np.nan) if numbers is None else numbers
    places = [(i, j) for i in range(size) for j in range(size)]
    matrix = [Signal(f"a_{i}_{j}") for i, j in places if np.isnan(numbers[i, j])]
    right = [Signal(f"b_{i}_{j}") for i in range(size) for j in range(sides)]

    def equations(s):
        a = ca.SX(numbers)
        for i, j in places:
            a[i, j] = s[f"a_{i}_{j}"] if np.isnan(numbers[i, j]) else a[i, j]
        b = ca.vertcat(*(s[each.name] for each in right)).reshape((sides, size)).T
        x, pivots = symmetric_solution(a, b)
        found = {f"x_{i}_{j}": x[i, j] for i in range(size) for j in range(sides)}
        return Equations({}, found | {f"pivot_{i}": pivots[i] for i in range(size)})

    outputs = [Signal(f"x_{i}_{j}") for i in range(size) for j in range(sides)]
    outputs += [Signal(f"pivot_{i}") for i in range(size)]
    return step_law(
        "solving", inputs=[*matrix, *right], parameters=[], state=[], outputs=outputs,
        equations=equations,
    )  # fmt: skip


def by_lists(a, b):
    """A = L D Lᵀ and the solutions, by loops over Python's numbers."""
    n = len(a)
    lower, pivot, x = np.zeros((n, n)), np.zeros(n), np.array(b)
    for k in range(n):
        pivot[k] = a[k, k]
        for j in range(k):
            pivot[k] = pivot[k] - lower[k, j] * lower[k, j] * pivot[j]
        for i in range(k + 1, n):
            lower[i, k] = a[i, k]
            for j in range(k):
                lower[i, k] = lower[i, k] - lower[i, j] * lower[k, j] * pivot[j]
            lower[i, k] = lower[i, k] / pivot[k]
    for i in range(n):
        for j in range(i):
            x[i] = x[i] - lower[i, j] * x[j]
    for i in reversed(range(n)):
        x[i] = x[i] / pivot[i]
        for j in range(i + 1, n):
            x[i] = x[i] - lower[j, i] * x[j]
    return x, pivot


def least(n: int, m: int):
    """A law that finds the least of ½ xᵀ H x + fᵀ x where A x ≤ b: its inputs row by row."""
    names = [f"given_{k}" for k in range(n * n + n + m * n + m)]
    outputs = [*(f"x_{i}" for i in range(n)), "residual"]

    def equations(s):
        ends = np.cumsum([n * n, n, m * n])
        hessian, linear, rows, bounds = np.split(np.array([s[name] for name in names]), ends)
        found = quadratic_program(
            ca.reshape(ca.vertcat(*hessian), n, n),
            ca.vertcat(*linear),
            ca.reshape(ca.vertcat(*rows), n, m).T,
            ca.vertcat(*bounds),
        )
        values = [*ca.vertsplit(found.solution), found.residual]
        return Equations({}, dict(zip(outputs, values, strict=True)))

    return step_law(
        "least",
        inputs=map(Signal, names),
        parameters=[],
        state=[],
        outputs=map(Signal, outputs),
        equations=equations,
    )
