"""Fillings over what is not printed: settings, sensor, bias of the controllers, limit of the pumps.

A lane each, without decoupling in volts, and after decoupling by (9), as Figs. 3 to 6 are.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
    IN_WORDS,
    SAMPLED,
    SETTINGS,
    VOLTS_PER_METRE,
    Filling,
    fill,
    in_nu,
    in_volts,
    virtual_settings,
)

#: Of both pumps [V].
LIMITS = np.linspace(4.0, 20.0, 33)
#: The document's way against windup, and its conventional PID, which has a limiter alone.
COMPARED: tuple[VirtualAntiWindup, VirtualAntiWindup] = ("variable_structure", "none")
#: What a conventional controller stands at a limit at least where the pumps saturate [s].
SATURATED = 1.0
#: What the rows on the decoupled tanks rest on.
OTHERWISE = (
    "after decoupling by (9). What is not printed is ours: Johansson's tanks P− and PI controllers "
    f"({IN_WORDS}) times E for ν, 0.5 V/cm, a sample every {SAMPLED:g} s, pumps from 0 to 10 V, "
    f"α = {ALPHA:g} 1/s in ν with K_1 of (14) as the integral gain of ν, E K/Ti, from empty tanks "
    "and integrals at zero to 12.4 and 12.7 cm."
)
#: The same as sentences of their own.
READING = f"A{OTHERWISE[1:]}"
#: The parameter that α is of a law, and what that counts α in.
_RATES: dict[AlphaOn, tuple[str, float]] = {
    "virtual": ("saturation_rate", 1.0),
    "input": ("saturation_feedback", VOLTS_PER_METRE / 100.0),
}
#: The levels nearest to the rim that the pumps still hold, with room for a little overshoot [m].
HIGH = (0.185, 0.185)


class Setting(NamedTuple):
    """What one lane has in place of Johansson's settings.

    A sensor with twice the volts is a controller with twice the gain. With r = 1 the derivative
    of a decoupled level is ν, or what the pump leaves of it. An ideal derivative action Kd on the
    level therefore divides Kp and Ki by 1 + Kd, in (9) and at a limit alike, and α of (14) with
    K_1 as K_I stays what it is. And M = m y, P = p of (10) under PI of ν are the gain p Kp + m on
    the level and p Kp on the setpoint: a setpoint weight.
    """

    gain: float = 1.0  # K in Johansson's
    bias: float = 0.0  # where the integrals start without decoupling [V]
    limit: float = 10.0  # of the pumps [V]
    time: float = 1.0  # Ti in Johansson's, after decoupling
    derivative: float = 0.0  # Td in Ti, ideal and on the level, after decoupling
    weight: float = 1.0  # of the setpoint in the proportional part, after decoupling

    def __str__(self) -> str:
        return (
            f"{self.gain * VOLTS_PER_METRE / 100.0:g} V/cm, integrals from {self.bias:g} V and "
            f"pumps to {self.limit:g} V"
        )

    def divisors(self) -> np.ndarray:
        """1 + Kd of both levels, Kd = E K Td."""
        kds = [
            virtual.gain * self.gain * each.integral_time * self.time * self.derivative
            for virtual, each in zip(virtual_settings(), SETTINGS, strict=True)
        ]
        return 1.0 + np.array(kds)


USUAL = Setting()
#: Johansson's sensors and such with twice as much, integrals that start at nothing and near the
#: voltage that holds the target, and three limits of the pumps.
READINGS = tuple(Setting(*each) for each in product((1.0, 2.0), (0.0, 3.0), (6.0, 10.0, 20.0)))


@cache
def filled(way: str) -> Filling:
    """Fill the tanks under one of the `WAYS` in volts, a lane for each of the `READINGS`."""
    return filled_in(way, READINGS)


def filled_in(
    way: str, settings: Sequence[Setting], process: Mapping[str, np.ndarray] | None = None
) -> Filling:
    """Fill the tanks in volts, with parameters of the process in each lane."""
    parameters, start = dict(process or {}), {}
    gains, biases, limits = np.array([each[:3] for each in settings]).T
    for loop, johanssons in enumerate(SETTINGS, start=1):
        name = f"controller.level_{loop}"
        parameters[f"{name}.proportional_gain"] = johanssons.gain * gains
        start[f"{name}.last_proportional_gain"] = johanssons.gain * gains
        start |= {f"{name}.integral": biases, f"controller.pump_{loop}.last_output": biases}
    return fill(in_volts(way), limits, parameters=parameters, start=start)


def filled_with(
    way: VirtualAntiWindup,
    settings: Sequence[Setting],
    rates: np.ndarray | None = None,
    alpha_on: AlphaOn = "virtual",
    **target: tuple[float, float],
) -> Filling:
    """Fill the tanks under (9), with rates α [1/s], or in volts [cm/s² per volt].

    Examples
    --------
    Twice the integral time makes the overshoot of which the document speaks:

    >>> run = filled_with("none", [Setting(), Setting(time=2.0)])
    >>> run.overshoot(1).round().tolist()
    [20.0, 11.0]
    """
    parameters, start = {}, {}
    divisors = np.array([each.divisors() for each in settings])
    gains, _, limits, times, _, weights = np.array(settings).T
    for loop, virtual in enumerate(virtual_settings(), start=1):
        name, share = f"controller.level_{loop}", gains / divisors[:, loop - 1]
        parameters[f"{name}.virtual_gain"] = share * virtual.gain
        parameters[f"{name}.virtual_integral_gain"] = share / times * virtual.integral_gain
        parameters[f"{name}.setpoint_weight"] = weights
        start[f"{name}.last_virtual_gain"] = share * virtual.gain
        start[f"{name}.last_setpoint_weight"] = weights
        if rates is not None:
            rate, scale = _RATES[alpha_on]
            parameters[f"{name}.{rate}"] = scale * rates
    return fill(in_nu(way, alpha_on=alpha_on), limits, parameters=parameters, start=start, **target)


@cache
def decoupled(
    way: VirtualAntiWindup, setting: Setting = USUAL, alpha_on: AlphaOn = "virtual"
) -> Filling:
    """Fill the tanks under (9) with a setting, a lane for each limit."""
    lanes = [setting._replace(limit=limit) for limit in LIMITS]
    return filled_with(way, lanes, alpha_on=alpha_on)


def at_limit(limit: float) -> int:
    """Return the lane of a limit of the pumps [V]."""
    return int(np.argmin(np.abs(LIMITS - limit)))


def shares_at_limit(compared: Iterable[Filling], least: float = SATURATED) -> np.ndarray:
    """Return the time at a limit as a share of the other's, where that is there so long [s]."""
    one, other = (np.concatenate(list(map(run.saturated, (1, 2)))) for run in compared)
    return np.asarray((one / np.maximum(other, least))[other >= least])


def saturating() -> list[int]:
    """Return the lanes of the readings in which a pump saturates, as the document's do."""
    old = filled("none")
    longest = np.maximum(old.saturated(1), old.saturated(2))
    return np.flatnonzero(longest >= SATURATED).tolist()


#: The lane of pumps to 10 V.
LANE = at_limit(USUAL.limit)


def both(run: Filling, what: str, form: str = ".1f", lane: int = LANE) -> str:
    """Return a score of both lower levels in words."""
    return " and ".join(format(getattr(run, what)(tank)[lane], form) for tank in (1, 2))


def settled(runs: Iterable[Filling], band: float, lane: int = LANE) -> str:
    """Return in words when both lower levels are within a band, of one run against another."""
    return " against ".join(
        " and ".join(f"{run.settling(tank, band)[lane]:.0f}" for tank in (1, 2)) for run in runs
    )
