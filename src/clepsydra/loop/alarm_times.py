"""The alarms of a run: how often each came, when, and for how long it was there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.alarms.timing import ACTIVE

if TYPE_CHECKING:
    from clepsydra.process.alarm import Alarm
    from clepsydra.process.process import Process


class Recorded(Protocol):
    """What was recorded of a process, with a controller or on its own."""

    @property
    def process(self) -> Process:
        """With its alarms."""

    @property
    def time(self) -> np.ndarray:
        """When each sample begins [s]; there may be one more, at the end."""

    @property
    def samples(self) -> int:
        """How many sampling periods it lasts."""

    @property
    def values(self) -> dict[str, np.ndarray]:
        """Name to trajectory, those of the alarms among them [like `time`]."""


@dataclass(frozen=True)
class AlarmTimes:
    """When an alarm was there in a run.

    Parameters
    ----------
    alarm : Alarm
    words : str
        Its name with its limit.
    came, returned : tuple of float
        When it came, and when it returned to normal [s]; one that is there at the end has not.
    duration : float
        For how long it was there in all [s].

    Examples
    --------
    See `alarm_times`.
    """

    alarm: Alarm
    words: str
    came: tuple[float, ...]
    returned: tuple[float, ...]
    duration: float

    @property
    def count(self) -> int:
        """How often it came."""
        return len(self.came)

    @property
    def stands(self) -> bool:
        """Whether it is there at the end."""
        return len(self.returned) < len(self.came)

    def as_dict(self) -> dict[str, Any]:
        """Return it as values for JSON, in SI."""
        return {
            "measurement": self.alarm.measurement,
            "alarm": self.alarm.kind.key,
            "priority": self.alarm.priority.words,
            "limit": self.alarm.limit,
            "count": self.count,
            "duration": self.duration,
            "came": [*self.came],
            "returned": [*self.returned],
        }


def alarm_times(run: Recorded) -> tuple[AlarmTimes, ...]:
    """Return the alarms of a run in the order of the process file, those too that never came.

    Examples
    --------
    The level of the quadruple tank is above 6.5 V after a step to 7.1 V:

    >>> from clepsydra.process.alarm import Alarm
    >>> from dataclasses import replace
    >>> import clepsydra as cl
    >>> from clepsydra.process.alarm import AlarmKind
    >>> plant = cl.load("quadruple-tank")
    >>> high = Alarm("level_1", AlarmKind.HIGH, 6.5)
    >>> process = replace(plant.process, alarms=(high,))
    >>> run = cl.simulate(cl.Plant(process), cl.design.simc(plant))
    >>> (found,) = alarm_times(run)
    >>> found.words, found.count
    ('high alarm of level_1 at 6.5 V', 1)
    """
    return tuple(_times(run, alarm) for alarm in run.process.alarms)


def alarms_as_dict(run: Recorded) -> dict[str, Any]:
    """Return the alarms of a run as values for JSON, in SI; nothing where the process has none."""
    found = alarm_times(run)
    return {"alarms": [each.as_dict() for each in found]} if found else {}


def _times(run: Recorded, alarm: Alarm) -> AlarmTimes:
    active = run.values[path(alarm.name, ACTIVE.name)] > 0.0
    changes = np.diff(active.astype(int), prepend=0)
    return AlarmTimes(
        alarm,
        alarm.words(run.process.signal(alarm.measurement)),
        tuple(run.time[changes > 0].tolist()),
        tuple(run.time[changes < 0].tolist()),
        float(np.count_nonzero(active[: run.samples])) * run.process.sampling_period,
    )
