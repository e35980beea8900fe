"""A stretch of a run in which one thing happens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

SegmentKind = Literal["setpoint", "load", "noise"]


@dataclass(frozen=True)
class Segment:
    """A stretch of a scenario in which one thing happens.

    Parameters
    ----------
    signal : str
        The controlled measurement or the disturbance that is stepped; empty for noise.
    start, stop : float
        [s]
    size : float
        Of the step, in the signal's unit.

    Examples
    --------
    >>> Segment("setpoint", "level_1", start=60.0, stop=660.0, size=1.0).kind
    'setpoint'
    """

    kind: SegmentKind
    signal: str
    start: float
    stop: float
    size: float
