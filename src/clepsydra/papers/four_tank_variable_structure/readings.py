"""Readings of a filling: sensor, bias of the controllers and limit of the pumps are not printed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.papers.four_tank_variable_structure.rig import (
    SETTINGS,
    VOLTS_PER_METRE,
    Filling,
    fill,
    in_volts,
)

#: Of Johansson's sensors, and of one that has twice as much [V/cm].
_SENSORS = (VOLTS_PER_METRE / 100.0, VOLTS_PER_METRE / 50.0)
#: Where the integrals start: at nothing, and near the voltage that holds the target [V].
_BIASES = (0.0, 3.0)
#: Upper limits of the pumps [V].
_LIMITS = (6.0, 10.0, 20.0)


class Reading(NamedTuple):
    """One way to read what is not printed."""

    sensor: float  # [V/cm]
    bias: float  # where the integrals start [V]
    limit: float  # of the pumps [V]

    def __str__(self) -> str:
        bias = f"{self.bias:g} V bias" if self.bias else "no bias"
        return f"{self.sensor:g} V/cm, {bias}, {self.limit:g} V"


READINGS = tuple(
    Reading(sensor, bias, limit) for sensor in _SENSORS for bias in _BIASES for limit in _LIMITS
)
#: Whose settings the decoupled loop has as well.
USUAL = Reading(_SENSORS[0], 0.0, 10.0)
#: The document's conventional PID has a limiter at its output and nothing against windup.
CONVENTIONAL = "none"
#: What a conventional controller stands at a limit at least where the pumps saturate [s].
SATURATED = 1.0


@cache
def filled(way: str) -> Filling:
    """Fill the tanks under one of the `WAYS` in volts, a lane for each of the `READINGS`."""
    return filled_in(way, READINGS)


def filled_in(
    way: str, readings: Sequence[Reading], process: Mapping[str, np.ndarray] | None = None
) -> Filling:
    """Fill the tanks in some readings, a lane each, with parameters of the process in each lane.

    A sensor with twice the volts is a controller with twice the gain.
    """
    parameters, start = dict(process or {}), {}
    for loop, settings in enumerate(SETTINGS, start=1):
        gains = np.array([settings.gain * each.sensor / _SENSORS[0] for each in readings])
        parameters[f"controller.level_{loop}.proportional_gain"] = gains
        start[f"controller.level_{loop}.last_proportional_gain"] = gains
        biases = np.array([each.bias for each in readings])
        owned = (f"level_{loop}.integral", f"pump_{loop}.last_output")
        start |= {f"controller.{name}": biases for name in owned}
    limits = np.array([each.limit for each in readings])
    return fill(in_volts(way), limits, parameters=parameters, start=start)


def saturating() -> list[int]:
    """Return the lanes of the readings in which a pump saturates, as the document's do."""
    old = filled(CONVENTIONAL)
    longest = np.maximum(old.saturated(1), old.saturated(2))
    return np.flatnonzero(longest >= SATURATED).tolist()


def both(run: Filling, what: str, form: str = ".1f", lane: int = 0) -> str:
    """Return a score of both lower levels in words."""
    return " and ".join(format(getattr(run, what)(tank)[lane], form) for tank in (1, 2))
