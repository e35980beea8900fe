"""The alarms of a process, as the page of a laboratory lists them."""

from __future__ import annotations

from typing import Any

from clepsydra.process.alarm import LIMITS
from clepsydra.process.process import Process


def alarms_data(process: Process) -> list[dict[str, Any]]:
    """Return what an operator is told of each alarm beside its state; nothing without any.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from dataclasses import replace
    >>> from clepsydra.process.alarm import Alarm, AlarmKind
    >>> process = cl.load("quadruple-tank").process
    >>> high = Alarm("level_1", AlarmKind.HIGH, 8.0, interlock={"pump_1": 0.0})
    >>> (found,) = alarms_data(replace(process, alarms=(high,)))
    >>> found["short"], found["words"], found["priority"], found["holds"]
    ('H', 'high alarm of level_1 at 8 V', 'medium', {'pump_1': 0.0})
    """
    return [
        {
            "name": alarm.name,
            "measurement": alarm.measurement,
            "short": alarm.kind.short,
            "words": alarm.words(process.signal(alarm.measurement)),
            "priority": alarm.priority.words,
            "limit": alarm.limit if alarm.kind in LIMITS else None,
            "holds": dict(alarm.interlock),
            "latches": alarm.acknowledged,
        }
        for alarm in process.alarms
    ]
