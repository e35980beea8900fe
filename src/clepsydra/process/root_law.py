"""The flow through an opening between two levels: turbulent, and laminar at small differences."""

from __future__ import annotations

import casadi as ca


def signed_root(difference: ca.SX, laminar: float) -> ca.SX:
    """Return sign(Δ) √|Δ|, replaced by a smooth law where |Δ| is below `laminar` [√m].

    Torricelli's root has an infinite slope at equal levels, which no integrator, linear model
    or optimisation can use; and a small flow is in truth laminar, in proportion to Δ. Below
    δ = `laminar`, with s = Δ/δ,

        φ = √δ (45 s - 18 s³ + 5 s⁵) / 32,

    the odd polynomial of degree five that meets the root at s = 1 with equal value, slope and
    curvature, so that an integrator of order four keeps its order. It rises everywhere. Its
    slope at equal levels is 45/32 / √δ.

    Parameters
    ----------
    difference : casadi.SX
        Δ [m]
    laminar : float
        δ [m], above zero.

    Examples
    --------
    >>> [round(float(signed_root(ca.SX(value), 1e-3)), 6) for value in (0.04, -0.04, 0.0)]
    [0.2, -0.2, 0.0]
    """
    size = ca.fabs(difference)
    turbulent = ca.sqrt(ca.fmax(size, laminar))
    return ca.if_else(
        size < laminar,
        _small(difference, laminar),
        ca.if_else(difference < 0, -turbulent, turbulent),
    )


def falling_root(level: ca.SX, laminar: float) -> ca.SX:
    """Return the root law for a level above a free outlet, and 0 below it [√m].

    Parameters
    ----------
    level : casadi.SX
        h [m]
    laminar : float
        δ [m], above zero.

    Examples
    --------
    >>> [round(float(falling_root(ca.SX(value), 1e-3)), 6) for value in (0.04, 1e-3, -0.04)]
    [0.2, 0.031623, 0.0]
    """
    turbulent = ca.sqrt(ca.fmax(level, laminar))
    return ca.if_else(level < laminar, _small(ca.fmax(level, 0), laminar), turbulent)


def _small(difference: ca.SX, laminar: float) -> ca.SX:
    """Return the polynomial, with δ in its coefficients: five operations."""
    first = 45 / 32 * laminar**-0.5
    third = -18 / 32 * laminar**-2.5
    fifth = 5 / 32 * laminar**-4.5
    squared = difference * difference
    return difference * (first + squared * (third + squared * fifth))
