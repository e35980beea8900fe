"""Structures of transfer functions with dead time: their step and free responses, with slopes."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

#: Lags that differ by less than this share are treated as a series around their mean.
_CLOSE = 1e-3
#: Of the two lags in their difference.
_SIGNS = np.array([1.0, -1.0])


class Responses(NamedTuple):
    """Responses of a structure at given lags.

    Parameters
    ----------
    step : ndarray [N]
        To a unit step at time zero, for a gain of one.
    impulse : ndarray [N]
        Its slope in time.
    step_slopes : ndarray [N, lags]
        By the logarithm of each lag.
    free : ndarray [N, f]
        What the output may do by itself: its rest, and what is left of earlier motion.
    free_slopes : ndarray [N, f, lags]
        By the logarithm of each lag.

    Examples
    --------
    >>> FOPDT.responses(np.zeros(2), np.array([0.0, 1.0]), np.array([2.0])).free.shape
    (2, 2)
    """

    step: np.ndarray
    impulse: np.ndarray
    step_slopes: np.ndarray
    free: np.ndarray
    free_slopes: np.ndarray


class Structure(Protocol):
    """A transfer function up to its gain.

    Examples
    --------
    >>> [structure.name for structure in STRUCTURES]
    ['FOPDT', 'SOPDT', 'IPDT']
    """

    name: str
    title: str
    formula: str
    lags: int

    def responses(self, since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
        """Return the step response at times since the end of the dead time, and free responses.

        Parameters
        ----------
        since : ndarray [N]
            [s], all from 0 on; what is before the end of the dead time counts as 0.
        time : ndarray [N]
            Since the start of the record [s].
        lags : ndarray
            [s]
        """


class _FirstOrder:
    name, lags = "FOPDT", 1
    title = "first order plus dead time"
    formula = "K e^(−θ s) / (τ s + 1)"

    def responses(self, since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
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


class _SecondOrder:
    """Two real lags; every response is symmetric in them and smooth where they are equal."""

    name, lags = "SOPDT", 2
    title = "second order plus dead time"
    formula = "K e^(−θ s) / ((τ₁ s + 1)(τ₂ s + 1))"

    def responses(self, since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
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


class _Integrating:
    name, lags = "IPDT", 0
    title = "integrating plus dead time"
    formula = "k' e^(−θ s) / s"

    def responses(self, since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
        return Responses(
            step=since,
            impulse=np.ones_like(since),
            step_slopes=np.zeros((len(since), 0)),
            free=np.stack([np.ones_like(time), time], axis=1),
            free_slopes=np.zeros((len(time), 2, 0)),
        )


FOPDT: Structure = _FirstOrder()
SOPDT: Structure = _SecondOrder()
IPDT: Structure = _Integrating()
STRUCTURES = (FOPDT, SOPDT, IPDT)


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
