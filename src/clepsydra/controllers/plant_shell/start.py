"""How a scan begins: by a cold or a warm start, and with an acknowledgement."""

from __future__ import annotations

import casadi as ca

from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.plant_shell.ports import count
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: Scans are counted no further; single precision holds every whole number up to it.
_LARGEST_COUNT = 1e7


def _begun(symbols: Symbols) -> Equations:
    asked, last, pressed = symbols["start"], symbols["last_start"], symbols["acknowledge"]
    cold = ca.logic_and(asked == 2, last != 2)
    warm = ca.logic_and(asked == 1, last != 1)
    scans = ca.if_else(cold, 0, symbols["scans_since_start"])
    counted = ca.fmin(_LARGEST_COUNT - 1, ca.fmax(0, scans)) + 1
    held = ca.logic_and(symbols["last_acknowledge"], ca.logic_not(cold))
    return Equations(
        {
            "scans_since_start": ca.fmax(1, ca.fmin(symbols["longest_delay"], counted)),
            # As numbers of their own: what stands for no start is none.
            "last_start": ca.if_else(asked == 2, 2, ca.if_else(asked == 1, 1, 0)),
            "last_acknowledge": pressed,
        },
        {
            "cold": cold,
            "warm": warm,
            "anew": ca.logic_or(cold, warm),
            "first": scans < 1,
            "scans_before": scans,
            "acknowledged": ca.logic_and(pressed, ca.logic_not(held)),
        },
    )


WARM = truth("warm", "this scan is a warm start")
ANEW = truth("anew", "this scan is a start of either kind")
FIRST = truth("first", "nothing was remembered before this scan")
ACKNOWLEDGED = truth("acknowledged", "a fault is acknowledged in this scan")

#: How a scan begins. A start is asked for as by a button: where the input changes to 1 or 2. Held
#: for ever it acts once, so that sensors are judged and outputs move behind it; for that the last
#: input outlives a cold start. Nor does an acknowledgement act twice: held down, or stuck, it
#: would take back every later fault by itself.
START = Block(
    "start_command",
    (
        count(
            "start", 2.0,
            "0 runs on; where it changes to 1 a warm start with the state as it was kept, "
            "to 2 a cold start; held it acts once",
        ),
        truth(
            "acknowledge",
            "where it becomes true, takes back what a sensor fault latched, if its sensors are "
            "good",
        ),
        count("longest_delay", _LARGEST_COUNT, "scans until every delay is overwritten", low=1.0),
    ),
    (
        count(
            "scans_since_start", 1e9,
            "scans since the cold start, counted until every delay is overwritten",
        ),
        count("last_start", 2.0, "start in the last scan, so that held it acts once"),
        truth("last_acknowledge", "acknowledge in the last scan, so that held it acts once"),
    ),
    (
        truth("cold", "this scan is a cold start: every state counts as its initial value"),
        WARM,
        ANEW,
        FIRST,
        count("scans_before", 1e9, "scans since the cold start, before this one"),
        ACKNOWLEDGED,
    ),
    _begun,
    ("Cold start, warm start and acknowledgement, each at the change of its input.",),
)  # fmt: skip
