"""Step halving: runs with ever smaller steps until two of them agree."""

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


def refined(
    process: Process,
    run: Callable[[int], Found],
    substeps: int,
    tolerance: float,
    largest: int = LARGEST_REFINEMENT,
) -> tuple[Found, float]:
    """Run with a number of steps in a sampling period and double it until the result stands.

    Parameters
    ----------
    process : Process
    run : callable
        Steps in a sampling period → run.
    substeps : int
        To begin with.
    tolerance : float
        Largest difference of two runs, as a fraction of a state's range, that ends the search.
        It also ends before a sampling period would hold more than 10,000.
    largest : int
        And with so many times as many steps.

    Returns
    -------
    run, estimate
        The run with the smallest step, and its largest difference to the one before.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.loop.open_loop import simulate
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> profiles = {"pump_1": np.full(60, 3.2)}
    >>> run, error = refined(
    ...     point.process, lambda count: simulate(point, profiles, substeps=count), 1, 1e-6)
    >>> run.substeps, error < 1e-6
    (2, True)
    """
    multiple = delay_substeps(process)
    most = min(largest * substeps, MOST_SUBSTEPS)
    count = min(substeps, max(most // 2 // multiple, 1) * multiple)
    coarse = run(count)
    while True:
        count *= 2
        fine = run(count)
        estimate = largest_difference(process, coarse.values, fine.values)
        if estimate <= tolerance or 2 * count > most:
            return fine, estimate
        coarse = fine


def largest_difference(
    process: Process, one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]
) -> float:
    """Return the largest difference of two runs, as a fraction of each state's range.

    A state without a finite range does not count.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")  # tanks of 20 cm
    >>> still = {signal.name: np.zeros(3) for signal in process.state}
    >>> largest_difference(process, still, still | {"tank_1.level": np.full(3, 0.002)})
    0.01
    """
    return max(
        float(np.max(np.abs(one[signal.name] - other[signal.name])) / signal.span)
        for signal in process.state
        if np.isfinite(signal.span)
    )
