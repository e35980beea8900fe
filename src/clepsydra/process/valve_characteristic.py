"""Inherent characteristics of a control valve: the share of its Kv over its opening."""

from __future__ import annotations

import casadi as ca

from clepsydra.process.root_law import falling_root

#: Linear first, since it is what a file means that does not say.
CHARACTERISTICS = ("linear", "equal percentage", "quick opening")

#: Opening of a quick-opening valve below which the root is replaced, since its slope is infinite.
_SMALL_OPENING = 0.01


def opened(
    characteristic: str, opening: ca.SX | float, rangeability: ca.SX | float = 50.0
) -> ca.SX:
    """Return the share of the full Kv at an opening s.

    With rangeability R: f = s (linear), f = R^(s-1) (equal percentage), f = √s (quick opening);
    D. E. Seborg, T. F. Edgar, D. A. Mellichamp, Process Dynamics and Control, 2nd edition, 2004,
    section 9.2. An equal-percentage valve leaks 1/R when shut. The root of a quick-opening valve
    is smooth below 1 % of the stroke, see `clepsydra.process.root_law`, so that its slope is
    finite.

    Parameters
    ----------
    characteristic : str
        One of `CHARACTERISTICS`.
    opening : casadi.SX or float
        s, 0 shut and 1 open.
    rangeability : casadi.SX or float
        R, above 1.

    Examples
    --------
    Every tenth of the stroke multiplies the flow of an equal-percentage valve alike:

    >>> shares = [float(opened("equal percentage", ca.SX(s), 50.0)) for s in (0.5, 0.6, 0.7)]
    >>> round(shares[1] / shares[0], 6), round(shares[2] / shares[1], 6)
    (1.478758, 1.478758)
    """
    if characteristic == "linear":
        return ca.SX(opening)
    if characteristic == "equal percentage":
        return ca.exp(ca.log(ca.SX(rangeability)) * (ca.SX(opening) - 1))
    return falling_root(ca.SX(opening), _SMALL_OPENING)
