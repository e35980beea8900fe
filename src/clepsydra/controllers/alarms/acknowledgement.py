"""The states of an alarm that an operator acknowledges."""

from __future__ import annotations

from enum import IntEnum

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.alarms.timing import ACTIVE
from clepsydra.controllers.blocks.ports import truth
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


class AlarmState(IntEnum):
    """States A to D of ISA-18.2, section 5.6: normal, and there or gone without or with an answer.

    Examples
    --------
    >>> AlarmState(3).name
    'RETURNED_UNACKNOWLEDGED'
    """

    NORMAL = 0
    UNACKNOWLEDGED = 1
    ACKNOWLEDGED = 2
    RETURNED_UNACKNOWLEDGED = 3


_WORDS = "0 normal, 1 unacknowledged, 2 acknowledged, 3 returned to normal unacknowledged"
STATE = Signal("state", low=0.0, high=3.0, kind="integer", description=_WORDS)
ACKNOWLEDGE = truth("acknowledge", "its rising edge acknowledges the alarms that are there")


def _acknowledged(s: Symbols) -> Equations:
    active = s["active"]
    comes = ca.logic_and(active, ca.logic_not(s["was_there"]))
    pressed = ca.logic_and(s["acknowledge"], ca.logic_not(s["last_acknowledge"]))
    # An alarm that comes while the button is pressed has not been seen.
    waits = ca.logic_or(comes, ca.logic_and(s["unacknowledged"], ca.logic_not(pressed)))
    there = ca.if_else(waits, AlarmState.UNACKNOWLEDGED, AlarmState.ACKNOWLEDGED)
    gone = ca.if_else(waits, AlarmState.RETURNED_UNACKNOWLEDGED, AlarmState.NORMAL)
    return Equations(
        {"unacknowledged": waits, "was_there": active, "last_acknowledge": s["acknowledge"]},
        {"state": ca.if_else(active, there, gone), "holds": ca.logic_or(active, waits)},
    )


#: The block that keeps whether an alarm has been acknowledged.
ACKNOWLEDGEMENT = Block(
    "alarm_acknowledgement",
    (ACTIVE, ACKNOWLEDGE),
    (
        truth("unacknowledged", "it has not been acknowledged since it came"),
        truth("was_there", "it was there in the last scan"),
        truth("last_acknowledge", "acknowledge in the last scan, so that held it acts once"),
    ),
    (STATE, truth("holds", "it is there, or has gone and was not acknowledged")),
    _acknowledged,
    ("State of an alarm that an operator acknowledges, as ISA-18.2 has it.",),
)
