"""Alarms that stand at the operating point, and setpoints that lie beyond one that matters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.words import listed
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown
from clepsydra.loop.scenario import Scenario


def alarm_limit_words(point: OperatingPoint, scenario: Scenario) -> Iterator[Remark]:
    """Yield in sentences which alarm limits the scenario asks a measurement to pass.

    *At rest*: an alarm that is there when nothing happens tells an operator nothing (ISA-18.2 calls
    it stale). *Setpoints*: one at a high-high or low-low limit or beyond, or at that of an
    interlock, which then holds its inputs in the place of the controller.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.process.alarm import Alarm, AlarmKind
    >>> plant = cl.load("quadruple-tank")
    >>> high = Alarm("level_1", AlarmKind.HIGH, 6.0)
    >>> point = replace(plant.point, process=replace(plant.process, alarms=(high,)))
    >>> print(*alarm_limit_words(point, default_scenario(plant.linear)))
    At the operating point level_1 rests at 6.131 V, where the high alarm of level_1 at 6 V is \
there: it tells nobody anything; move its limit, or the operating point.
    """
    process, at = point.process, point.as_dict()
    for alarm in process.alarms:
        signal, name = process.signal(alarm.measurement), alarm.measurement
        words = alarm.words(signal)
        if alarm.met_by(at[name]):
            yield Remark(
                f"At the operating point {name} rests at {shown(signal, at[name])}, where the "
                f"{words} is there",
                "it tells nobody anything",
                "move its limit, or the operating point",
            )
        elif name in process.controlled and (alarm.kind.outermost or alarm.interlock):
            column = scenario.setpoints[:, process.controlled.index(name)]
            asked = [float(each) for each in np.unique(column) if alarm.met_by(float(each))]
            if asked:
                held = listed([*alarm.interlock])
                yield Remark(
                    f"The setpoint of {name} of {shown(signal, asked[0])} is where the {words} "
                    "comes",
                    f"it holds {held}, so that the setpoint is never held" if held else "",
                    "choose one before it, or move the limit",
                )
