"""Times and memory of draws: Clepsydra, C++ by hand and JAX, in one process on two cores."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.case import FINAL, Case, Solution, solve
from benchmarks.cplusplus import VECTOR_COUNTS, CPlusPlus, Kind
from benchmarks.draws.memory import peak_of
from benchmarks.draws.problem import Problem, problem
from benchmarks.draws.with_jax import DrawsInJax
from benchmarks.experiments import Disagreement, Size, agree
from benchmarks.measure import Timings, Way, interleave, on_cores
from clepsydra.engine.threads import threads_at_most

CPP = "C++ by hand, the loop alone"
QUIET, NOISY = "Clepsydra, without noise", "Clepsydra, with noise"
PARAMETERS, REST = "Clepsydra, parameters alone", "Clepsydra, equilibria alone"
JAX, JAX_NOISY = "JAX, without noise", "JAX, with noise"
JAX_REST = "JAX, equilibria alone"
CORES = 2
#: Draws whose noise is made beforehand for the plain solution.
_NOISY_DRAWS = 16
_SUMS = [FINAL.index(f"integral_absolute_error_{loop}") for loop in (1, 2)]


@dataclass(frozen=True)
class DrawTimes:
    """What was measured.

    Parameters
    ----------
    timings : Timings
    draws, samples : int
        Of each way.
    difference, resting : float
        Largest between the ways: of what the loops end with, and of the equilibria.
    peak : int
        Resident memory [B] of a process that runs `many` draws.
    many : int
    """

    timings: Timings
    draws: int
    samples: int
    difference: float
    resting: float
    peak: int
    many: int


def measure(size: Size, folder: Path) -> DrawTimes:
    """Check that all ways agree, then time them, in a process of its own.

    The threads of XLA keep the cores on which they were started, which may be fewer by now.

    Raises
    ------
    Disagreement
    """
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_measured, size, folder).result()


def _measured(size: Size, folder: Path) -> DrawTimes:
    with on_cores(CORES), threads_at_most(CORES):
        drawn, program = problem(size.large_scenarios, size.samples), CPlusPlus.build(folder)
        values = drawn.values()
        rest = drawn.equilibria(values)
        if not rest.feasible.all():
            raise Disagreement("a draw has no equilibrium, so the ways are not of the same draws")
        case = drawn.case(values, rest)
        jax = DrawsInJax(case, drawn.deviation)
        vectors = _best(program, case.chosen(slice(size.scenarios)))
        by_hand = partial(program.batch, case, vectors, threads=CORES)
        at_rest = Solution(np.array([*rest.state, *rest.inputs]))
        resting = agree({JAX_REST: Solution(jax.rest())}, at_rest)
        ways: dict[str, Callable[[], object]] = {
            CPP: by_hand,
            QUIET: partial(drawn.run, drawn.quiet),
            NOISY: partial(drawn.run, drawn.noisy),
            PARAMETERS: drawn.values,
            REST: partial(drawn.equilibria, values),
            JAX: jax.quiet,
            JAX_NOISY: jax.noisy,
            JAX_REST: jax.rest,
        }
        guarded = program.batch(case, vectors, threads=CORES, kind=Kind.GUARDED)
        difference = max(
            _quiet_difference(drawn, case, by_hand(), guarded, jax.quiet()),
            _noisy_difference(drawn, case, jax),
        )
        timings = interleave([Way(*each) for each in ways.items()], size.slow_rounds)
    peak = peak_of(size.many_draws, size.samples)
    return DrawTimes(timings, drawn.draws, size.samples, difference, resting, peak, size.many_draws)


def _quiet_difference(
    drawn: Problem, case: Case, bare: Solution, guarded: Solution, jax: Solution
) -> float:
    """Compare without noise: Clepsydra with its own law at low levels, all others without."""
    hundredth = slice(None, None, 100)
    plain = agree({CPP: Solution(bare.final[:, hundredth])}, solve(case.chosen(hundredth)))
    ours = Solution(drawn.sums(drawn.quiet))
    return max(plain, agree({JAX: jax}, bare), agree({QUIET: ours}, Solution(guarded.final[_SUMS])))


def _noisy_difference(drawn: Problem, case: Case, jax: DrawsInJax) -> float:
    """Compare with noise: each way's own, given to the plain solution as numbers."""
    first = slice(_NOISY_DRAWS)
    some = case.chosen(first)
    ours = solve(some, drawn.noise(drawn.numbers[first]))
    theirs = solve(some, jax.noise(some.scenarios, some.samples))
    sums = Solution(drawn.sums(drawn.noisy, drawn.numbers[first]))
    return max(
        agree({NOISY: sums}, Solution(ours.final[_SUMS])),
        agree({JAX_NOISY: Solution(jax.noisy().final[:, first])}, theirs),
    )


def _best(program: CPlusPlus, case: Case) -> int:
    """Return with how many vectors side by side the program is fastest."""
    ways = [
        Way(str(count), partial(program.batch, case, count, threads=CORES))
        for count in VECTOR_COUNTS
    ]
    timings = interleave(ways, 3)
    return min(VECTOR_COUNTS, key=lambda count: timings.of(str(count)).median)
