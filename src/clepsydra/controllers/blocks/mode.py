"""Modes of an output, and what each of them takes the output from."""

from __future__ import annotations

from enum import IntEnum

import casadi as ca


class Mode(IntEnum):
    """Who moves an output.

    MANUAL takes the manual value, AUTOMATIC the control law, TRACKING the tracking value
    (another controller or a local station has the actuator). Any other number holds the
    last output.
    """

    MANUAL = 0
    AUTOMATIC = 1
    TRACKING = 2


def followed_integral(
    integral: ca.SX, output: ca.SX, last_output: ca.SX, proportional: ca.SX, known: ca.SX
) -> ca.SX:
    """Return the integral from which automatic continues without a bump.

    The next automatic output is proportional + integral, so the integral is the present
    output less the proportional part. While that part is unknown (a failed sensor) the
    integral moves with the output, which leaves the last known proportional part in force.

    Parameters
    ----------
    integral, output, last_output, proportional : casadi.SX
        In the unit of the output.
    known : casadi.SX
        Whether `proportional` was computed from valid signals.

    Examples
    --------
    >>> known, unknown = ca.DM(1), ca.DM(0)
    >>> values = [ca.DM(value) for value in (2.0, 5.0, 4.0, 0.5)]
    >>> float(followed_integral(*values, known)), float(followed_integral(*values, unknown))
    (4.5, 3.0)
    """
    return ca.if_else(known, output - proportional, integral + (output - last_output))
