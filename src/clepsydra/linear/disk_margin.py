"""The disk margin: how much gain and phase may change together, in one loop or in all."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clepsydra.linear.circles import circles

_SWEEPS = 12
# A coupling below this share of the matrix is balanced as if it were so large.
_LEAST = 1e-12


def structured_singular_values(matrices: np.ndarray) -> np.ndarray:
    """Return μ(M) for a diagonal Δ of complex numbers, one for each channel.

    1/μ is the smallest max|δ_i| for which I - M diag(δ) is singular. It is bounded above by
    min σ_max(D M D⁻¹) over diagonal D > 0, which for up to three channels it equals. The
    minimum is a convex problem in log D.

    Parameters
    ----------
    matrices : ndarray [k, q, q], complex

    Returns
    -------
    ndarray [k]
        The bound. For more than two channels only the largest of the list is sharp; the others
        are bounds that do not exceed it.

    References
    ----------
    A. Packard and J. Doyle, The complex structured singular value, Automatica 29(1), 1993,
    71-109, doi 10.1016/0005-1098(93)90175-S.

    Examples
    --------
    A large coupling one way only is no danger:

    >>> structured_singular_values(np.array([[[0.5, 100.0], [0.0, 0.25]]])).round(6)
    array([0.5])
    """
    # Channels that act on others but not back form a triangle, in which only the blocks count.
    coupled = np.abs(matrices).max(axis=0, initial=0.0) > 0.0
    bounds = np.zeros(len(matrices))
    for channels in circles(coupled):
        bounds = np.maximum(bounds, _bounds(matrices[:, channels[:, None], channels]))
    return bounds


def _bounds(matrices: np.ndarray) -> np.ndarray:
    """Return the bound of channels that all act on each other."""
    q = matrices.shape[1]
    if q == 1:
        return np.abs(matrices[:, 0, 0])
    balanced = _balanced(matrices)
    bounds = np.linalg.norm(balanced, 2, axis=(1, 2))
    if q == 2:  # |det| does not depend on D, so the smallest Frobenius norm has the smallest σ
        return bounds
    # Only the largest matter to who looks for a peak: a value that stays below one already
    # found is left at the bound that balancing gave.
    best = 0.0
    for place in np.argsort(-bounds):
        if bounds[place] <= best:
            break
        bounds[place] = min(bounds[place], _smallest_norm(balanced[place], best))
        best = max(best, float(bounds[place]))
    return np.asarray(bounds)


def _balanced(matrices: np.ndarray) -> np.ndarray:
    """Return D M D⁻¹ of the smallest Frobenius norm: rows as long as columns (Osborne, 1960)."""
    q = matrices.shape[1]
    scaled = np.array(matrices, complex)
    least = _LEAST * np.maximum(np.linalg.norm(scaled, axis=(1, 2)), np.finfo(float).tiny)
    for _ in range(1 if q == 2 else _SWEEPS):
        for channel in range(q):
            others = np.arange(q) != channel
            row = np.linalg.norm(scaled[:, channel, others], axis=1)
            column = np.linalg.norm(scaled[:, others, channel], axis=1)
            factor = np.sqrt(np.maximum(column, least) / np.maximum(row, least))
            scaled[:, channel, :] *= factor[:, None]
            scaled[:, :, channel] /= factor[:, None]
    return scaled


def _smallest_norm(matrix: np.ndarray, enough: float) -> float:
    """Return min σ_max(D M D⁻¹), or a bound of it that is not above `enough`.

    σ_max has a kink where two singular values meet, which the quick descent may stop at; the
    slow one then goes on from there.
    """
    from scipy.optimize import minimize

    def scaled(logarithms: np.ndarray) -> np.ndarray:
        factors = np.exp(np.concatenate([[0.0], logarithms]))
        return np.asarray(factors[:, None] * matrix / factors)

    def size(logarithms: np.ndarray) -> float:
        return float(np.linalg.norm(scaled(logarithms), 2))

    def size_and_slope(logarithms: np.ndarray) -> tuple[float, np.ndarray]:
        left, sizes, right = np.linalg.svd(scaled(logarithms))
        slope = sizes[0] * (np.abs(left[:, 0]) ** 2 - np.abs(right[0]) ** 2)
        return float(sizes[0]), slope[1:]

    start = np.zeros(len(matrix) - 1)
    quick = minimize(size_and_slope, start, jac=True, method="BFGS", options={"gtol": 1e-9})
    if quick.fun <= enough * (1.0 + 1e-9):
        return float(quick.fun)
    options = {"xatol": 1e-7, "fatol": 1e-10 * quick.fun, "maxiter": 2000, "adaptive": True}
    slow = minimize(size, quick.x, method="Nelder-Mead", options=options)
    return float(min(quick.fun, slow.fun))


class DiskMargin(NamedTuple):
    """A symmetric disk of complex factors that the loop withstands, in every channel at once.

    A factor in each channel may be any (1 + δ/2)/(1 - δ/2) with |δ| < α.

    Parameters
    ----------
    size : float
        α [1], from 0 (not stable) to 2.
    frequency : float
        Where the smallest destabilising factor oscillates [rad/s]; not a number when the loop
        is unstable.

    Examples
    --------
    >>> margin = DiskMargin(2.0 / 3.0, 1.0)
    >>> round(margin.gain, 6), round(math.degrees(margin.phase), 2)
    (2.0, 36.87)
    """

    size: float
    frequency: float

    @property
    def gain(self) -> float:
        """The gain may be multiplied or divided by this [1]; infinite for α = 2."""
        return (2.0 + self.size) / (2.0 - self.size) if self.size < 2.0 else math.inf

    @property
    def phase(self) -> float:
        """The phase may change by this, up or down [rad]."""
        return 2.0 * math.atan(self.size / 2.0)
