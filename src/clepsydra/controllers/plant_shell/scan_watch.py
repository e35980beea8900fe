"""The watch over the scans: whether they come in time, and a count that shows that they come."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.controllers.plant_shell.ports import count
from clepsydra.controllers.plant_shell.start import ANEW
from clepsydra.controllers.signals import LARGEST_PARAMETER, SHORTEST_TIME
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: The largest signed whole number of 16 bits; 0 comes next.
_LARGEST_COUNT = 32767.0


SAMPLING_PERIOD = Signal(
    "sampling_period",
    "s",
    low=SHORTEST_TIME,
    high=LARGEST_PARAMETER,
    initial=1.0,
    description="time between two scans that the law was designed for",
)
SCAN_TOLERANCE = Signal(
    "scan_tolerance", low=0.0, high=1.0,
    description="share of the sampling period by which a scan may be early or late",
)  # fmt: skip


def _watched(symbols: Symbols) -> Equations:
    step, period = symbols["time_step"], symbols["sampling_period"]
    good, before = is_time_step(step), symbols["scans_counted"]
    off = ca.fabs(step - period) > symbols["scan_tolerance"] * period
    following = ca.fmin(_LARGEST_COUNT - 1, ca.fmax(0, before)) + 1
    following = ca.if_else(before < _LARGEST_COUNT, following, 0)
    # A time step that is no number above zero has a bit of its own, and before the first scan
    # after a start nothing ran.
    off = ca.logic_and(ca.logic_and(good, off), ca.logic_not(symbols["anew"]))
    return Equations(
        {"scans_counted": following},
        {"step_good": good, "scan_time_off": off, "watchdog": following},
    )


TIME_STEP = Signal("time_step", "s", description="time since the last scan")
STEP_GOOD = truth("step_good", "the time step is a number above zero")

#: Judges the time since the last scan, and counts the scans.
SCAN_WATCH = Block(
    "scan_watch",
    (
        TIME_STEP,
        SAMPLING_PERIOD,
        SCAN_TOLERANCE,
        ANEW,
    ),
    (count("scans_counted", _LARGEST_COUNT, "value of the watchdog in the last scan"),),
    (
        STEP_GOOD,
        truth(
            "scan_time_off",
            "the time step differs from the sampling period by more than its tolerance",
        ),
        count("watchdog", _LARGEST_COUNT, "counts the scans from 0 to 32767 and over again"),
    ),
    _watched,
    ("Whether the scans come in time, and how many have come.",),
)
