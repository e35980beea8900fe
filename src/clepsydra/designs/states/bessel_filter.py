"""The poles of Bessel's filter, and where its gain comes down to 1/√2."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

#: Roots converge cubically: one that moved by less than this share has all its digits.
_STILL = 1e-13
_ITERATIONS = 100
#: Binary digits behind the point for each order when θ is summed: more than its terms cancel.
_DIGITS = 8
#: Those of a root.
_OF_ROOT = 60


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
    """Return the roots of the reverse Bessel polynomial θ, by the method of Aberth and Ehrlich."""
    # The recurrence yₖ = (2k - 1) x yₖ₋₁ + yₖ₋₂ with x = 1/s, as a matrix: near enough.
    beside = 1.0 / np.sqrt(4.0 * np.arange(1, order) ** 2 - 1.0)
    recurrence = np.diag(beside, 1) - np.diag(beside, -1)
    recurrence[0, 0] = -1.0
    roots = 1.0 / np.linalg.eigvals(recurrence).astype(complex)
    itself = np.diag(np.full(order, np.inf))
    for _ in range(_ITERATIONS):
        newton = np.array([_newton_step(order, root) for root in roots.tolist()])
        step = newton / (1.0 - newton * np.sum(1.0 / (roots[:, None] - roots + itself), axis=1))
        roots = roots - step
        if np.all(np.abs(step) <= _STILL * np.abs(roots)):
            break
    return np.asarray(roots)


def _newton_step(order: int, root: complex) -> complex:
    """Return θ/θ', the step of Newton's method.

    Above the tenth order the terms of θ hide its roots from numbers of 16 digits, and integers
    have as many as are asked for.
    """
    bits = _DIGITS * (order + 8)
    x, y = (int(math.ldexp(part, _OF_ROOT)) << (bits - _OF_ROOT) for part in (root.real, root.imag))
    real = imaginary = slope_real = slope_imaginary = 0
    coefficient = 1  # (2n - k)!/(2ⁿ⁻ᵏ k! (n - k)!), from k = n down
    for power in range(order, -1, -1):
        slope_real, slope_imaginary = (
            ((slope_real * x - slope_imaginary * y) >> bits) + real,
            ((slope_real * y + slope_imaginary * x) >> bits) + imaginary,
        )
        real, imaginary = (
            ((real * x - imaginary * y) >> bits) + (coefficient << bits),
            (real * y + imaginary * x) >> bits,
        )
        left = order - power
        coefficient = coefficient * power * (order + left + 1) // (2 * (left + 1))
    size = slope_real**2 + slope_imaginary**2
    return complex(
        (real * slope_real + imaginary * slope_imaginary) / size,
        (imaginary * slope_real - real * slope_imaginary) / size,
    )


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
