"""Structures of transfer functions with dead time: their step and free responses."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Below this size (e^z − 1)/z is its series, which is exact to rounding there.
_SMALL = 1e-4


class Responses(NamedTuple):
    """Responses of a structure at given lags.

    They are analytic in times and lags, so that complex ones tell their slopes.
    """

    step: np.ndarray  # [N], to a unit step at time zero, for a gain of one
    free: np.ndarray  # [N, f]: its rest, and what is left of earlier motion


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
    free = np.stack([np.ones_like(time), np.exp(-time / lags[0])], axis=1)
    return Responses(1.0 - np.exp(-since / lags[0]), free)


def _second_order(since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
    """Two real lags; every response is symmetric in them and smooth where they are equal."""
    still, moving = _divided(time, lags)
    free = np.stack([np.ones_like(time), still, np.mean(lags) * moving], axis=1)
    return Responses(1.0 - _divided(since, lags)[0], free)


def _integrating(since: np.ndarray, time: np.ndarray, lags: np.ndarray) -> Responses:
    return Responses(since, np.stack([np.ones_like(time), time], axis=1))


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


def _divided(time: np.ndarray, lags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (f(τ1) − f(τ2))/(τ1 − τ2) of f = τ e^(−t/τ), and of f = e^(−t/τ).

    With e^(−t/τ1) before a bracket, τ1 the longer, the difference is one of exponents, which can
    be zero and never overflows.
    """
    shorter, longer = sorted(lags, key=np.real)
    apart = time * (1.0 / longer - 1.0 / shorter)
    small = np.abs(apart) < _SMALL
    series = 1.0 + apart / 2.0 * (1.0 + apart / 3.0 * (1.0 + apart / 4.0))
    share = np.where(small, series, np.expm1(apart) / np.where(small, 1.0, apart))
    decay = time / (shorter * longer) * np.exp(-time / longer) * share
    return longer * decay + np.exp(-time / shorter), decay
