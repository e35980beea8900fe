"""The weir over which a tank spills."""

from __future__ import annotations

import casadi as ca

#: Height over a weir below which its flow is in proportion to the height [m].
_THINNEST_FILM = 1e-6


def weir_flow(above: ca.SX, length: ca.SX, discharge: ca.SX, gravity: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the flow over a weir as coefficient and driver: 2/3 c b √(2 g) and (h - H)^(3/2).

    Parameters
    ----------
    above : casadi.SX
        Height of the liquid over the weir, h - H; nothing flows below 0 [m].
    length : casadi.SX
        b [m]
    discharge : casadi.SX
        Discharge coefficient c [1].
    gravity : casadi.SX
        g [m/s²]

    References
    ----------
    Poleni 1717; H. Chanson, The Hydraulics of Open Channel Flow, 2nd edition, 2004, chapter 19.

    Examples
    --------
    10 cm over a weir of 1 m:

    >>> coefficient, driver = weir_flow(*map(ca.SX, (0.1, 1.0, 0.6, 9.81)))
    >>> round(float(coefficient * driver), 4)  # [m³/s]
    0.056
    """
    coefficient = length * discharge * (2 / 3 * ca.sqrt(2 * gravity))
    above = ca.fmax(above, 0)
    # The root of a film of nothing has no slope; that of a millionth of a metre has.
    return coefficient, above * ca.sqrt(ca.fmax(above, _THINNEST_FILM))
