"""Limits of an output, and the tighter ones that a rate limit makes of them."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.plant_shell.scan_watch import STEP_GOOD, TIME_STEP
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


def _within_reach(symbols: Symbols) -> Equations:
    low, high = symbols["low_limit"], symbols["high_limit"]
    last, rate, safe = symbols["last_output"], symbols["rate_limit"], symbols["fail_safe"]
    way = rate * ca.if_else(symbols["step_good"], symbols["time_step"], 0)
    acts = ca.logic_and(rate < signals.LARGEST_PARAMETER, symbols["moves"])
    # The last output first in the comparison: what is not a number is passed over.
    lowest = ca.fmin(high, ca.fmax(last - way, low))
    highest = ca.fmax(low, ca.fmin(last + way, high))
    return Equations(
        {},
        {
            "low_used": ca.if_else(acts, lowest, low),
            "high_used": ca.if_else(acts, highest, high),
            "rate_acts": acts,
            "fail_safe_used": limit(ca.if_else(is_number(safe), safe, low), low, high),
        },
        {"way": way},
    )


#: Between which values an output may stand in a scan: given to a law as its own limits, so that
#: its anti-windup heeds the rate limit. Without a rate limit they are the very limits of the
#: output. Limits win over the rate: an output beyond one is brought back at once.
REACH = Block(
    "output_reach",
    (
        Signal("low_limit", description="low limit of the output"),
        Signal("high_limit", description="high limit of the output"),
        Signal(
            "rate_limit", description="largest rate, in the output's unit a second; 1e9 for none"
        ),
        Signal("last_output", description="the output of the last scan"),
        TIME_STEP,
        STEP_GOOD,
        truth("moves", "the rate counts: neither a fail-safe value is slowed nor somebody else"),
        Signal("fail_safe", description="value after a sensor has failed"),
    ),
    (),
    (
        Signal("low_used", description="lowest value within reach"),
        Signal("high_used", description="highest value within reach"),
        truth("rate_acts", "a rate limit is in force"),
        Signal("fail_safe_used", description="that value within the limits"),
    ),
    _within_reach,
    ("Limits of an output, narrowed by its rate limit.",),
)
