"""The poles of Bessel's filter, and where its gain comes down to 1/√2."""

from __future__ import annotations

from functools import cache

import numpy as np

#: Roots converge cubically: one that moved by less than this share has all its digits.
_STILL = 1e-13
_ITERATIONS = 100


def bessel_poles(order: int, bandwidth: float, period: float) -> np.ndarray:
    """Return the poles of Bessel's filter, taken to the unit circle by z = e^(sT).

    Bessel's patterns respond to a step with an overshoot below 1 %, where Butterworth's and
    those of least ITAE overshoot the more the higher the order: a tank must not overflow. All
    poles are different, as placement by few inputs needs them.

    Parameters
    ----------
    order : int
        Number of poles.
    bandwidth : float
        Where the filter's gain is 1/√2 [rad/s].
    period : float
        T, the sampling period [s].

    References
    ----------
    W. E. Thomson, Delay networks having maximally flat frequency characteristics, Proceedings
    of the IEE 96(44), 1949, 487-490.
    G. F. Franklin, J. D. Powell and A. Emami-Naeini, Feedback Control of Dynamic Systems,
    chapter 7.

    Examples
    --------
    The pattern of second order is s² + 3 s + 3 in its own time scale:

    >>> s = np.log(bessel_poles(2, 1.0, 0.1)) / 0.1
    >>> round(float(-s[0].real / abs(s[0])), 6)  # the damping √3/2
    0.866025
    """
    poles: np.ndarray = np.exp(np.array(_prototype(order)) * bandwidth * period)
    return poles


def bessel_radius(order: int) -> float:
    """Return the smallest |s| among the poles of Bessel's filter of a bandwidth of 1 rad/s.

    Examples
    --------
    >>> round(bessel_radius(1), 12)
    1.0
    """
    return float(np.min(np.abs(_prototype(order))))


@cache
def _prototype(order: int) -> tuple[complex, ...]:
    """Return the poles for a bandwidth of 1 rad/s; a search asks hundreds of times for few."""
    poles = _roots(order)
    poles = poles[np.argsort(poles.imag)]
    poles = (poles + poles[::-1].conj()) / 2.0
    return tuple((poles / _bandwidth(poles)).tolist())


def _roots(order: int) -> np.ndarray:
    """Return the roots of the reverse Bessel polynomial θ, by the method of Aberth and Ehrlich.

    Its coefficients hide them above the tenth order. But θ(s) is sⁿ⁺½ eˢ Kₙ₊½(s) to a factor,
    and so Newton's step θ/θ' is K₊/(K₊ - K₋), with the modified Bessel functions of the orders
    n + ½ and n - ½.
    """
    from scipy.special import kve

    # The recurrence yₖ = (2k - 1) x yₖ₋₁ + yₖ₋₂ with x = 1/s, as a matrix: near enough.
    beside = 1.0 / np.sqrt(4.0 * np.arange(1, order) ** 2 - 1.0)
    recurrence = np.diag(beside, 1) - np.diag(beside, -1)
    recurrence[0, 0] = -1.0
    roots = 1.0 / np.linalg.eigvals(recurrence).astype(complex)
    itself = np.diag(np.full(order, np.inf))
    for _ in range(_ITERATIONS):
        above = kve(order + 0.5, roots)
        newton = above / (above - kve(order - 0.5, roots))
        step = newton / (1.0 - newton * np.sum(1.0 / (roots[:, None] - roots + itself), axis=1))
        roots = roots - step
        if np.all(np.abs(step) <= _STILL * np.abs(roots)):
            break
    return np.asarray(roots)


def _bandwidth(poles: np.ndarray) -> float:
    """Return where the gain of the filter with these poles is 1/√2, by Newton's method [rad/s]."""
    found = np.sqrt((2.0 * len(poles) - 1.0) * np.log(2.0))  # of the Gaussian that it tends to
    for _ in range(_ITERATIONS):
        squares = np.abs(1j * found - poles) ** 2
        damping = np.sum(np.log(squares / np.abs(poles) ** 2)) - np.log(2.0)
        step = damping / np.sum(2.0 * (found - poles.imag) / squares)
        found -= step
        if abs(step) <= _STILL * found:
            break
    return float(found)
