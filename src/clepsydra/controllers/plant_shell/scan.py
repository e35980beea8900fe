"""One scan of the shell while it is written: how it begins, and whether it comes in time."""

from __future__ import annotations

from functools import cache

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import LARGEST_COUNT, is_time_step
from clepsydra.controllers.signals import SHORTEST_TIME, TIME_STEP, amount
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: The largest signed whole number of 16 bits; 0 comes next.
_LARGEST_WATCHDOG = 32767.0


def count(name: str, high: float, description: str, *, low: float = 0.0) -> Signal:
    """Return a port that is a whole number."""
    return Signal(name, low=low, high=high, kind="integer", description=description)


_PERIOD = "time between two scans that the law was designed for"
SAMPLING_PERIOD = amount("sampling_period", "s", _PERIOD, low=SHORTEST_TIME)
_TOLERANCE = "share of the sampling period by which a scan may be early or late"
SCAN_TOLERANCE = Key("scan_tolerance", "1", _TOLERANCE, 0.0, 1.0)
_GAP = "sampling periods up to which the measured time between two scans counts"
LONGEST_GAP = Key("longest_gap", "1", _GAP, 1.0, 1e6)
#: What the shell asks for beside the inputs of the law, and tells beside its outputs.
ASKED = (
    count(
        "start", 2.0,
        "0 runs on; where it changes to 1 a warm start with the state as it was kept, "
        "to 2 a cold start; held it acts once",
    ),
    truth(
        "acknowledge",
        "its rising edge acknowledges latched faults whose cause has gone",
    ),
)  # fmt: skip
WATCHDOG = count("watchdog", _LARGEST_WATCHDOG, "counts the scans from 0 to 32767 and over again")
ELAPSED = Signal("elapsed", "s", description="time step that this scan counts for")
ANEW = truth("anew", "this scan is a start of either kind")
WARM = truth("warm", "this scan is a warm start, asked for or after a gap")
FIRST = truth("first", "first scan after a cold start, or of a new block")
ACKNOWLEDGED = truth("acknowledged", "a fault is acknowledged in this scan")
WITHOUT_STATE = truth("without_state", "a warm start finds no kept state")
UNTIMED = truth("untimed", "more scans than the longest gap came without a usable time step")
STEP_INVALID = truth("step_invalid", "the time step is not a number above zero")
SCAN_LOST = truth("scan_lost", "a scan came after more than the longest gap; not acknowledged")
STATE_LOST = truth("state_lost", "a warm start found no kept state; not acknowledged")


@cache
def scan_start(*, delays: bool) -> Block:
    """Return the block that tells how a scan begins, and whether it comes in time.

    A start is asked for as by a button: where the input changes to 1 or 2. Held for ever it acts
    once, so that sensors are judged and outputs move behind it; for that the last input outlives
    a cold start. Nor does an acknowledgement act twice: held down, or stuck, it would take back
    every later fault by itself.

    A scan later than the longest gap counts as one sampling period, and the law begins again as
    in a warm start. One without a time step counts as one sampling period, too. Scans of either
    kind are counted, and those in time counted back; beyond the longest gap the block knows no
    time, and its outputs fail safe.

    `delays`: whether the law remembers past values: then scans are counted until all are
    overwritten.
    """
    longest = count("longest_delay", LARGEST_COUNT, "scans until every delay is overwritten")
    before = count("scans_before", 1e9, "scans since the cold start, before this one")
    return Block(
        f"scan_start{'_with_delays' if delays else ''}",
        (
            *ASKED,
            TIME_STEP.port,
            SAMPLING_PERIOD.port,
            SCAN_TOLERANCE.port,
            LONGEST_GAP.port,
            *([longest] if delays else []),
        ),
        (
            count(
                "scans_since_start", 1e9,
                "scans since the cold start, counted until every delay is overwritten",
            ),
            count("last_start", 2.0, "start in the last scan, so that held it acts once"),
            truth("last_acknowledge", "acknowledge in the last scan, so that held it acts once"),
            count("scans_counted", _LARGEST_WATCHDOG, "value of the watchdog in the last scan"),
            count("gap_scans", LARGEST_COUNT, "scans without a usable time step, less those with"),
            truth("gap_seen", SCAN_LOST.description),
            truth("state_missed", STATE_LOST.description),
        ),
        (
            truth("cold", "this scan is a cold start: every state counts as its initial value"),
            WARM,
            ANEW,
            FIRST,
            ACKNOWLEDGED,
            ELAPSED,
            truth("time_off", "the time step differs from the sampling period by more than "
                  "its tolerance"),
            STEP_INVALID,
            UNTIMED,
            WITHOUT_STATE,
            SCAN_LOST,
            STATE_LOST,
            WATCHDOG,
            *([before] if delays else []),
        ),
        lambda s: _begun(s, delays=delays),
        (
            "Cold start, warm start and acknowledgement, each at the change of its input; whether "
            "the scans come in time, and how many have come.",
        ),
    )  # fmt: skip


