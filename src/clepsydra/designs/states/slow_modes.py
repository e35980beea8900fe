"""Placement of the slow modes alone: what is fast enough by itself stays as it is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.designs.states.bessel_poles import bessel_poles, bessel_radius
from clepsydra.designs.states.placement import placed_gain

#: A mode slower than the pattern by less than this share counts as fast enough.
_SAME = 1e-6


class PlacedModes(NamedTuple):
    """F, and how many modes it moves to Bessel's pattern."""

    gain: np.ndarray
    moved: int


def place_slow_modes(
    held: np.ndarray,
    moved: np.ndarray,
    bandwidth: float,
    sizes: np.ndarray,
    moves: np.ndarray,
    period: float,
) -> PlacedModes:
    """Return F with which the slow eigenvalues of Φ − Γ F have Bessel's pattern.

    To slow a fast mode down costs gain and robustness and is good for nothing. So the k slowest
    modes are moved, where k is the largest number of modes that are all slower than every pole
    of the pattern of order k. F sees nothing but their part of the state, Zᵀ x with an
    orthonormal basis Z of their left invariant subspace, and the others keep their poles.

    Parameters
    ----------
    held, moved : ndarray [n, n], [n, m]
        Φ and Γ.
    bandwidth : float
        Of the pattern [rad/s].
    sizes, moves : ndarray [n], [m]
        Ranges of the states and of the inputs, in which they are compared.
    period : float
        The sampling period [s].

    Raises
    ------
    NotApplicable
        A slow mode is out of reach, or the poles cannot be placed accurately.

    Examples
    --------
    Modes of 100 s and 1 s; a pattern for 0.1 rad/s moves the first alone:

    >>> held = np.diag(np.exp([-0.01, -1.0]))
    >>> sizes = np.ones(2), np.ones(1)
    >>> gain, count = place_slow_modes(held, np.ones((2, 1)), 0.1, *sizes, 1.0)
    >>> np.sort(np.log(np.linalg.eigvals(held - np.ones((2, 1)) @ gain))).round(9), count
    (array([-1. , -0.1]), 1)
    """
    from scipy.linalg import schur

    scaled = held * sizes / sizes[:, None]
    rates = np.sort(_rates(np.linalg.eigvals(scaled), period))
    count = 0
    for order in range(len(rates), 0, -1):
        radius = bessel_radius(order) * bandwidth
        # A pair of complex modes is not torn apart.
        torn = order < len(rates) and rates[order] <= rates[order - 1] * (1.0 + _SAME)
        if rates[order - 1] < radius * (1.0 - _SAME) and not torn:
            count = order
            break
    if not count:
        return PlacedModes(np.zeros((moved.shape[1], len(held))), 0)
    limit = rates[count - 1] * (1.0 + 0.5 * _SAME)

    def is_slow(real: float, imaginary: float) -> bool:
        return bool(_rates(np.array([complex(real, imaginary)]), period)[0] <= limit)

    # Φᵀ Z = Z T, so that w = Zᵀ x has w⁺ = Tᵀ w + Zᵀ Γ u.
    form, basis, found = schur(scaled.T, output="real", sort=is_slow)
    Z = basis[:, :found]
    poles = bessel_poles(found, bandwidth, period)
    reduced = Z.T @ (moved / sizes[:, None])
    part, ones = form[:found, :found].T, np.ones(found)
    gain = placed_gain(part, reduced, poles, ones, moves, period)
    return PlacedModes(gain @ Z.T / sizes, found)


def _rates(eigenvalues: np.ndarray, period: float) -> np.ndarray:
    """Return |s| of z = e^(sT) [rad/s]."""
    smallest = np.maximum(np.abs(eigenvalues), np.finfo(float).tiny)
    logarithm = np.log(smallest) + 1j * np.angle(eigenvalues)
    rates: np.ndarray = np.abs(logarithm) / period
    return rates
