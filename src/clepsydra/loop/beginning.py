"""What a scenario that begins away from its setpoints is judged by at first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clepsydra.loop.begin import Begin
from clepsydra.loop.scenario import Segment
from clepsydra.process.process import Process

#: Nearer to its setpoint than this share of its range a measurement begins at it.
_AT_SETPOINT = 1e-6


def segments_of_beginning(
    process: Process, readings: Mapping[str, float], setpoints: np.ndarray, stop: float
) -> list[Segment]:
    """Return a stretch for each measurement that begins away from its setpoint, all at once.

    Each is judged as a setpoint step from where the measurement stands.

    Parameters
    ----------
    readings : mapping
        Measurement to its value at the start [SI].
    setpoints : ndarray [controlled]
        At the start [SI].
    stop : float
        When the first step comes, or the end [s].

    Examples
    --------
    >>> import clepsydra as cl
    >>> process = cl.load("quadruple-tank").process
    >>> empty = {"level_1": 0.0, "level_2": 6.0}
    >>> segments_of_beginning(process, empty, np.array([6.0, 6.0]), 60.0)
    [Segment(kind='setpoint', signal='level_1', start=0.0, stop=60.0, size=6.0)]
    """
    found = []
    for name, setpoint in zip(process.controlled, setpoints, strict=True):
        away, signal = float(setpoint) - readings[name], process.signal(name)
        size = signal.span if np.isfinite(signal.span) else max(abs(float(setpoint)), 1.0)
        if abs(away) > _AT_SETPOINT * size:
            found.append(Segment("setpoint", name, 0.0, stop, away))
    return found


def with_beginning(
    process: Process, begin: Begin, setpoints: np.ndarray, steps: Sequence[Segment], stop: float
) -> list[Segment]:
    """Return the segments of steps, with the way from where it begins in place of those at first.

    Where every measurement begins at its setpoint the steps stay as they are.

    Parameters
    ----------
    setpoints : ndarray [controlled]
        At the start [SI].
    stop : float
        When the last segment ends [s].
    """
    later = [step for step in steps if step.start > 0.0]
    first = min((step.start for step in later), default=stop)
    own = segments_of_beginning(process, begin.measurements(process), setpoints, first)
    return [*own, *later] if own else [*steps]
