"""The controller of two degrees of freedom: K P u = r0 w − Q y, by Diophantine equations."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.polynomial.diophantine import (
    Polynomial,
    product,
    rational,
    solve_diophantine,
)
from clepsydra.designs.polynomial.spectral_factor import SpectralFactor

#: K(z^-1) = 1 − z^-1: integral action.
INTEGRAL = rational([1, -1])


@dataclass(frozen=True)
class Characteristic:
    """D(z^-1), the characteristic polynomial of a closed loop, by its roots.

    Parameters
    ----------
    coefficients : tuple of float
        1, d1, d2, …
    at_one : float
        D(1), without the rounding of the coefficients.

    Examples
    --------
    >>> Characteristic((1.0, -0.5), 0.5).degree
    1
    """

    coefficients: tuple[float, ...]
    at_one: float

    @property
    def degree(self) -> int:
        """Of D in z^-1."""
        return len(self.coefficients) - 1


def assigned(factor: SpectralFactor, poles: Sequence[float]) -> Characteristic:
    """Return D of the spectral factor's poles and real poles that the designer adds.

    Parameters
    ----------
    poles : sequence of float
        γ of equation (30) or (32), and further ones, each inside the unit circle.

    References
    ----------
    V. Bobál et al., eq. (29) to (33), with d3 = −αβγ in the place of (31)'s +αβγ.

    Examples
    --------
    >>> from clepsydra.designs.polynomial.spectral_factor import spectral_factor
    >>> factor = spectral_factor((1.0, -1.777, 0.7964), (0.0, 0.0309, 0.0286), 10.0)
    >>> tuple(round(d, 4) for d in assigned(factor, [0.5]).coefficients)
    (1.0, -2.2426, 1.6405, -0.3846)
    """
    coefficients = np.array(factor.coefficients)
    for pole in poles:
        coefficients = np.convolve(coefficients, [1.0, -pole])
    at_one = factor.at_one * math.prod(1.0 - pole for pole in poles)
    return Characteristic(tuple(float(d) for d in coefficients), at_one)


@dataclass(frozen=True)
class TwoDegreeOfFreedom:
    """P(z^-1) (1 − z^-1) u = r0 w − Q(z^-1) y.

    Parameters
    ----------
    P, Q : tuple of Fraction
        Exact solutions of equation (22).
    feedforward : float
        r0 of equation (24).

    Examples
    --------
    A PI controller, K = 2 and K T0/Ti = 0.1: its differences are those of the measurement.

    >>> pi = TwoDegreeOfFreedom(rational([1]), rational([2.1, -2.0]), 0.1)
    >>> [round(value, 9) for value in pi.difference_gains], pi.increment_gains
    ([2.0], ())
    """

    P: Polynomial
    Q: Polynomial
    feedforward: float

    @property
    def increment_gains(self) -> tuple[float, ...]:
        """p1, p2, … with P divided by p0: of the input's last increments."""
        return tuple(float(value / self.P[0]) for value in self.P[1:])

    @property
    def reference_gain(self) -> float:
        """r0, with P divided by p0: of the error, in each sample."""
        return self.feedforward / float(self.P[0])

    @property
    def difference_gains(self) -> tuple[float, ...]:
        """g1, g2, …: Q y = Q(1) y + g1 (y − y(k−1)) + g2 (y(k−1) − y(k−2)) + …"""
        return tuple(
            float(-sum(self.Q[place:], start=Fraction(0)) / self.P[0])
            for place in range(1, len(self.Q))
        )


def two_degree_of_freedom(
    A: Sequence[float], B: Sequence[float], D: Characteristic
) -> TwoDegreeOfFreedom:
    """Solve A K P + B Q = D, and r0 = D(1)/B(1), for the controller of lowest order.

    Q has the degree of A, and P that of B less one, or so many more as D asks for.

    Parameters
    ----------
    A, B : sequence of float
        Coefficients of 1, z^-1, z^-2, …; B begins with a zero, and holds the delay.

    Raises
    ------
    InputError
        B(1) is zero, so that no input holds the output, or A K and B share a root.

    References
    ----------
    V. Bobál et al., eq. (22) to (25).

    Examples
    --------
    The first design of section 6, whose predictor has B(1) z^-1 in the place of B:

    >>> from clepsydra.designs.polynomial.spectral_factor import spectral_factor
    >>> A, B = (1.0, -1.777, 0.7964), (0.0, 0.0309, 0.0286)
    >>> D = assigned(spectral_factor(A, B, 10.0), [0.01])
    >>> found = two_degree_of_freedom(A, (0.0, sum(B)), D)
    >>> [round(float(q), 3) for q in found.Q], found.increment_gains, round(found.feedforward, 4)
    ([17.217, -30.03, 13.256], (), 0.4419)
    """
    gain = math.fsum(B)
    if abs(gain) <= 1e-12 * math.fsum(abs(b) for b in B):
        remedy = "choose an input that can hold the output"
        raise InputError("2DOF controller, B(1)", gain, "a number that is not zero", remedy)
    steadied = product(rational(A), INTEGRAL)
    degree_q = len(steadied) - 2
    degree_p = max(len(B) - 2, D.degree - len(steadied) + 1)
    P, Q = solve_diophantine(steadied, B, D.coefficients, degree_x=degree_p, degree_y=degree_q)
    return TwoDegreeOfFreedom(P, Q, D.at_one / gain)
