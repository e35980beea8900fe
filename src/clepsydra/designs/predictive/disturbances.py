"""Integrating disturbances, as many as measurements, so that no offset stays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.kalman import Noise, input_variances, process_noise, with_wandering
from clepsydra.designs.states.estimation import as_load, with_integrators
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.linear.linearise import operating_point_of

#: Beside its disturbances a process is moved by this share of its noise (variance): a filter that
#: takes a load for noise makes up for it at once, and takes long to learn that it stays.
STATE_NOISE = 1e-3
#: Disturbances are told apart where the measurements show them by more than this share.
_APART = 1e-9


class Disturbed(NamedTuple):
    """A process with disturbances as further states, and the noise that moves all of them."""

    observed: ObservedProcess
    noise: Noise


class _Disturbance(NamedTuple):
    """What may disturb: its name, and how it moves the states in a sample, a usual one at a time.

    Parameters
    ----------
    move : ndarray [N]
    size : float
        A usual one, in the unit of the signal.
    """

    signal: Signal
    move: np.ndarray
    size: float


def with_disturbances(observed: ObservedProcess, horizon: float) -> Disturbed:
    """Return the process with as many integrating disturbances as it has measurements.

    x(k+1) = Φ x + Γ u + G d, d(k+1) = d + w. First a load at each input, as a tenth of what it
    can do; then, where there are more measurements, further flows into the states that they show
    best, each as large, in shares of the ranges, as the largest of the loads. In the horizon a
    disturbance wanders as far as that; what else moves the states is small beside it.

    Raises
    ------
    NotApplicable
        The measurements do not tell so many disturbances apart: one of them shows nothing new.

    References
    ----------
    G. Pannocchia and J. B. Rawlings, Disturbance models for offset-free model-predictive
    control, AIChE Journal 49(2), 2003, 426-437, doi 10.1002/aic.690490213.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.observed_process import observed_process
    >>> model = cl.load("three-tanks").linear
    >>> seen = observed_process(model, ["level_3", "level_1", "level_2"])
    >>> names = [signal.name for signal in with_disturbances(seen, 60.0).observed.estimated]
    >>> names[3:]
    ['feed.load', 'tank_3.level.load', 'tank_2.level.load']
    """
    chosen = _chosen(observed)
    moves = np.array([each.move for each in chosen]).T
    whole = with_integrators(observed, [each.signal for each in chosen], moves)
    variances = np.array([each.size for each in chosen]) ** 2
    noise = process_noise(observed, horizon)
    noise = noise._replace(process=STATE_NOISE * noise.process)
    return Disturbed(whole, with_wandering(noise, variances, observed.period, horizon))


def _chosen(observed: ObservedProcess) -> list[_Disturbance]:
    inputs, states = _possible(observed)
    count = len(observed.measurements)
    chosen: list[_Disturbance] = []
    for among in (inputs, states):
        while among and len(chosen) < count:
            best = max(among, key=lambda each: _told_apart(observed, [*chosen, each]))
            if _told_apart(observed, [*chosen, best]) < _APART:
                break
            chosen.append(best)
            among.remove(best)
    if len(chosen) < count:
        raise NotApplicable(
            f"{count} measurements show {len(chosen)} disturbances apart; measure fewer levels"
        )
    return chosen


def _possible(observed: ObservedProcess) -> tuple[list[_Disturbance], list[_Disturbance]]:
    """Return loads at inputs, and flows into states."""
    process = operating_point_of(observed.model).process
    sizes = np.sqrt(input_variances(observed))
    inputs = [
        _Disturbance(as_load(process.signal(name)), move, size)
        for name, move, size in zip(
            observed.model.inputs, observed.moved.T, sizes.tolist(), strict=True
        )
    ]
    shares = [np.max(np.abs(each.move) * each.size / observed.sizes) for each in inputs]
    flow = float(max(shares, default=0.0))
    states = []
    for place, signal in enumerate(observed.estimated):
        if signal.name in observed.model.states:
            move = np.eye(len(observed.held))[place]
            states.append(_Disturbance(as_load(signal), move, flow * observed.sizes[place]))
    return inputs, states


def _told_apart(observed: ObservedProcess, chosen: list[_Disturbance]) -> float:
    """Return by what share the measurements tell disturbances apart that stay."""
    held, shown = observed.held, observed.shown
    moves = np.array([each.move * each.size for each in chosen]).T / observed.sizes[:, None]
    scaled = held * observed.sizes / observed.sizes[:, None]
    seen = np.block(
        [
            [scaled - np.eye(len(held)), moves],
            [shown * observed.sizes, np.zeros((len(shown), len(chosen)))],
        ]
    )
    seen = seen / np.maximum(np.linalg.norm(seen, axis=0), np.finfo(float).tiny)
    values = np.linalg.svd(seen, compute_uv=False)
    return float(values[-1] / values[0])
