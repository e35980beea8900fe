"""A stretch of a run in which one thing happens."""

from __future__ import annotations

from dataclasses import dataclass, field
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
        Of the step, in the signal's unit; of a profile, where it is farthest from before.
    over : float
        How long the signal takes to get to where it stays [s]; 0 for a step.
    """

    kind: SegmentKind
    signal: str
    start: float
    stop: float
    size: float
    over: float = field(default=0.0, repr=False)
