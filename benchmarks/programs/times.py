"""Times of quadratic programs: Clepsydra, DAQP, CasADi's plugins and do-mpc, in one process."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.experiments import Disagreement
from benchmarks.measure import Spread, Timings, Way, interleave, on_one_core
from benchmarks.programs import with_do_mpc
from benchmarks.programs.problems import Problem, TankControl, random_problems
from benchmarks.programs.solvers import (
    OfClepsydra,
    by_casadi,
    by_daqp,
    daqp_alone,
    without_banners,
)

CLEPSYDRA, BATCH, FEWER = "Clepsydra", "Clepsydra, batch", "Clepsydra, batch, 12 turns"
DAQP, PLUGIN, QPOASES, DO_MPC = "DAQP", "CasADi's DAQP", "CasADi's qpOASES", "do-mpc"
SIZES = ((2, 4), (6, 20), (10, 40), (20, 60))
#: Random programs of a size, and runs of a batch.
MANY, SCENARIOS = 50, 64
#: Starts of the tank's control, and samples from each.
STARTS, SAMPLES = 5, 4
#: Largest difference to DAQP at its closest, as a share of a solution's size: what DAQP's and
#: IPOPT's own tolerances leave.
AGREEMENT = 1e-5


@dataclass(frozen=True)
class ProgramTimes:
    """What was measured of programs of one size.

    Parameters
    ----------
    name : str
    unknowns, rows, programs : int
    timings : Timings
        [s a program]
    differences : dict
        Largest of each way to DAQP with its closest tolerance, as a share of the solution.
    daqp_alone : float
        What DAQP says it spent [s a program].
    """

    name: str
    unknowns: int
    rows: int
    programs: int
    timings: Timings
    differences: dict[str, float]
    daqp_alone: float

    def of(self, way: str) -> Spread:
        """Return the time of a way [µs a program]."""
        return self.timings.of(way).times(1e6)


def measure(rounds: int, told: Callable[[str], None]) -> list[ProgramTimes]:
    """Check that all ways agree, then time them, for each size and for control of the tanks.

    Raises
    ------
    Disagreement
    """
    found = []
    with on_one_core(), without_banners():
        for n, m in SIZES:
            told(f"quadratic programs of {n} unknowns and {m} rows")
            found.append(_measured("random", random_problems(n, m, MANY), {}, rounds))
        told("predictive control of the quadruple tank")
        found.append(_tank(rounds))
    return found


def _tank(rounds: int) -> ProgramTimes:
    """Time control of the tanks along closed loops from several starts."""
    control = TankControl()
    a, b = control.model
    random = np.random.default_rng(1)
    visited: list[tuple[np.ndarray, np.ndarray]] = []
    problems: list[Problem] = []
    for _ in range(STARTS):
        levels, voltages = random.uniform(-3, 3, 4), np.zeros(2)
        for _ in range(SAMPLES):
            visited.append((levels, voltages))
            problems.append(control.problem(levels, voltages))
            voltages = by_daqp(problems[-1:])()[0, :2]
            levels = a @ levels + b @ voltages
    step = with_do_mpc.controller(control)
    steps = {DO_MPC: lambda: np.array([step(*each) for each in visited])}
    return _measured("quadruple tank", problems, steps, rounds)


def _measured(
    name: str,
    problems: Sequence[Problem],
    more: dict[str, Callable[[], np.ndarray]],
    rounds: int,
) -> ProgramTimes:
    """Time every way; those in `more` give the first unknowns."""
    n, m = problems[0][1].size, problems[0][3].size
    ways = {
        CLEPSYDRA: OfClepsydra(problems, 1).solve,
        BATCH: OfClepsydra(problems, SCENARIOS).solve,
        FEWER: OfClepsydra(problems, SCENARIOS, 12).solve,
        DAQP: by_daqp(problems),
        PLUGIN: by_casadi(problems, "daqp", {}),
        QPOASES: by_casadi(problems, "qpoases", {"printLevel": "none"}),
        **more,
    }
    exact = by_daqp(problems, primal_tol=1e-11)()
    differences = {way: _difference(solve(), exact) for way, solve in ways.items()}
    for way, difference in differences.items():
        if way != FEWER and not difference <= AGREEMENT:
            raise Disagreement(f"{name}, {n} unknowns: {way} differs by {difference:.1e}")
    timings = interleave(
        [Way(way, solve) for way, solve in ways.items()], rounds, timed=_of_the_processor
    )
    solved = dict.fromkeys(ways, len(problems)) | {
        way: SCENARIOS * len(problems) for way in (BATCH, FEWER)
    }
    seconds = {
        way: [each / solved[way] for each in timings.seconds[way]] for way in timings.seconds
    }
    return ProgramTimes(
        name, n, m, len(problems), Timings(seconds), differences, daqp_alone(problems)
    )


def _of_the_processor(run: Callable[[], object]) -> float:
    """Return the processor's time of a call, which other work on the machine disturbs less."""
    start = time.process_time()
    run()
    return time.process_time() - start


def _difference(found: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest difference of the first unknowns, as a share of the whole solution."""
    size = np.abs(exact).max(axis=1)
    return float((np.abs(found - exact[:, : found.shape[1]]).max(axis=1) / size).max())
