"""The alarms of runs as tables: how often, how long, when first."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.section import Line, Section, Table
from clepsydra.base.words import time_text
from clepsydra.loop.alarm_times import AlarmTimes, Recorded, alarm_times
from clepsydra.studies.result import Candidate

_HEAD = ("", "priority", "times", "in all", "first")


def alarms_of_run(run: Recorded) -> tuple[Line | Table, ...]:
    """Return the alarms that came in a run, and how many others there are; nothing without any.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> alarms_of_run(cl.simulate(plant, cl.design.simc(plant)))
    ()
    """
    found = alarm_times(run)
    came = [each for each in found if each.count]
    if not found:
        return ()
    if not came:
        return (Line(f"No alarm came, of {len(found)}."),)
    rest = len(found) - len(came)
    quiet = (Line(f"{rest} other{'s' if rest > 1 else ''} did not come."),) if rest else ()
    return (Table("Alarms", _HEAD, tuple(map(_row, came))), *quiet)


def alarm_words(run: Recorded) -> str:
    """Return which alarms came in a run in a sentence; nothing where the process has none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> alarm_words(cl.simulate(plant, cl.design.simc(plant)))
    ''
    """
    found = alarm_times(run)
    came = [each for each in found if each.count]
    if not found:
        return ""
    said = [
        f"{_short(each)} {'once' if each.count == 1 else f'{each.count} times'}, "
        f"{time_text(each.duration)} in all"
        for each in came
    ]
    return f"Alarms: {'; '.join(said)}." if said else "No alarm came."


def alarms_of_study(ranking: Sequence[Candidate]) -> Section | None:
    """Return how often and how long each alarm was there under each controller; None without any.

    A row is a controller, a column an alarm that came under some controller.
    """
    runs = [(each, alarm_times(each.run)) for each in ranking]
    if not runs or not runs[0][1]:
        return None
    came = [place for place in range(len(runs[0][1])) if any(t[place].count for _, t in runs)]
    if not came:
        return Section("Alarms", (Line("No alarm came under any controller."),))
    head = ("controller", *(_short(runs[0][1][place]) for place in came))
    rows = tuple(
        (each.controller.title, *(_cell(times[place]) for place in came)) for each, times in runs
    )
    told = Line("How often each alarm came, and for how long it was there in all, in brackets.")
    return Section("Alarms", (Table("", head, rows), told))


def _row(times: AlarmTimes) -> tuple[str, ...]:
    stands = ", stays" if times.stands else ""
    return (
        times.words,
        times.alarm.priority.words,
        str(times.count),
        f"{time_text(times.duration)}{stands}",
        time_text(times.came[0]),
    )


def _short(times: AlarmTimes) -> str:
    return f"{times.alarm.measurement} {times.alarm.kind.short}"


def _cell(times: AlarmTimes) -> str:
    return f"{times.count} ({time_text(times.duration)})" if times.count else "–"