def _begun(s: Symbols, *, delays: bool) -> Equations:
    asked, last, step, period = s["start"], s["last_start"], s["time_step"], s["sampling_period"]
    cold = ca.logic_and(asked == 2, last != 2)
    warm = ca.logic_and(asked == 1, last != 1)
    anew = ca.logic_or(cold, warm)
    scans = ca.if_else(cold, 0, s["scans_since_start"])
    held = ca.logic_and(s["last_acknowledge"], ca.logic_not(cold))
    acknowledged = ca.logic_and(s["acknowledge"], ca.logic_not(held))
    good, first = is_time_step(step), scans < 1
    off = ca.fabs(step - period) > s["scan_tolerance"] * period
    # A time step that is no number above zero has a bit of its own, and before the first scan
    # after a start nothing ran.
    off = ca.logic_and(ca.logic_and(good, off), ca.logic_not(anew))
    short = ca.logic_and(good, step <= s["longest_gap"] * period)
    begins = ca.logic_or(anew, first)
    late = ca.logic_and(ca.logic_and(good, ca.logic_not(short)), ca.logic_not(begins))
    without = ca.logic_and(warm, first)
    kept = ca.logic_not(ca.logic_or(cold, acknowledged))
    scan_lost = ca.logic_or(late, ca.logic_and(s["gap_seen"], kept))
    state_lost = ca.logic_or(without, ca.logic_and(s["state_missed"], kept))
    missed = ca.fmin(LARGEST_COUNT - 1, ca.fmax(0, ca.if_else(begins, 0, s["gap_scans"])))
    # Counted no further than it takes, so that it is counted back as soon.
    more = ca.if_else(missed > s["longest_gap"], missed, missed + 1)
    missed = ca.if_else(ca.logic_or(short, begins), ca.fmax(0, missed - 1), more)
    told = ca.if_else(cold, 0, s["scans_counted"])
    watchdog = ca.fmin(_LARGEST_WATCHDOG - 1, ca.fmax(0, told)) + 1
    watchdog = ca.if_else(told < _LARGEST_WATCHDOG, watchdog, 0)
    counted, before = ca.SX(1), {}
    if delays:
        counted = ca.fmin(LARGEST_COUNT - 1, ca.fmax(0, scans)) + 1
        counted, before = ca.fmax(1, ca.fmin(s["longest_delay"], counted)), {"scans_before": scans}
    return Equations(
        {
            "scans_since_start": counted,
            # What stands for no start is none.
            "last_start": ca.if_else(asked == 1, 1, 0) + ca.if_else(asked == 2, 2, 0),
            "last_acknowledge": s["acknowledge"],
            "scans_counted": watchdog,
            "gap_scans": missed,
            "gap_seen": scan_lost,
            "state_missed": state_lost,
        },
        {
            "cold": cold,
            "warm": ca.logic_or(warm, late),
            "anew": anew,
            "first": first,
            "acknowledged": acknowledged,
            "elapsed": ca.if_else(short, step, period),
            "time_off": off,
            "step_invalid": ca.logic_not(good),
            "untimed": missed > s["longest_gap"],
            "without_state": without,
            "scan_lost": scan_lost,
            "state_lost": state_lost,
            "watchdog": watchdog,
            **before,
        },
        {"step_good": good, "in_time": short, "late": late},
    )
