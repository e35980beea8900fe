"""What pumping costs: starts, volumes and energy."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.scores.trajectory import held_durations, read_trajectories

_HOUR = 3600.0
#: Of water [kg/m³].
WATER = 1000.0


def starts_per_hour(time: ArrayLike, running: ArrayLike) -> float:
    """Return how often a pump starts, per hour of the run.

    A start is a sample at which it runs after one at which it did not; that it runs at the
    beginning is none.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    running : array_like [n]
        1 where the pump runs, 0 where it stands still.

    Returns
    -------
    float
        [1/h]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    Examples
    --------
    Two starts in half an hour:

    >>> starts_per_hour([0.0, 360.0, 720.0, 1080.0, 1440.0], [1, 0, 1, 0, 1])
    4.0
    """
    clock, (state,), complete = read_trajectories(time, running)
    if not complete:
        return float("inf")
    starts = np.count_nonzero(np.diff((state > 0.5).astype(int)) > 0)
    return float(starts * _HOUR / np.sum(held_durations(clock)))


def volume_pumped(time: ArrayLike, flow: ArrayLike) -> float:
    """Return the volume that a flow delivers, Σ q_k Δt_k.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    flow : array_like [n]
        q at the start of each sample [m³/s]; held during it, as the signal of its pump is.

    Returns
    -------
    float
        [m³]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    Examples
    --------
    >>> volume_pumped([0.0, 10.0, 20.0], [0.5, 0.5, 0.0])
    10.0
    """
    clock, (rate,), complete = read_trajectories(time, flow)
    if not complete:
        return float("inf")
    return float(np.sum(rate * held_durations(clock)))


def volume_spilt(time: ArrayLike, total: ArrayLike) -> float:
    """Return the volume lost over the rim of a tank, from its total.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    total : array_like [n]
        Volume lost until then [m³], integrated with the motion of the process.

    Returns
    -------
    float
        [m³]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    Examples
    --------
    >>> volume_spilt([0.0, 1.0, 2.0], [0.5, 0.5, 0.75])
    0.25
    """
    _, (lost,), complete = read_trajectories(time, total)
    if not complete:
        return float("inf")
    return float(lost[-1] - lost[0])


def energy_to_liquid(
    time: ArrayLike, flow: ArrayLike, head: ArrayLike, gravity: float, density: float = WATER
) -> float:
    """Return the energy that a pump gives to the liquid, ∫ ρ g H q dt.

    It is what reaches the liquid, without the losses of pump, motor and converter: the energy
    drawn from the mains is this over their efficiency.

    Parameters
    ----------
    time : array_like [n]
        Start of each sample [s].
    flow : array_like [n]
        q [m³/s]
    head : array_like [n]
        H, what the pump lifts against [m]; where it is negative the liquid runs by itself.
    gravity : float
        g [m/s²]
    density : float
        ρ [kg/m³]

    Returns
    -------
    float
        [J]; infinite where a value is not finite.

    Raises
    ------
    InputError
        Time does not increase, or lengths differ.

    References
    ----------
    J. F. Gülich, Centrifugal Pumps, 3rd edition, 2014, chapter 2, doi
    10.1007/978-3-642-40114-5.

    Examples
    --------
    A cubic metre lifted by 36 m is 0.1 kWh, but for g:

    >>> round(energy_to_liquid([0.0, 50.0], [0.01, 0.01], [36.0, 36.0], gravity=10.0) / 3.6e6, 9)
    0.1
    """
    clock, (rate, lift), complete = read_trajectories(time, flow, head)
    if not complete:
        return float("inf")
    power = density * gravity * np.maximum(lift, 0.0) * rate
    return float(np.sum(power * held_durations(clock)))
