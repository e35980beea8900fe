"""Fillings after decoupling with settings of ν other than Johansson's, a lane each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.papers.four_tank_variable_structure.rig import (
    SETTINGS,
    Filling,
    fill,
    in_nu,
    virtual_settings,
)


class Setting(NamedTuple):
    """What one lane has in place of Johansson's settings.

    With r = 1 the derivative of a decoupled level is ν, or what the pump leaves of it. An ideal
    derivative action Kd on the level therefore divides Kp and Ki by 1 + Kd, in (9) and at a limit
    alike, and α of (14) with K_1 as K_I stays what it is. And M = m y, P = p of (10) under PI of ν
    are the gain p Kp + m on the level and p Kp on the setpoint: a setpoint weight.

    Parameters
    ----------
    gain, time : float
        K and Ti in Johansson's.
    derivative : float
        Td in Ti, of an ideal derivative action on the level.
    weight : float
        Share of the setpoint in the proportional part.

    Examples
    --------
    >>> Setting(derivative=0.25).divisors().round(2).tolist()
    [1.94, 1.85]
    """

    gain: float = 1.0
    time: float = 1.0
    derivative: float = 0.0
    weight: float = 1.0

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
    """Fill the tanks under (9), a lane for each setting.

    Parameters
    ----------
    way : str
        One of the `WAYS` against windup.
    settings : sequence of Setting
    limits : float or ndarray [lanes]
        Upper limits of both pumps [V].
    rates : ndarray [lanes], optional
        α [1/s]; that of the document if left out.
    alpha_on : {"virtual", "input"}
        Whether α acts on ν or in volts.
    target : tuple of float, optional
        As of `fill`.

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
