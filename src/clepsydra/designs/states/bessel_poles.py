"""The pattern of poles that a placement takes by default: Bessel's."""

from __future__ import annotations

from functools import cache

import numpy as np


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
    from scipy.signal import besselap

    return tuple(np.asarray(besselap(order, norm="mag")[1], complex).tolist())
