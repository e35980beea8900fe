"""Scores of averaging control: a tank that lets its level move, so that its outflow moves less.

They look at the flows while a load acts. Flows are held during a sample.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.scores.trajectory import held_durations, read_trajectories


def largest_rate_of_change(
    time: ArrayLike, outflow: ArrayLike, loads: Sequence[slice] = (slice(None),)
) -> float:
    """Return the largest rate of change of the outflow, max |q_{k+1} - q_k| / (t_{k+1} - t_k).

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    outflow : array_like [n]
        q [m³/s]
    loads : sequence of slice
        The samples of each load; the move into the first of them counts.

    Returns
    -------
    float
        [m³/s²]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    T.-F. Cheung and W. L. Luyben, Liquid-level control in single tanks and cascades of tanks
    with proportional-only and proportional-integral feedback controllers, Industrial &
    Engineering Chemistry Fundamentals 18(1), 1979, pages 15–21.

    Examples
    --------
    >>> largest_rate_of_change([0.0, 2.0, 4.0], [1.0, 1.5, 1.75])
    0.25
    """
    clock, (flow,), complete = read_trajectories(time, outflow)
    if not complete:
        return float("inf")
    rates = np.abs(np.diff(flow)) / np.diff(clock)
    return max(
        float(np.max(rates[_before(load) : _last(load, clock.size)], initial=0.0)) for load in loads
    )


def variance_ratio(
    time: ArrayLike,
    inflow: ArrayLike,
    outflow: ArrayLike,
    loads: Sequence[slice] = (slice(None),),
) -> float | None:
    """Return how much of the variation of the inflow is left in the outflow.

    It is Σ ∫ (q_out - q_out,0)² dt / Σ ∫ (q_in - q_in,0)² dt over the loads, with q_0 the flow
    just before each load: the ratio of the variances about the flow before the load. 0 is perfect
    smoothing; 1 is none, as if the tank were a pipe; above 1 the controller makes it worse. A
    step that stays is passed on sooner or later by every controller that brings the level
    back; the ratio then says how soon.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    inflow, outflow : array_like [n]
        [m³/s]
    loads : sequence of slice
        The samples of each load.

    Returns
    -------
    float or None
        [1]; infinite where a value is not finite; None where no load changes the inflow.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    The definition is ours, after K. A. McDonald, T. J. McAvoy and A. Tits, Optimal averaging level
    control, AIChE Journal 32(1), 1986, pages 75–86, who filter the flow alike.

    Examples
    --------
    The outflow takes half of a step at once, and the rest after one of two seconds:

    >>> variance_ratio([0.0, 1.0, 2.0], [0.0, 2.0, 2.0], [0.0, 1.0, 2.0], [slice(1, 3)])
    0.625
    """
    clock, flows, complete = read_trajectories(time, inflow, outflow)
    if not complete:
        return float("inf")
    duration = held_durations(clock)
    arriving, leaving = (
        sum(
            float(np.sum(duration[load] * (flow[load] - flow[_before(load)]) ** 2))
            for load in loads
        )
        for flow in flows
    )
    return leaving / arriving if arriving > 0.0 else None


def volume_used(
    time: ArrayLike, filling: ArrayLike, loads: Sequence[slice] = (slice(None),)
) -> float:
    """Return the share of the tank between its lowest and highest level while loads act.

    A small one means that the tank could smooth more than its controller lets it.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    filling : array_like [n]
        Volume over capacity [1].
    loads : sequence of slice
        The samples of each load.

    Returns
    -------
    float
        [% of the capacity]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    Examples
    --------
    >>> volume_used([0.0, 1.0, 2.0], [0.5, 0.75, 0.25])
    50.0
    """
    _, (share,), complete = read_trajectories(time, filling)
    if not complete:
        return float("inf")
    acting = np.concatenate([share[load] for load in loads])
    return 100.0 * float(np.max(acting) - np.min(acting))


def _before(load: slice) -> int:
    """Return the sample before a load; the first of the run where there is none."""
    return max((load.start or 0) - 1, 0)


def _last(load: slice, samples: int) -> int:
    """Return the last sample of a load."""
    return (samples if load.stop is None else load.stop) - 1
