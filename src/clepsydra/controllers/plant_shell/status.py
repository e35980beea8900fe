"""An output in the plant shell: who moves it, what stands at the actuator, and its status word."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Literal

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.alarms.interlock import INTERLOCK
from clepsydra.controllers.blocks.ports import truth, words_for
from clepsydra.controllers.blocks.status import (
    STATUS_BITS,
    Mode,
    StatusBit,
    status_port,
    status_word,
)
from clepsydra.controllers.blocks.validity import limit
from clepsydra.controllers.plant_shell.scan import (
    ACKNOWLEDGED,
    ELAPSED,
    SCAN_LOST,
    STATE_LOST,
    STEP_INVALID,
    WARM,
    count,
)
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_LARGEST_COUNT = 1e6
_COUNTED = "scans to follow are counted no further"
_MOST_SCANS = Signal("most_scans", initial=_LARGEST_COUNT, kind="integer", description=_COUNTED)
_NO_MODE = float(max(Mode)) + 1.0
TAKE_UP_SCANS = Key(
    "take_up_scans", "1",
    "scans for which the law follows its last output after a warm start or a fault",
    1.0, _LARGEST_COUNT, kind="integer",
)  # fmt: skip
FAIL_SAFE = signals.signed("fail_safe", "{output}", "value of {output} after a sensor has failed")
_RATE = f"{{output}}: largest rate, {LARGEST_PARAMETER:g} for none"
RATE_LIMIT = signals.amount("rate_limit", "{output}/s", _RATE, LARGEST_PARAMETER)
#: Who limits the rate of an output.
Rate = Literal["shell", "law", "none"]

MODE = signals.MODE.port
LIMITS = (signals.LOW_LIMIT.port, signals.HIGH_LIMIT.port)
#: Between which values an output may stand: given to a law as its own limits, so that its
#: anti-windup heeds the rate limit.
REACH = (
    Signal("lowest", description="lowest value within reach"),
    Signal("highest", description="highest value within reach"),
)
TRACKED = Signal("tracked", description="value of the output where the law does not move it")
#: What the end of the output needs to know of it.
TOLD = (
    TRACKED,
    truth("latched", "a fault has outlasted its delay and was not acknowledged since"),
    truth("follows", "the law follows its last output, to go on from it in the next scan"),
    truth("waits", "a sensor fails, and the output is held until its delay is over"),
)
STATE = (
    truth("failed_safe", "a sensor failed and was not acknowledged"),
    count("scans_to_follow", _LARGEST_COUNT, "scans for which the law has yet to follow"),
)


@cache
def output_command(*, limited: bool, rate: Rate, interlocked: bool = False) -> Block:
    """Return the block that tells who moves an output.

    Where a needed sensor has failed, or the time is not known, the output goes to its fail-safe
    value, and stays there until good sensors are acknowledged, or the output is moved in manual
    while they are good; who acknowledges bad sensors has to do it again. That holds in a mode that
    is none, too. An operator who moves it in manual, or a controller that it tracks, always goes
    first.

    Coming back, and after a warm start, the law follows the last output for as many scans as it
    needs to take it up at the present measurements (`plant_shell.take_up`); scans without good
    sensors do not count.

    The rate counts where the controller moves the actuator, by the law or in manual: in tracking
    somebody else does, and a fail-safe value is not slowed. Limits win over the rate: an output
    beyond one is brought back at once.

    An alarm that holds the output moves it as tracking does, but nobody has looked: it clears no
    fault.

    `limited`: whether the law has limits of the output; `interlocked`: whether alarms may hold it.
    """
    name = {"shell": "", "law": "_of_own_rate", "none": "_without_rate"}[rate]
    used = Signal("rate_used", description="rate limit that the law gets; 1e9 for none")
    return Block(
        f"output_command{'' if limited else '_without_limits'}{name}"
        f"{'_with_interlock' if interlocked else ''}",
        (
            MODE,
            signals.TRACKING.port,
            truth("good", "all sensors that the output needs are good"),
            truth("failed", "one of them has failed, or the time is not known"),
            ACKNOWLEDGED,
            WARM,
            ELAPSED,
            TAKE_UP_SCANS.port,
            signals.LAST_OUTPUT.port,
            FAIL_SAFE.port,
            *(LIMITS if limited else ()),
            *(() if rate == "none" else (RATE_LIMIT.port,)),
            *((INTERLOCK,) if interlocked else ()),
        ),
        STATE,
        (
            count("mode_used", _NO_MODE, "the mode that the law gets", low=-1.0),
            truth("in_force", "automatic control of the output is in force"),
            truth("held", "a bad sensor holds the output"),
            *TOLD,
            *{"shell": REACH, "law": (used,), "none": ()}[rate],
        ),
        lambda s: _commanded(s, limited, rate),
        ("Who moves an output: mode, latched fail-safe, the return to automatic, and reach.",),
        (_MOST_SCANS,),
    )


def not_by_law(mode: ca.SX) -> ca.SX:
    """Return whether somebody else than the law moves the output."""
    return ca.logic_or(mode == Mode.MANUAL, mode == Mode.TRACKING)


def _commanded(s: Symbols, limited: bool, rate: Rate) -> Equations:
    mode, before, good = s["mode"], s["failed_safe"], s["good"]
    automatic, manual = mode == Mode.AUTOMATIC, not_by_law(mode)
    taken = ca.logic_and(manual, ca.logic_not(s["interlock"])) if "interlock" in s else manual
    cleared = ca.logic_and(good, ca.logic_or(s["acknowledged"], taken))
    latched = ca.logic_or(s["failed"], ca.logic_and(before, ca.logic_not(cleared)))
    safe = ca.logic_and(latched, ca.logic_not(manual))
    comes_back = ca.logic_and(before, ca.logic_not(latched))
    begins = ca.logic_or(s["warm"], comes_back)
    left = ca.if_else(begins, s["take_up_scans"], s["scans_to_follow"])
    # Numbers set at run time may be any; single precision holds these as well.
    left = ca.fmin(_LARGEST_COUNT, ca.fmax(0, left))
    follows = ca.logic_and(ca.logic_and(left > 0, automatic), ca.logic_not(safe))
    overridden = ca.logic_or(safe, follows)
    in_force = ca.logic_and(automatic, ca.logic_not(overridden))
    # One that is none stays none.
    bounded = ca.fmin(_NO_MODE, ca.fmax(-1, mode))
    following = ca.if_else(good, ca.fmax(0, left - 1), left)
    value, last = s["fail_safe"], s["last_output"]
    if limited:
        low, high = s["low_limit"], s["high_limit"]
        value = limit(value, low, high)
    followed = ca.if_else(follows, last, s["tracking"])
    reach, named = {}, {"manual_or_tracking": manual, "scans_left": left}
    named["law_overridden"] = overridden
    moves = ca.logic_not(ca.logic_or(safe, mode == Mode.TRACKING))
    if rate == "law":
        reach["rate_used"] = ca.if_else(moves, s["rate_limit"], LARGEST_PARAMETER)
    elif rate == "shell":
        change = s["rate_limit"] * s["elapsed"]
        acts = ca.logic_and(s["rate_limit"] < LARGEST_PARAMETER, moves)
        # The last output first in the comparison: what is not a number is passed over.
        reach["lowest"] = ca.if_else(acts, ca.fmin(high, ca.fmax(last - change, low)), low)
        reach["highest"] = ca.if_else(acts, ca.fmax(low, ca.fmin(last + change, high)), high)
        named |= {"largest_change": change, "rate_acts": acts}
    state = {"failed_safe": latched, "scans_to_follow": ca.if_else(latched, 0, following)}
    told = {
        "mode_used": ca.if_else(overridden, float(Mode.TRACKING), bounded),
        "in_force": in_force,
        "held": ca.logic_and(in_force, ca.logic_not(good)),
        "tracked": ca.if_else(safe, value, followed),
        "latched": latched,
        "follows": follows,
        "waits": ca.logic_not(ca.logic_or(good, latched)),
        **reach,
    }
    return Equations(state, told, named, words_for(_WORDS, state, told, named))


#: What a reader is told above the steps.
_WORDS = {
    "manual_or_tracking": "manual and tracking take precedence over the fail-safe value",
    "latched": "latch: a fault holds until good sensors are acknowledged, or moved in manual",
    "scans_left": "scans for which the law is still to follow",
    "follows": "before the law moves the output again, it follows the last output",
    "law_overridden": "the output of the law is not in force",
    "mode_used": "a law that is overridden tracks",
    "in_force": "automatic control of the output is in force",
    "held": "a fault is ridden through: the output is held",
    "tracked": "value of the output where the law does not move it",
    "rate_acts": "the rate limit acts in automatic and in manual",
    "lowest": "limits, narrowed by the rate limit",
    "scans_to_follow": "a scan counts where its sensors are good",
}

#: Name to bit. The first eight mean what they mean without the shell (`blocks.status`); the
#: limits are those of the actuator, also while a rate limit holds the output within tighter ones.
SHELL_STATUS_BITS: dict[str, StatusBit] = {
    **STATUS_BITS,
    "sensor_uncertain": StatusBit(
        256, "the current of a sensor is below 3.8 mA or above 20.5 mA, and no fault yet"
    ),
    "rides_through": StatusBit(
        512, "a sensor fails, and the output is held until its delay is over"
    ),
    "failed_safe": StatusBit(
        1024,
        "a sensor failed for longer than its delay, or the time step for more scans than the "
        "longest gap: but for manual and tracking the output stands at its fail-safe value until "
        "it is acknowledged with good sensors",
    ),
    "scan_time_off": StatusBit(
        2048, "the time step differs from the sampling period by more than its tolerance"
    ),
    "setpoint_ramps": StatusBit(4096, "a setpoint is on its ramp"),
    "following": StatusBit(
        8192,
        "after a warm start or a fault, in automatic: the law takes up its last output, and waits",
    ),
    "setpoint_limited": StatusBit(
        16384, "a setpoint lies outside its range and is held at the end of it"
    ),
    "scan_lost": StatusBit(
        32768,
        "a scan came after more than the longest gap: it counted as one sampling period, and the "
        "law began again as in a warm start; until it is acknowledged",
    ),
    "invalid_parameter": StatusBit(
        65536, "a parameter is not valid, and its last valid value is in force"
    ),
    "state_lost": StatusBit(
        131072,
        "a warm start found no kept state, and automatic began at the fail-safe value; until it is "
        "acknowledged",
    ),
}
#: Of an output that alarms may hold.
INTERLOCKED_BITS: dict[str, StatusBit] = {
    **SHELL_STATUS_BITS,
    "interlocked": StatusBit(
        262144,
        "an alarm holds the output at its interlock value, in every mode: it tracks that value",
    ),
}


def status_bits(*, interlocked: bool) -> dict[str, StatusBit]:
    """Return the bits of the status word of an output, which alarms may hold."""
    return INTERLOCKED_BITS if interlocked else SHELL_STATUS_BITS


def conditions(*, interlocked: bool) -> tuple[Signal, ...]:
    """Return the same as a structure of truth values."""
    record = "interlocked_output_conditions" if interlocked else "output_conditions"
    return tuple(
        replace(truth(path("conditions", name), bit.meaning), record=record)
        for name, bit in status_bits(interlocked=interlocked).items()
    )


#: Bits that only the law knows; of an output without limits also whether it stands at one.
OF_LAW = ("sensor_fault", "invalid_input")
OF_LIMITS = ("at_low_limit", "at_high_limit")


@cache
def output_end(told: tuple[str, ...], *, rated: bool, interlocked: bool = False) -> Block:
    """Return the block of what stands at the actuator.

    `told`: the bits that the law tells; without `OF_LIMITS` the output has limits; `rated`: whether
    the shell limits its rate; `interlocked`: whether alarms may hold it.
    """
    limited, slowed = "at_low_limit" not in told, "at_rate_limit" in told
    return Block(
        f"output_end{'' if limited else '_without_limits'}{'' if rated else '_without_rate'}"
        f"{'_of_own_rate' if slowed else ''}{'_with_interlock' if interlocked else ''}",
        (
            Signal("asked", description="demand of the law"),
            MODE,
            truth("time_off", SHELL_STATUS_BITS["scan_time_off"].meaning),
            STEP_INVALID,
            SCAN_LOST,
            STATE_LOST,
            truth("invalid_parameter", SHELL_STATUS_BITS["invalid_parameter"].meaning),
            *TOLD,
            *(LIMITS if limited else ()),
            *(REACH if rated else ()),
            *((INTERLOCK,) if interlocked else ()),
            truth("ramps", SHELL_STATUS_BITS["setpoint_ramps"].meaning),
            truth("limited", SHELL_STATUS_BITS["setpoint_limited"].meaning),
            *(truth(bit, STATUS_BITS[bit].meaning) for bit in told),
            truth("uncertain", SHELL_STATUS_BITS["sensor_uncertain"].meaning),
            truth("invalid", "a measurement or a setpoint that it needs is not a number"),
        ),
        (),
        (
            Signal("out", description="output to the actuator"),
            status_port(status_bits(interlocked=interlocked)),
            *conditions(interlocked=interlocked),
        ),
        lambda s: _ended(s, told, rated, interlocked),
        ("What stands at the actuator, and the status word: one bit a condition.",),
    )


def _ended(s: Symbols, told: tuple[str, ...], rated: bool, interlocked: bool) -> Equations:
    # But for manual and tracking it stands at its fail-safe value.
    safe = ca.logic_and(s["latched"], ca.logic_not(not_by_law(s["mode"])))
    out = ca.if_else(safe, s["tracked"], s["asked"])
    automatic, slowed = s["mode"] == Mode.AUTOMATIC, s.get("at_rate_limit", ca.SX(0))
    found = {
        "automatic": automatic,
        "tracking": s["mode"] == Mode.TRACKING,
        **{bit: s[bit] for bit in told},
        "invalid_input": ca.logic_or(s["invalid"], s["invalid_input"]),
        "invalid_time_step": s["step_invalid"],
        "sensor_uncertain": s["uncertain"],
        "rides_through": s["waits"],
        "failed_safe": s["latched"],
        "scan_time_off": s["time_off"],
        "following": s["follows"],
        "setpoint_limited": s["limited"],
        "scan_lost": s["scan_lost"],
        "state_lost": s["state_lost"],
        "invalid_parameter": s["invalid_parameter"],
    }
    if "low_limit" in s:
        at_low, at_high = out <= s["low_limit"], out >= s["high_limit"]
        found |= {"at_low_limit": at_low, "at_high_limit": at_high}
    if rated:
        # At a limit of the actuator it is that which holds it.
        inside = ca.logic_and(out > s["low_limit"], out < s["high_limit"])
        at_end = ca.logic_or(out <= s["lowest"], out >= s["highest"])
        slowed = ca.logic_or(slowed, ca.logic_and(inside, at_end))
    in_force = ca.logic_and(automatic, ca.logic_not(ca.logic_or(safe, s["follows"])))
    ramps = ca.logic_and(s["ramps"], in_force)
    if interlocked:
        found["interlocked"] = s["interlock"]
    found |= {"at_rate_limit": slowed, "setpoint_ramps": ramps}
    bits, shown = status_bits(interlocked=interlocked), conditions(interlocked=interlocked)
    results = {signal.name: found[signal.part] for signal in shown}
    results |= {"out": out, "status": status_word(found, bits)}
    return Equations({}, results, {"safe": safe})
