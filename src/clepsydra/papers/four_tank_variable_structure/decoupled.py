"""Fillings after decoupling by (9), as Figs. 3 to 6 are, over what is not printed."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.papers.four_tank_variable_structure.readings import SATURATED
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
    IN_WORDS,
    SAMPLED,
    VOLTS_PER_METRE,
    Filling,
)
from clepsydra.papers.four_tank_variable_structure.virtual_lanes import Setting, filled_with

#: Of both pumps [V].
LIMITS = np.linspace(4.0, 20.0, 33)
#: What the rows on the decoupled tanks rest on.
READING = (
    "After decoupling by (9). What is not printed is ours: Johansson's tanks P− and PI controllers "
    f"({IN_WORDS}) times E for ν, 0.5 V/cm, a sample every {SAMPLED:g} s, pumps from 0 to 10 V, "
    f"α = {ALPHA:g} 1/s on ν with K_1 of (14) as K/Ti, from empty tanks and integrals at zero to "
    "12.4 and 12.7 cm."
)
#: The other reading of α.
IN_VOLTS = "α in volts takes u_n − u_s of (14) in volts and K_1 as that of ν."


class DecoupledReading(NamedTuple):
    """One way to read what is not printed; ν rests at zero, so that it needs no bias.

    Parameters
    ----------
    sensor : float
        [V/cm]
    alpha_on : {"virtual", "input"}
        Whether α acts on ν or in volts.

    Examples
    --------
    >>> print(DECOUPLED_READINGS[-1])
    1 V/cm and α in volts
    """

    sensor: float
    alpha_on: AlphaOn

    def __str__(self) -> str:
        return f"{self.sensor:g} V/cm and α {'in ν' if self.alpha_on == 'virtual' else 'in volts'}"


_JOHANSSONS = VOLTS_PER_METRE / 100.0
_ALPHA_ON: tuple[AlphaOn, ...] = ("virtual", "input")
DECOUPLED_READINGS = tuple(
    DecoupledReading(sensor, alpha_on)
    for sensor in (_JOHANSSONS, 2.0 * _JOHANSSONS)
    for alpha_on in _ALPHA_ON
)


@cache
def decoupled(way: VirtualAntiWindup, reading: DecoupledReading = DECOUPLED_READINGS[0]) -> Filling:
    """Fill the tanks under (9) and one of the `WAYS` against windup, a lane for each limit.

    A sensor with twice the volts is a controller with twice the gain.

    Examples
    --------
    >>> run = decoupled("none")
    >>> round(run.overshoot(1)[at_limit(10.0)])
    20
    """
    return at_limits(way, Setting(reading.sensor / _JOHANSSONS), reading.alpha_on)


@cache
def at_limits(way: VirtualAntiWindup, setting: Setting, alpha_on: AlphaOn = "virtual") -> Filling:
    """Fill the tanks under (9) with a setting, a lane for each limit."""
    return filled_with(way, [setting] * len(LIMITS), LIMITS, alpha_on=alpha_on)


def shares_at_limit(new: Filling, old: Filling, least: float = SATURATED) -> np.ndarray:
    """Return the time at a limit as a share of the other's, where that is there so long [s]."""
    pairs = [(new.saturated(pump), old.saturated(pump)) for pump in (1, 2)]
    one, other = np.concatenate(pairs, axis=1)
    return np.asarray((one / np.maximum(other, least))[other >= least])


def at_limit(limit: float) -> int:
    """Return the lane of a limit of the pumps [V].

    Examples
    --------
    >>> at_limit(4.0), at_limit(10.0)
    (0, 12)
    """
    return int(np.argmin(np.abs(LIMITS - limit)))
