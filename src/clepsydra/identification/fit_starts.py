"""Where the search for lags and dead time begins: the best places of a coarse grid."""

from __future__ import annotations

import numpy as np

from clepsydra.identification.held_response import HeldResponse
from clepsydra.identification.structures import Structure

#: A longer record is averaged over blocks to about so many samples first.
_SAMPLES = 1000
_LAGS, _DELAYS = 9, 32
#: The second lag as shares of the first.
_SECOND = (0.1, 0.5)
_STARTS = 3


def fit_starts(
    structure: Structure,
    signal: np.ndarray,
    output: np.ndarray,
    period: float,
    low: np.ndarray,
    high: np.ndarray,
) -> list[np.ndarray]:
    """Return starts for a search over ln lags and θ/T, the most promising first.

    The error is computed on a grid of lags and dead times; the starts are the lowest places that
    are lower than their neighbours in dead time.

    Parameters
    ----------
    structure : Structure
    signal, output : ndarray [N]
    period : float
        [s]
    low, high : ndarray [lags + 1]
        Bounds of the search.

    Examples
    --------
    >>> from clepsydra.identification.structures import IPDT
    >>> u = np.repeat([0.0, 1.0, -1.0], 20)
    >>> y = np.cumsum(np.roll(u, 4))
    >>> fit_starts(IPDT, u, y, 1.0, np.array([0.0]), np.array([30.0]))[0]
    array([3.])
    """
    block = max(1, len(signal) // _SAMPLES)
    count = len(signal) // block
    coarse = block * period
    u, y = (each[: count * block].reshape(count, block).mean(axis=1) for each in (signal, output))
    time = coarse * np.arange(count)
    held = HeldResponse(u)
    delays = _delays(high[-1] / block, count)
    # The grid's dead times are whole samples: a late response is the prompt one, shifted.
    before = np.arange(count)[:, None] - delays
    found: list[tuple[float, int, np.ndarray]] = []
    for number, lags in enumerate(_lag_sets(structure, low, high)):
        responses = structure.responses(time, time, lags)
        prompt = held.to(responses.step[:, None])[:, 0]
        free, _ = np.linalg.qr(responses.free)
        forced = np.where(before >= 0, prompt[before], 0.0)
        forced -= free @ (free.T @ forced)
        left = y - free @ (free.T @ y)
        sizes = np.maximum(np.sum(forced**2, axis=0), 1e-300)
        costs = left @ left - (left @ forced) ** 2 / sizes
        bounded = np.concatenate(([np.inf], costs, [np.inf]))
        valleys = np.flatnonzero((costs <= bounded[:-2]) & (costs <= bounded[2:]))
        for at in valleys.tolist():
            start = np.append(np.log(lags), delays[at] * block)
            found.append((float(costs[at]), number, start))
    found.sort(key=lambda each: each[:2])
    starts: list[np.ndarray] = []
    for _, _, start in found:
        near = [abs(start[-1] - other[-1]) <= 0.1 * max(start[-1], 2.0) for other in starts]
        if not any(near):
            starts.append(start)
        if len(starts) == _STARTS:
            break
    return starts


def _lag_sets(structure: Structure, low: np.ndarray, high: np.ndarray) -> list[np.ndarray]:
    if structure.lags == 0:
        return [np.zeros(0)]
    # A lag beyond the record integrates, one below the sampling period answers at once.
    first = np.exp(np.linspace(low[0] + np.log(5.0), high[0] - np.log(5.0), _LAGS))
    if structure.lags == 1:
        return [np.array([lag]) for lag in first]
    return [np.array([lag, share * lag]) for lag in first for share in _SECOND]


def _delays(latest: float, count: int) -> np.ndarray:
    """Return dead times [samples], close where they are short, and evenly spread over the rest."""
    short = np.arange(_DELAYS // 2)
    spread = np.linspace(0.0, latest, min(_DELAYS, count // 2))
    grown = np.geomspace(1.0, max(latest, 1.0), _DELAYS // 2)
    every = np.concatenate([short, spread, grown])
    return np.unique(np.rint(every[every <= latest])).astype(int)
