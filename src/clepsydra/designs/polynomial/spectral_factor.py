"""Spectral factorisation: the stable polynomial D of A q A* + B B* = D δ D*."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, fsum, isfinite

import numpy as np

from clepsydra.base.errors import InputError

#: A root w of the factor this near to [0, 4] means a zero on the unit circle, as a share of 4.
_ON_THE_CIRCLE = 1e-13


@dataclass(frozen=True)
class SpectralFactor:
    """D(z^-1) = 1 + d1 z^-1 + … + dn z^-n with all roots inside the unit circle, and δ.

    Parameters
    ----------
    coefficients : tuple of float
        1, d1 … dn.
    poles : tuple of complex
        Roots of z^n D(1/z), the slowest first.
    at_one : float
        D(1), without the rounding of the coefficients.
    scale : float
        δ
    """

    coefficients: tuple[float, ...]
    poles: tuple[complex, ...]
    at_one: float
    scale: float


def spectral_factor(A: Sequence[float], B: Sequence[float], penalty: float) -> SpectralFactor:
    """Factorise A(z) q A(z^-1) + B(z) B(z^-1), in closed form up to second order.

    Both products are polynomials in w = (1 − z)(1 − z^-1), of half the degree. Of second order
    w is the root of a quadratic equation, and each w gives one pole p inside the unit circle by
    (1 − p)² / p = −w. Powers of w rather than of z keep all digits where sampling is fast and
    every root stands near 1.

    Parameters
    ----------
    A, B : sequence of float
        Coefficients of 1, z^-1, z^-2, …
    penalty : float
        q_u, from 0 on [output unit² / input unit²].

    Raises
    ------
    InputError
        Both polynomials are zero, or the sum vanishes on the unit circle: A and B share a root
        there, or B alone has one where q_u is zero.

    References
    ----------
    V. Bobál et al., eq. (27); V. Kučera, Automatica 29(6), 1993, 1361-1375.

    Examples
    --------
    Model (21) of eight tanks in series with q_u = 1 and 10:

    >>> A, B = (1.0, -1.777, 0.7964), (0.0, 0.0309, 0.0286)
    >>> [tuple(round(d, 6) for d in spectral_factor(A, B, q).coefficients) for q in (1.0, 10.0)]
    [(1.0, -1.622621, 0.68047), (1.0, -1.742615, 0.769174)]
    """
    first, second = _squared(A), _squared(B)
    size = max(len(first), len(second))
    total = np.zeros(size)
    total[: len(first)] += penalty * first
    total[: len(second)] += second
    degree = size - 1
    while degree and total[degree] == 0.0:
        degree -= 1
    if not isfinite(float(total.sum())) or not np.any(total):
        place, expected = "spectral factorisation", "polynomials that are not all zero"
        raise InputError(place, list(total), expected, "give an input that moves the output")
    gaps = [_gap(root) for root in _roots(total[: degree + 1])]
    poles = sorted((1.0 - gap for gap in gaps), key=lambda p: (-abs(p), -p.imag))
    coefficients = np.real(np.poly(np.array(poles))) if poles else np.ones(1)
    at_one = float(np.prod(gaps).real) if gaps else 1.0
    return SpectralFactor(
        tuple(float(d) for d in np.atleast_1d(coefficients)),
        tuple(complex(p) for p in poles),
        at_one,
        float(total[0] / at_one**2),
    )


def about_one(polynomial: Sequence[float]) -> list[float]:
    """Return the coefficients of powers of 1 − z^-1 of a polynomial in z^-1.

    Examples
    --------
    1 − 3 z^-1 + 2 z^-2 = −(1 − z^-1) + 2 (1 − z^-1)²:

    >>> about_one([1.0, -3.0, 2.0])
    [0.0, -1.0, 2.0]
    """
    n = len(polynomial)
    return [
        fsum((-1) ** j * comb(i, j) * float(polynomial[i]) for i in range(j, n)) for j in range(n)
    ]


def _squared(polynomial: Sequence[float]) -> np.ndarray:
    """Return P(z) P(z^-1) as coefficients of powers of w.

    With x = 1 − z^-1 and y = 1 − z both x y and x + y are w, so that x^k + y^k follows from
    the two before it.
    """
    alpha = about_one(polynomial)
    n = len(alpha)
    sums = [np.array([2.0]), np.array([0.0, 1.0])]
    for _ in range(2, n):
        last, before = (np.concatenate([[0.0], each]) for each in (sums[-1], sums[-2]))
        before = np.concatenate([before, np.zeros(len(last) - len(before))])
        sums.append(last - before)
    total = np.zeros(max(n, 1))
    for i in range(n):
        total[i] += alpha[i] ** 2
        for j in range(i + 1, n):
            shape = sums[j - i]
            total[i : i + len(shape)] += alpha[i] * alpha[j] * shape
    return total


def _roots(total: np.ndarray) -> list[complex]:
    """Return the roots w of Σ total_k w^k: in closed form up to two."""
    degree = len(total) - 1
    if degree == 0:
        return []
    if degree == 1:
        return [complex(-total[0] / total[1])]
    if degree == 2:
        c, b, a = (float(value) for value in total)
        root = cmath.sqrt(b * b - 4.0 * a * c)
        larger = -0.5 * (b + (root if (b * root.conjugate()).real >= 0.0 else -root))
        return [larger / a, c / larger] if larger != 0.0 else [0j, 0j]
    return [complex(root) for root in np.roots(total[::-1])]


def _gap(w: complex) -> complex:
    """Return 1 − p of the pole inside the unit circle: (1 − p)² = −w p."""
    if abs(w.imag) <= _ON_THE_CIRCLE and -4.0 * _ON_THE_CIRCLE <= w.real <= 4.0:
        raise InputError(
            "spectral factorisation", f"a zero on the unit circle, w = {w:.3g}",
            "polynomials A and B that share no root there",
            "take a model that the input can steady, and q_u above zero",
        )  # fmt: skip
    root = cmath.sqrt(w * w - 4.0 * w)
    # Their product is w: the larger one first, so that the smaller one loses no digits.
    larger = 0.5 * (w + root) if (w * root.conjugate()).real >= 0.0 else 0.5 * (w - root)
    return min(larger, w / larger, key=lambda gap: abs(1.0 - gap))
