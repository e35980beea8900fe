"""Structures of transfer functions with dead time: their step and free responses, with slopes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Lags that differ by less than this share are treated as a series around their mean.
_CLOSE = 1e-3
#: Of the two lags in their difference.
_SIGNS = np.array([1.0, -1.0])


class Responses(NamedTuple):
    """Responses of a structure at given lags, and their slopes by the logarithm of each lag."""

    step: np.ndarray  # [N], to a unit step at time zero, for a gain of one
    impulse: np.ndarray  # [N]
    step_slopes: np.ndarray  # [N, lags]
    free: np.ndarray  # [N, f]: its rest, and what is left of earlier motion
    free_slopes: np.ndarray  # [N, f, lags]


class Structure(NamedTuple):
    """A transfer function up to its gain.

    Its responses follow from the times since the end of the dead time, before which they are zero,
    the times since the start of the record, and the lags [s].
    """

    name: str
    title: str
    formula: str
    lags: int
    responses: Callable[[np.ndarray, np.ndarray, np.ndarray], Responses]


def _first_order(since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
    lag = lags[0]
    decay, fading = np.exp(-since / lag), np.exp(-time / lag)
    free_slopes = np.zeros((len(time), 2, 1))
    free_slopes[:, 1, 0] = time / lag * fading
    return Responses(
        step=1.0 - decay,
        impulse=decay / lag,
        step_slopes=(-since / lag * decay)[:, None],
        free=np.stack([np.ones_like(time), fading], axis=1),
        free_slopes=free_slopes,
    )


def _second_order(since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
    """Two real lags; every response is symmetric in them and smooth where they are equal."""
    settled, by_settled, impulse, _ = _divided(since, lags)
    still, by_still, moving, by_moving = _divided(time, lags)
    scale = float(np.mean(lags))
    # d(scale · g)/d ln τ = scale · dg/d ln τ + τ/2 · g
    by_moving = scale * by_moving + moving[:, None] * (0.5 * lags)
    return Responses(
        step=1.0 - settled,
        impulse=impulse,
        step_slopes=-by_settled,
        free=np.stack([np.ones_like(time), still, scale * moving], axis=1),
        free_slopes=np.stack([np.zeros_like(by_still), by_still, by_moving], axis=1),
    )


def _integrating(since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
    return Responses(
        step=since,
        impulse=np.ones_like(since),
        step_slopes=np.zeros((len(since), 0)),
        free=np.stack([np.ones_like(time), time], axis=1),
        free_slopes=np.zeros((len(time), 2, 0)),
    )


FOPDT, SOPDT, IPDT = STRUCTURES = (
    Structure("FOPDT", "first order plus dead time", "K e^(−θ s) / (τ s + 1)", 1, _first_order),
    Structure(
        "SOPDT",
        "second order plus dead time",
        "K e^(−θ s) / ((τ₁ s + 1)(τ₂ s + 1))",
        2,
        _second_order,
    ),
    Structure("IPDT", "integrating plus dead time", "k' e^(−θ s) / s", 0, _integrating),
)


def _divided(time: np.ndarray, lags: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return (f(τ1) − f(τ2))/(τ1 − τ2) and its slopes by ln τ1 and ln τ2 [N, 2].

    First those of f = τ e^(−t/τ), then those of f = e^(−t/τ).
    """
    first, second = lags
    apart = first - second
    if abs(apart) <= _CLOSE * (first + second):
        return _divided_near(time, lags)
    ratios = time[:, None] / lags
    decays = np.exp(-ratios)
    found = []
    for values, slopes in (
        (lags * decays, (1.0 + ratios) * decays),
        (decays, ratios / lags * decays),
    ):
        value = (values[:, 0] - values[:, 1]) / apart
        found += [value, _SIGNS * lags / apart * (slopes - value[:, None])]
    return tuple(found)


def _divided_near(time: np.ndarray, lags: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the same for lags that hardly differ, by a series around their mean."""
    first, second = lags
    mean, half = 0.5 * (first + second), 0.5 * (first - second)
    ratio = time / mean
    decay = np.exp(-ratio)
    found = []
    for one, two, three in (  # derivatives by τ
        (
            (1.0 + ratio) * decay,
            ratio**2 / mean * decay,
            (ratio**3 - 3.0 * ratio**2) / mean**2 * decay,
        ),
        (
            ratio / mean * decay,
            (ratio**2 - 2.0 * ratio) / mean**2 * decay,
            (ratio**3 - 6.0 * ratio**2 + 6.0 * ratio) / mean**3 * decay,
        ),
    ):
        by_lags = lags * (0.5 * two[:, None] + _SIGNS * three[:, None] * half / 6.0)
        found += [one + three * half**2 / 6.0, by_lags]
    return tuple(found)
