"""When an alarm comes and returns: on-delay, off-delay, and what it keeps of them."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import truth, words_for
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.controllers.signals import TIME_STEP, amount
from clepsydra.program.step_law import Equations, Symbols

#: A delay this share of a time step before its end is over.
_ROUNDING = 1e-4
ROUNDING = Signal("rounding", initial=_ROUNDING, description="tolerance of a delay, in time steps")
ON_DELAY = amount("on_delay", "s", "time for which the condition is there before the alarm comes")
OFF_DELAY = amount("off_delay", "s", "time for which it is gone before the alarm returns to normal")
DELAYS = (ON_DELAY.port, OFF_DELAY.port, TIME_STEP.port)
KEPT = (
    truth("was_active", "the alarm was there in the last scan"),
    truth("pending", "a delay runs"),
    Signal("pending_time", "s", description="for how long it has run"),
)
ACTIVE = truth("active", "the alarm is there")
WATCHED = truth("watched", "what the alarm looks at is known; else it stays as it is")

_WORDS = {
    "watched": "what is no number, or comes from a bad sensor, leaves everything as it is",
    "present": "the condition of the alarm, which a limit that is no number meets",
    "differs": "the condition has changed, and a delay runs before the alarm does",
    "switches": "a delay that is no number is over at once",
}


def timed(s: Symbols, present: ca.SX, known: ca.SX) -> Equations:
    """Return what an alarm tells and keeps.

    The alarm comes in the scan in which its condition has been there for the on-delay, without
    a gap, and returns to normal in the one in which it has been gone for the off-delay. Both
    count from the scan in which that is seen first, so without a delay it is that scan.

    `s`: the ports of the block; `present`: its condition, which holds where a limit is no number;
    `known`: whether the signals that it watches are known.

    Examples
    --------
    A delay of 2 s, at a scan a second, that has run for 1 s:

    >>> given = dict(on_delay=2, off_delay=0, time_step=1, was_active=0, pending=1, pending_time=1)
    >>> found = timed({name: ca.DM(v) for name, v in given.items()}, ca.DM(1), ca.DM(1))
    >>> bool(found.outputs["active"])
    True
    """
    active, step = s["was_active"], s["time_step"]
    usable = ca.logic_and(known, is_time_step(step))
    differs = ca.if_else(active, ca.logic_not(present), present)
    run = ca.if_else(s["pending"], s["pending_time"] + step, 0)
    delay = ca.if_else(active, s["off_delay"], s["on_delay"])
    runs_on = run < delay - _ROUNDING * step
    switches = ca.logic_and(usable, ca.logic_and(differs, ca.logic_not(runs_on)))
    waits = ca.logic_and(differs, runs_on)
    now = ca.if_else(switches, present, active)
    state = {
        "was_active": now,
        "pending": ca.if_else(usable, waits, s["pending"]),
        "pending_time": ca.if_else(usable, ca.if_else(waits, run, 0), s["pending_time"]),
    }
    told = {"active": now, "watched": usable}
    named = {"present": present, "differs": differs, "switches": switches}
    return Equations(state, told, named, words_for(_WORDS, told, named))
