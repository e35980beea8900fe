"""Step halving: runs with ever smaller steps until three of them agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol, TypeVar

import numpy as np

from clepsydra.loop.step_size import MOST_SUBSTEPS, delay_substeps
from clepsydra.process.process import Process

#: The error that a run may have, as a fraction of a state's range, before its step is halved.
TOLERANCE = 1e-6
LARGEST_REFINEMENT = 64


class Trajectories(Protocol):
    """What a run has at least: trajectories by name."""

    @property
    def values(self) -> Mapping[str, np.ndarray]:
        """Name to trajectory."""


Found = TypeVar("Found", bound=Trajectories)

#: A method of order four divides its error by so much when its step is halved.
_BY_HALVING = 16.0
#: Weight of a misfit that the next power of the step explains.
_IN_ORDER = 0.25


def refined(
    process: Process,
    run: Callable[[int], Found],
    substeps: int,
    tolerance: float,
    largest: int = LARGEST_REFINEMENT,
) -> tuple[Found, float]:
    """Run with a number of steps in a sampling period and double it until the result stands.

    Of three runs with steps h, h/2 and h/4 the differences D₁ = x(h) - x(h/2) and
    D₂ = x(h/2) - x(h/4) are taken at every sample, in shares of the range of each state. Where
    the error goes with h⁴ everywhere, D₁ = 16 D₂, and that of the last run is D₂/15. So

        max |D₂| + w max |D₁ - 16 D₂|

    estimates it to the safe side: w is 1/4 where the misfit max |D₁ - 16 D₂| is below half of
    max |D₁|, and the first term then decides, 15 times the error. Else w is 1: a corner has
    spoilt the order. Where D₁ = 2ᵖ D₂ the error is D₂ / (2ᵖ - 1), and the estimate is 63, 39 and
    15 times that for p = 3, 2 and 1, and not below it down to p = 0.09. Where corners fall into
    the steps of each run as it happens, no power of h fits, and the estimate is D₁ and more.

    Parameters
    ----------
    process : Process
    run : callable
        Steps in a sampling period → run.
    substeps : int
        To begin with.
    tolerance : float
        Estimate, as a fraction of a state's range, that ends the search. It also ends before a
        sampling period would hold more than 10,000 steps.
    largest : int
        And with so many times as many steps, four at least.

    Returns
    -------
    run, estimate
        The run with the smallest step, and the estimate of its error.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.loop.open_loop import simulate
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> profiles = {"pump_1": np.full(60, 3.2)}
    >>> run, error = refined(
    ...     point.process, lambda count: simulate(point, profiles, substeps=count), 1, 1e-6)
    >>> run.substeps, error < 1e-8
    (4, True)
    """
    multiple = delay_substeps(process)
    most = min(largest * substeps, MOST_SUBSTEPS)
    count = min(substeps, max(most // 4 // multiple, 1) * multiple)
    found = run(count)
    fine = _shares(process, found)
    apart: list[np.ndarray] = []
    estimate = np.inf
    while 2 * count <= most and not (len(apart) == 2 and estimate <= tolerance):
        count *= 2
        found = run(count)
        coarse, fine = fine, _shares(process, found)
        apart = [*apart[-1:], coarse - fine]
        # One difference tells no order: it counts as both, the worst that is counted with.
        estimate = _estimate(apart[0], apart[-1])
    return found, estimate


def _shares(process: Process, run: Trajectories) -> np.ndarray:
    """Return every state that has a range as a share of it [states, samples]."""
    finite = [signal for signal in process.state if np.isfinite(signal.span)]
    return np.array([run.values[signal.name] / signal.span for signal in finite])


def _estimate(before: np.ndarray, after: np.ndarray) -> float:
    first, last = np.max(np.abs(before), initial=0.0), np.max(np.abs(after), initial=0.0)
    misfit = np.max(np.abs(before - _BY_HALVING * after), initial=0.0)
    weight = _IN_ORDER if misfit < first / 2.0 else 1.0
    return float(last + weight * misfit)
