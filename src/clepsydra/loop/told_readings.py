"""What sensors with dead time and sampling tell, sample by sample outside of a program."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.signal import path
from clepsydra.loop.reported_readings import (
    ON_ITS_WAY,
    TOLD,
    WAIT,
    held_names,
    reported_samples,
    reporting_at,
    told_at,
)
from clepsydra.process.process import Process

Array = NDArray[np.float64]


class ToldReadings:
    """What lives of the sensors beside a process, as `clepsydra.loop.reported_readings` has it.

    Parameters
    ----------
    process : Process
    shown : ndarray [q]
        What the sensors show first.
    state : mapping, optional
        What is told and how long it waits, where they have not shown the same for ever.
    rings : mapping, optional
        Readings on their way, the oldest first [length].

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> sensors = ToldReadings(load_process("quadruple-tank"), np.zeros(4))
    >>> sensors.told(np.ones(4)), sensors.state
    (array([1., 1., 1., 1.]), {})
    """

    def __init__(
        self,
        process: Process,
        shown: Array,
        state: Mapping[str, float] | None = None,
        rings: Mapping[str, Array] | None = None,
    ) -> None:
        self._process = process
        self._names = [y.name for y in process.measurements]
        self._samples = reported_samples(process)
        at_first = dict(zip(self._names, shown.tolist(), strict=True))
        held = reporting_at(process, at_first)
        held |= {name: value for name, value in (state or {}).items() if name in held}
        self._held = {name: held[name] for name in held_names(process)}
        self._rings = {
            name: deque((rings or {}).get(name, np.full(samples.late, held[name])).tolist())
            for measurement, samples in self._samples.items()
            if (name := path(measurement, ON_ITS_WAY)) in held
        }

    def told(self, shown: Array) -> Array:
        """Return what is told in this sample of what is shown in it [q]."""
        return np.array(list(self._told(shown).values()))

    def _told(self, shown: Array) -> dict[str, float]:
        found = dict(zip(self._names, shown.tolist(), strict=True))
        oldest = {name: ring[0] for name, ring in self._rings.items()}
        return told_at(self._process, found, {**self._held, **oldest})

    def advance(self, shown: Array) -> None:
        """Go on to the next sample from one in which this was shown [q]."""
        told = self._told(shown)
        for name, samples in self._samples.items():
            if samples.late:
                ring = self._rings[path(name, ON_ITS_WAY)]
                ring.popleft()
                ring.append(float(shown[self._names.index(name)]))
            self._held[path(name, TOLD)] = told[name]
            if samples.every > 1:
                left = self._held[path(name, WAIT)] - 1.0
                self._held[path(name, WAIT)] = left if left > 0.0 else float(samples.every)

    @property
    def state(self) -> dict[str, float]:
        """What was told last, and how long it is to the next report, by name."""
        return dict(self._held)

    @property
    def rings(self) -> dict[str, Array]:
        """Readings on their way, the oldest first [length]."""
        return {name: np.array(ring) for name, ring in self._rings.items()}
