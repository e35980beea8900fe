"""A balance of flows in which two roots of a head remain: a head in closed form all the same."""

from __future__ import annotations

from typing import Any

import casadi as ca

#: What counts as nothing, so that no root is taken of zero, where it has no slope; single precision
#: has its square too.
NOTHING = 1e-18


def balanced_head(e: ca.SX, c: ca.SX, m: ca.SX, apart: Any) -> tuple[ca.SX, ca.SX]:
    """Return e, above zero, and D of the head y = e²/D at which e - c y = 2 m √(y (y + d)).

    Squared, this is of degree two in y. Its smaller root is

        y = e² / (c e + 2 m² d + 2 m √(e (e + c d) + m² d²)),

    in which nothing cancels. It begins at e = 0, and √y = e/√D has a slope there.

    Parameters
    ----------
    e : casadi.SX
        What is to spare where y is zero [m⁶/s²].
    c, m : casadi.SX
        Sum of the squares of all conductances, and the product of the two under one root [m⁵/s²].
    apart : casadi.SX
        d, by how much the heads under the roots differ [m].

    Examples
    --------
    √(9 - y) = √y + √(y + 5), squared 4 - 3 y = 2 √(y (y + 5)):

    >>> e, divisor = balanced_head(ca.SX(4.0), ca.SX(3.0), ca.SX(1.0), 5.0)
    >>> round(float(e**2 / divisor), 12)
    0.380049751552
    """
    e = ca.fmax(e, NOTHING)
    moved = m * apart
    root = ca.sqrt(ca.fmax(e * (e + c * apart) + moved * moved, NOTHING * NOTHING))
    return e, c * e + 2 * m * (moved + root)
