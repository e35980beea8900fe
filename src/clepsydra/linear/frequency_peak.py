"""The highest point of a curve over frequency, exact with dead time, and where to look for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from clepsydra.linear.highest_points import highest_points
from clepsydra.linear.response import evaluate_transfer

_PER_DECADE = 8
# Each pole turns the phase by half a turn; so many frequencies follow it.
_PER_POLE = 8
# So far beyond the poles, and ten times farther, the curve is the one at zero or at infinity.
_BEYOND = np.array([1e2, 1e3])
# Nearer to each other than this share of the least damping ratio, frequencies are one.
_APART = 1e-3


class SensitivityPeak(NamedTuple):
    """The largest singular value of S over frequency, and where it stands.

    Parameters
    ----------
    peak : float
        max over ω of σ_max(S(jω)) [1]; infinite when the closed loop is unstable.
    frequency : float
        [rad/s]; infinite where S only approaches its peak with rising frequency, not a number
        when the closed loop is unstable.
    """

    peak: float
    frequency: float


def highest_point(
    curve: Callable[[np.ndarray], np.ndarray], grid: np.ndarray
) -> tuple[float, float]:
    """Return the maximum of a curve over frequency, and where it stands.

    As `clepsydra.linear.highest_points.highest_points` looks for it.

    Parameters
    ----------
    curve : function
        Of frequencies [l] to values [l], none below zero.
    grid : ndarray [l]
        Rising, above zero [rad/s], close enough to show every maximum.

    Returns
    -------
    tuple of float
        The value, to nine digits, and the frequency, to four [rad/s].

    Examples
    --------
    The resonance 1/(s² + 0.2 s + 1):

    >>> found = highest_point(lambda w: 1.0 / abs(1.0 - w**2 + 0.2j * w), np.geomspace(0.1, 10, 9))
    >>> round(found[0], 6), round(found[1], 3)
    (5.025189, 0.99)
    """
    return highest_points(lambda which, frequencies: curve(frequencies), [grid])[0]


def frequencies_of(poles: np.ndarray) -> np.ndarray:
    """Return frequencies that show every maximum of a rational response with these poles.

    Eight a decade, and at equal steps of the phase that each pole turns: so they stand close
    around a resonance, and where many poles turn the phase fast.

    Parameters
    ----------
    poles : ndarray [n], complex
        None at zero [rad/s].

    Returns
    -------
    ndarray [l]
        Rising [rad/s], above zero.
    """
    sizes = np.abs(poles)
    low, high = sizes.min() / 10.0, sizes.max() * 10.0
    decades = np.geomspace(low, high, int(np.ceil(_PER_DECADE * np.log10(high / low))) + 1)
    # Those of each pole stand between those of the others: equal poles share one fast turn.
    shift = (np.arange(len(poles))[:, None] + 0.5) / len(poles)
    turns = np.pi * ((np.arange(_PER_POLE) + shift) / _PER_POLE - 0.5)
    around = (poles.imag[:, None] + np.abs(poles.real)[:, None] * np.tan(turns)).ravel()
    around = around[(around > low) & (around < high)]
    far = np.concatenate([sizes.min() / _BEYOND, sizes.max() * _BEYOND])
    grid = np.sort(np.concatenate([decades, around, far]))
    # Between two that agree but for rounding no slope is seen.
    apart = _APART * np.min(np.abs(poles.real) / sizes)
    return grid[np.diff(grid, prepend=0.0) > apart * grid]


def largest_gain(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> SensitivityPeak:
    """Return the H∞ norm of a stable transfer function and the frequency of its peak.

    It is the highest of the gains at rest, at infinity, and at every maximum seen from the
    frequencies that the poles call for. The level sets of Boyd and Balakrishnan would need no
    such frequencies, but rounding in the eigenvalues of their Hamiltonian matrix hides peaks
    where speeds span many decades.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
        All eigenvalues of A in the left half-plane.

    Returns
    -------
    SensitivityPeak
        Accurate to about nine digits.

    Examples
    --------
    A resonance with damping ratio 0.1 has its peak at 1/(2 ζ √(1 - ζ²)):

    >>> A = np.array([[0.0, 1.0], [-1.0, -0.2]])
    >>> round(largest_gain(A, np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]]),
    ...                    np.zeros((1, 1))).peak, 6)
    5.025189
    """
    direct = float(np.linalg.norm(D, 2)) if D.size else 0.0
    at_infinity = SensitivityPeak(direct, float("inf"))
    if not len(A):
        return at_infinity

    def gains(frequencies: np.ndarray) -> np.ndarray:
        responses = evaluate_transfer(A, B, C, D, 1j * frequencies)
        # The root of the largest eigenvalue of GᴴG is as exact as an SVD and takes half its time.
        squares = np.linalg.eigvalsh(responses.conj().swapaxes(1, 2) @ responses)[:, -1]
        return np.sqrt(np.maximum(squares, 0.0))

    at_rest = SensitivityPeak(float(np.linalg.norm(D - C @ np.linalg.solve(A, B), 2)), 0.0)
    between = SensitivityPeak(*highest_point(gains, frequencies_of(np.linalg.eigvals(A))))
    return max(at_infinity, at_rest, between, key=lambda peak: peak.peak)
