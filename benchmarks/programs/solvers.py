"""What solves lists of quadratic programs of one size, each as its users call it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import casadi as ca
import numpy as np

from benchmarks.programs.problems import Problem
from clepsydra.base.signal import Signal
from clepsydra.engine.kernel import Job, Kernel
from clepsydra.program.reader import program_of
from clepsydra.program.routines.quadratic_program import TURNS, quadratic_program
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

#: Returns the solutions, row by row.
Solve = Callable[[], np.ndarray]


def law(n: int, m: int, turns: int = TURNS) -> StepLaw:
    """Return a law that solves one program a sample, of which nothing is known beforehand."""
    names = [f"given_{k}" for k in range(n * n + n + m * n + m)]

    def equations(s: Symbols) -> Equations:
        given = ca.vertcat(*(s[name] for name in names))
        hessian, linear, rows, bounds = ca.vertsplit(given, [0, *np.cumsum([n * n, n, m * n, m])])
        found = quadratic_program(
            ca.reshape(hessian, n, n), linear, ca.reshape(rows, n, m).T, bounds, turns
        )
        return Equations({}, {f"x_{i}": found.solution[i] for i in range(n)})

    return step_law(
        "program",
        inputs=[Signal(name) for name in names],
        parameters=[],
        state=[],
        outputs=[Signal(f"x_{i}") for i in range(n)],
        equations=equations,
    )


class OfClepsydra:
    """The routine in a kernel: one run whose samples are the programs, or a batch of such runs."""

    def __init__(self, problems: Sequence[Problem], scenarios: int, turns: int = TURNS) -> None:
        n, m = problems[0][1].size, problems[0][3].size
        self.law = law(n, m, turns)
        rows = [np.concatenate([np.ravel(part) for part in problem]) for problem in problems]
        given = np.broadcast_to(np.array(rows).T[:, None, :], (len(rows[0]), scenarios, len(rows)))
        inputs = {signal.name: each for signal, each in zip(self.law.inputs, given, strict=True)}
        kernel = Kernel(program_of(self.law), individual=tuple(inputs))
        self.job: Job = kernel.prepare(len(problems), inputs=inputs)

    def solve(self) -> np.ndarray:
        """Return the solutions of the first run."""
        run = self.job.run()
        return np.column_stack([run.output(signal.name)[0] for signal in self.law.outputs])


def by_daqp(problems: Sequence[Problem], **tolerances: float) -> Solve:
    """Return a solver by DAQP's own package, one call a program."""
    import daqp

    laid = [tuple(np.ascontiguousarray(part) for part in problem) for problem in problems]
    return lambda: np.array([daqp.solve(*problem, **tolerances)[0] for problem in laid])


def daqp_alone(problems: Sequence[Problem]) -> float:
    """Return the median of the seconds that DAQP says it spent, its setup included."""
    import daqp

    told = [daqp.solve(*map(np.ascontiguousarray, problem))[3] for problem in problems]
    return float(np.median([each["setup_time"] + each["solve_time"] for each in told]))


def by_casadi(problems: Sequence[Problem], plugin: str, options: dict[str, Any]) -> Solve:
    """Return a solver by a plugin of CasADi, one call a program."""
    n, m = problems[0][1].size, problems[0][3].size
    structure = {"h": ca.Sparsity.dense(n, n), "a": ca.Sparsity.dense(m, n)}
    solver = ca.conic("solver", plugin, structure, options)
    laid = [tuple(map(ca.DM, problem)) for problem in problems]
    lowest = ca.DM(np.full(m, -np.inf))

    def one(problem: tuple[ca.DM, ...]) -> np.ndarray:
        h, g, a, uba = problem
        return np.asarray(solver(h=h, g=g, a=a, uba=uba, lba=lowest)["x"]).ravel()

    return lambda: np.array([one(problem) for problem in laid])


@contextlib.contextmanager
def without_banners() -> Iterator[None]:
    """Keep what libraries print of themselves, qpOASES a page a call, from standard output."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
