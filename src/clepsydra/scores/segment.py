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
    """

    kind: SegmentKind
    signal: str
    start: float
    stop: float
    size: float
