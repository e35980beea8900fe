"""What happened in a run and when: the events of a process by time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.process.process import Process


@dataclass(frozen=True)
class Occurrence:
    """That an event happened.

    Parameters
    ----------
    time : float
        [s]; where it happened more than once within a sampling period, the last time.
    event : str
    words : str
    times : int
        How often within the sampling period.
    """

    time: float
    event: str
    words: str
    times: int


def events_of(process: Process, values: Mapping[str, np.ndarray]) -> tuple[Occurrence, ...]:
    """Return what happened in a run, in order of time.

    Parameters
    ----------
    process : Process
    values : mapping
        Trajectories by name, with the count and time of every event.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> events_of(load_process("quadruple-tank"), {})
    ()
    """
    found = []
    for event in process.motion.events:
        rises = np.diff(values[event.counted])
        for sample in np.flatnonzero(rises > 0):
            time = float(values[event.dated][sample + 1])
            found.append(Occurrence(time, event.name, event.words, int(rises[sample])))
    return tuple(sorted(found, key=lambda event: event.time))
