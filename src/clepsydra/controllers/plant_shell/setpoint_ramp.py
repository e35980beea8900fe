"""A setpoint that is always a number within its range and moves no faster than its ramp."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.ports import GOOD, PV, SP, truth
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.plant_shell.scan import ELAPSED, FIRST
from clepsydra.controllers.plant_shell.signal_check import RANGE
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

SETPOINT_RATE = Key(
    "setpoint_rate", "{measurement}/s", f"{{measurement}}: largest rate, {LARGEST_PARAMETER:g} for "
    "none", 0.0, LARGEST_PARAMETER, LARGEST_PARAMETER,
)  # fmt: skip


def _ramped(s: Symbols) -> Equations:
    raw, last, rate = s["asked"], s["ramped_setpoint"], s["setpoint_rate"]
    good, measured, in_force = s["good"], s["pv"], s["in_force"]
    number = is_number(raw)
    # A transmitter may be scaled the other way round.
    ends = s["range_low"], s["range_high"]
    bounded = limit(raw, ca.fmin(*ends), ca.fmax(*ends))
    begin = ca.if_else(good, measured, ca.if_else(number, bounded, last))
    before = ca.if_else(s["first"], begin, last)
    target = ca.if_else(number, bounded, before)
    way = rate * s["elapsed"]
    on_its_way = ca.if_else(s["held"], before, limit(target, before - way, before + way))
    on_its_way = ca.if_else(in_force, on_its_way, ca.if_else(good, measured, before))
    value = ca.if_else(rate < LARGEST_PARAMETER, on_its_way, target)
    return Equations(
        {"ramped_setpoint": value},
        {
            "sp": value,
            "invalid": ca.logic_not(number),
            "limited": ca.logic_and(number, bounded != raw),
            "ramps": ca.logic_and(in_force, value != target),
        },
        {
            "bounded": bounded,
            "before": before,
            "target": target,
            "way": way,
            "on_its_way": on_its_way,
        },
    )


#: The setpoint of a scan. One outside the range is held at the end of it: what it asks for cannot
#: be measured, and one scan of it would fill an integral. A setpoint that is not a number leaves
#: the last one. While no output that needs it is in automatic the ramp stands at the measurement,
#: and there it begins in the first scan. While a fault is ridden through it stands where it is:
#: the output is held, and would jump by what the ramp had gone meanwhile.
RAMP = Block(
    "setpoint_ramp",
    (
        Signal("asked", description="what is asked for, in the unit of the measurement"),
        *(key.port for key in RANGE),
        SETPOINT_RATE.port,
        ELAPSED,
        PV,
        GOOD,
        truth("in_force", "an output that needs the setpoint is in automatic"),
        truth("held", "a sensor is bad that such an output needs"),
        FIRST,
    ),
    (Signal("ramped_setpoint", description="the setpoint that was followed in the last scan"),),
    (
        SP,
        truth("invalid", "what is asked for is not a number"),
        truth("limited", "what is asked for is a number outside the range"),
        truth("ramps", "the setpoint is still on its way"),
    ),
    _ramped,
    ("A setpoint within its range: ramped in automatic, at the measurement otherwise.",),
)
