"""The settings of one PI controller."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class PiSettings(NamedTuple):
    """Gain [input unit / output unit] and integral time [s] of one PI controller.

    Examples
    --------
    >>> PiSettings(3.0, 30.0).integral_time
    30.0
    """

    gain: float
    integral_time: float


def slowed_down(settings: Sequence[PiSettings], factor: float) -> tuple[PiSettings, ...]:
    """Return the settings with K/F and F·Ti, Luyben's detuning.

    Examples
    --------
    >>> slowed_down([PiSettings(3.0, 30.0)], 2.0)
    (PiSettings(gain=1.5, integral_time=60.0),)
    """
    return tuple(PiSettings(each.gain / factor, each.integral_time * factor) for each in settings)
