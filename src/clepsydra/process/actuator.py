"""An actuator: how fast what a controller asks for is reached."""

from __future__ import annotations

from typing import Any

import casadi as ca

from clepsydra.base.quantity import quantity

#: Where a rate is limited and no lag is given: time to the last of the way, as a share of the
#: time over the whole span. It rounds the corner at the end of a ramp.
ROUNDING = 0.01


def follows_in(
    remedy: str, expected: str = "a time constant", words: str = "time constant of"
) -> Any:
    """Return the field of the time [s] in which an element follows; without one it does at once."""
    return quantity("s", expected, words, above=0.0, absent=0.0, remedy=remedy)


def limited_speed(missing: ca.SX, per_lag: ca.SX, rate: ca.SX | None) -> ca.SX:
    """Return dv/dt = clip((u - v)/T, -r, r): a first-order lag with a limited rate.

    Parameters
    ----------
    missing : casadi.SX
        u - v, in the unit of the signal.
    per_lag : casadi.SX
        1/T [1/s]
    rate : casadi.SX or None
        r, in the unit of the signal per second; None where it is not limited.

    Examples
    --------
    >>> [float(limited_speed(ca.SX(missing), ca.SX(2.0), ca.SX(1.0))) for missing in (0.1, 5, -5)]
    [0.2, 1.0, -1.0]
    """
    speed = missing * per_lag
    return speed if rate is None else ca.fmin(ca.fmax(speed, -rate), rate)
