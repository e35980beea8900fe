"""The integration step: how long it is, and how exact a run with it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache
from typing import Literal, Protocol, TypeVar, get_args

import numpy as np

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.designs.sampled.sampling_period import LONGEST_PERIOD, check_sampling_period
from clepsydra.linear.fast_states import REACH, settled_lags
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.hybrid import Delay
from clepsydra.process.process import Process

#: Largest |λ| h of an RK4 step for the lag of an instrument that has settled long before the next
#: sample; of all else it is `REACH`.
_LAG_REACH = 1.0
#: The most RK4 steps in one sampling period.
MOST_SUBSTEPS = round(LONGEST_PERIOD / REACH)
#: The error that a run may have, as a fraction of a state's range, before its step is halved.
TOLERANCE = 1e-6
LARGEST_REFINEMENT = 64
#: A delay keeps so many numbers of every step that is on its way, and all delays of a run together
#: at most so many bytes.
_KEPT_A_STEP, MOST_ON_ITS_WAY = 5, 256_000_000
#: An estimate is of three runs, of which the last has so many times the steps of the first.
FEWEST_REFINEMENT = 4
#: The compiled kernel with RK4, or CVODES with switches located by SciPy's DOP853.
Solver = Literal["kernel", "reference"]


@lru_cache(maxsize=16)
def substeps_for(model: LinearModel) -> int:
    """Return the number of RK4 steps in a sampling period that the fastest eigenvalue asks for.

    A step is a tenth of the fastest time constant. The lags of actuators and sensors that settle
    twenty times in a sampling period do not ask for so much: what drives them is held, so that
    at the next sample they stand where they settle, which no step length changes, and the
    integral over their way there is exact for any step of RK4, as it keeps linear integrals of
    the motion. They get a step as long as their time constant, well within the method's reach
    of 2.79.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs do not count.

    Raises
    ------
    InputError
        The process is sampled so slowly that more than 10,000 steps would be needed
        (`designs.sampled.sampling_period`), or the model has no operating point.

    Examples
    --------
    The fastest tank has a time constant of 23 s, and the process is sampled each second:

    >>> import clepsydra as cl
    >>> substeps_for(cl.load("quadruple-tank").linear)
    1
    """
    period = check_sampling_period(model)
    settled = settled_lags(model, period)
    others = np.delete(np.delete(model.A, settled, axis=0), settled, axis=1)
    fastest = float(np.max(np.abs(np.linalg.eigvals(others)), initial=0.0))
    lag = float(np.max(np.abs(np.diag(model.A)[settled]), initial=0.0))
    needed = period * max(fastest / REACH, lag / _LAG_REACH)
    multiple = delay_substeps(operating_point_of(model).process)
    return multiple * max(1, math.ceil(needed / multiple - 1e-9))


def delay_substeps(process: Process) -> int:
    """Return the smallest number of steps in a sampling period that every delay is a multiple of.

    A jump that enters a delay then leaves it between two steps, and nothing is interpolated.

    Raises
    ------
    InputError
        There is none up to 10,000, or what is on its way at the steps of a run would take more
        than 256 MB.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> delay_substeps(load_process("quadruple-tank"))
    1
    """
    steps = 1
    for delay in process.motion.delays:
        periods = delay.time / process.sampling_period
        ratio = Fraction(periods).limit_denominator(MOST_SUBSTEPS)
        if ratio == 0 or abs(ratio / Fraction(periods) - 1) > 1e-9:
            raise _no_multiple(process, delay)
        steps = math.lcm(steps, ratio.denominator)
        if steps > MOST_SUBSTEPS:
            raise _no_multiple(process, delay)
    needed = FEWEST_REFINEMENT * steps * _on_its_way(process)
    if needed > MOST_ON_ITS_WAY:
        longest = max(process.motion.delays, key=lambda delay: delay.time)
        raise InputError(
            f"{process.name}, {longest.name}, time", f"{longest.time:g} s",
            f"delays whose content takes at most {MOST_ON_ITS_WAY / 1e6:g} MB; this takes "
            f"{needed / 1e6:,.0f} MB, with {FEWEST_REFINEMENT * steps} steps in each sampling "
            f"period of {process.sampling_period:g} s",
            "shorten the delay, or lengthen the sampling period",
        )  # fmt: skip
    return steps


def _on_its_way(process: Process) -> float:
    """Return what the delays keep with one step in a sampling period [bytes]."""
    periods = sum(delay.time for delay in process.motion.delays) / process.sampling_period
    return 8.0 * _KEPT_A_STEP * periods


def _no_multiple(process: Process, delay: Delay) -> InputError:
    shortest = process.sampling_period / MOST_SUBSTEPS
    return InputError(
        f"{process.name}, {delay.name}, time",
        f"{delay.time:g} s",
        f"a multiple of an integration step of at least {shortest:g} s, which is a whole part of "
        f"the sampling period of {process.sampling_period:g} s",
        "round the delay or change the sampling period",
    )


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
    if process.motion.delays:
        most = min(most, int(MOST_ON_ITS_WAY / _on_its_way(process)))
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


def check_solver(solver: str) -> None:
    """Refuse a solver that there is not.

    Raises
    ------
    InputError
    """
    check_choice("solver", solver, get_args(Solver))
