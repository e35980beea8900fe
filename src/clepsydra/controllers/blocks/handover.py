"""What a law asks of an output, and what it is told back about what was applied."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Asked:
    """What a block asks of the next one.

    Parameters
    ----------
    value : casadi.SX
        Always a number where `usable` holds.
    usable : casadi.SX
        Whether it may be acted on in this sample.
    numbers, sensors : casadi.SX
        Whether all signals behind it are numbers, and their sensors sound: for the status word.

    Examples
    --------
    >>> float(Asked(ca.DM(4.0), ca.DM(1), ca.DM(1), ca.DM(1)).value)
    4.0
    """

    value: ca.SX
    usable: ca.SX
    numbers: ca.SX
    sensors: ca.SX


@dataclass(frozen=True)
class Applied:
    """What became of it, told back (the back calculation of a fieldbus block).

    Parameters
    ----------
    value : casadi.SX
        What the block would have had to ask for to get what was applied.
    in_force : casadi.SX
        Whether the block had its say: the way to the actuator is in automatic.
    follows : casadi.SX
        Whether the actuator moves without it, by hand or tracking, and it has to follow. Where
        neither holds, an unusable signal froze everything.

    Examples
    --------
    >>> bool(Applied(ca.DM(4.0), ca.DM(0), ca.DM(1)).follows)
    True
    """

    value: ca.SX
    in_force: ca.SX
    follows: ca.SX


@dataclass(frozen=True)
class Limits:
    """Between which values the next block takes what is asked.

    Examples
    --------
    >>> float(Limits(ca.DM(0.0), ca.DM(10.0)).high)
    10.0
    """

    low: ca.SX
    high: ca.SX
