"""Alarms behind which nothing is left but a trip, and interlocks: who made them come is told."""

from __future__ import annotations

from collections.abc import Iterator

from clepsydra.base.remark import Remark
from clepsydra.base.words import listed, time_text
from clepsydra.loop.alarm_times import AlarmTimes, alarm_times
from clepsydra.loop.run import Run


def alarmed(run: Run) -> Iterator[Remark]:
    """Yield the high-high and low-low alarms of a run, and those that held an input.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> list(alarmed(cl.simulate(plant, cl.design.simc(plant))))
    []
    """
    for each in alarm_times(run):
        if each.count and (each.alarm.kind.outermost or each.alarm.interlock):
            held = listed([*each.alarm.interlock])
            means = f"meanwhile it holds {held}, and nothing is controlled by that" if held else ""
            yield Remark(came_words(each), means, "make the loop calmer there, or move the limit")


def came_words(times: AlarmTimes) -> str:
    """Return when an alarm came, how often, and for how long it was there."""
    often = "" if times.count == 1 else f", {times.count} times in all"
    ends = ", and stays" if times.stands else ""
    lasted = f", for {time_text(times.duration)}"
    words = f"{times.words[:1].upper()}{times.words[1:]}"
    return f"{words} comes at {time_text(times.came[0])}{often}{lasted}{ends}"
