"""Fillings after decoupling by (9), as Figs. 3 to 6 are, over what is not printed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.papers.four_tank_variable_structure.readings import SATURATED
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
    IN_WORDS,
    SAMPLED,
    SETTINGS,
    VOLTS_PER_METRE,
    Filling,
    fill,
    in_nu,
    virtual_settings,
)

#: Of both pumps [V].
LIMITS = np.linspace(4.0, 20.0, 33)
#: What the rows on the decoupled tanks rest on.
READING = (
    "After decoupling by (9). What is not printed is ours: Johansson's tanks P− and PI controllers "
    f"({IN_WORDS}) times E for ν, 0.5 V/cm, a sample every {SAMPLED:g} s, pumps from 0 to 10 V, "
    f"α = {ALPHA:g} 1/s on ν with K_1 of (14) as K/Ti, from empty tanks and integrals at zero to "
    "12.4 and 12.7 cm."
)


class Setting(NamedTuple):
    """What one lane has in place of Johansson's settings.

    With r = 1 the derivative of a decoupled level is ν, or what the pump leaves of it. An ideal
    derivative action Kd on the level therefore divides Kp and Ki by 1 + Kd, in (9) and at a limit
    alike, and α of (14) with K_1 as K_I stays what it is. And M = m y, P = p of (10) under PI of ν
    are the gain p Kp + m on the level and p Kp on the setpoint: a setpoint weight.
    """

    gain: float = 1.0  # K in Johansson's
    time: float = 1.0  # Ti likewise
    derivative: float = 0.0  # Td in Ti, ideal and on the level
    weight: float = 1.0  # of the setpoint in the proportional part

    def divisors(self) -> np.ndarray:
        """1 + Kd of both levels, Kd = E K Td."""
        kds = [
            virtual.gain * self.gain * each.integral_time * self.time * self.derivative
            for virtual, each in zip(virtual_settings(), SETTINGS, strict=True)
        ]
        return 1.0 + np.array(kds)


def filled_with(
    way: VirtualAntiWindup,
    settings: Sequence[Setting],
    limits: float | np.ndarray = 10.0,
    rates: np.ndarray | None = None,
    alpha_on: AlphaOn = "virtual",
    **target: tuple[float, float],
) -> Filling:
    """Fill the tanks under (9), a lane for each setting, with rates α [1/s] and limits [V].

    Examples
    --------
    Twice the integral time makes the overshoot of which the document speaks:

    >>> run = filled_with("none", [Setting(), Setting(time=2.0)])
    >>> run.overshoot(1).round().tolist()
    [20.0, 11.0]
    """
    parameters, start = {}, {}
    divisors = np.array([each.divisors() for each in settings])
    gains, times, weights = (
        np.array([getattr(each, name) for each in settings]) for name in ("gain", "time", "weight")
    )
    for loop, virtual in enumerate(virtual_settings(), start=1):
        name, share = f"controller.level_{loop}", gains / divisors[:, loop - 1]
        parameters[f"{name}.virtual_gain"] = share * virtual.gain
        parameters[f"{name}.virtual_integral_gain"] = share / times * virtual.integral_gain
        parameters[f"{name}.setpoint_weight"] = weights
        start[f"{name}.last_virtual_gain"] = share * virtual.gain
        start[f"{name}.last_setpoint_weight"] = weights
        if rates is not None:
            parameters[f"{name}.saturation_rate"] = rates
    return fill(in_nu(way, alpha_on=alpha_on), limits, parameters=parameters, start=start, **target)


class DecoupledReading(NamedTuple):
    """One way to read what is not printed; ν rests at zero, so that it needs no bias."""

    sensor: float  # [V/cm]
    alpha_on: AlphaOn  # whether α acts on ν or in volts

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
    """Return the lane of a limit of the pumps [V]."""
    return int(np.argmin(np.abs(LIMITS - limit)))
