"""The end of an output: what stands at the actuator, and its status word of 15 bits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.status import (
    STATUS_BITS,
    Mode,
    StatusBit,
    status_port,
    status_word,
)
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.controllers.plant_shell.output_command import (
    LIMITS,
    MODE,
    REACH,
    TOLD,
    moved_by_hand,
)
from clepsydra.controllers.plant_shell.scan import ELAPSED
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

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
        "a sensor failed for longer than its delay: but for manual and tracking the output stands "
        "at its fail-safe value until it is acknowledged with good sensors",
    ),
    "scan_time_off": StatusBit(
        2048, "the time step differs from the sampling period by more than its tolerance"
    ),
    "setpoint_ramps": StatusBit(4096, "a setpoint is still on its way to what was asked for"),
    "following": StatusBit(
        8192,
        "after a warm start or a fault, in automatic: the law takes up its last output, and waits",
    ),
    "setpoint_limited": StatusBit(
        16384, "a setpoint lies outside its range and is held at the end of it"
    ),
}
#: The same as a structure of truth values.
CONDITIONS = tuple(
    replace(truth(path("conditions", name), bit.meaning), record="output_conditions")
    for name, bit in SHELL_STATUS_BITS.items()
)
#: The status of an output as the shell gives it.
STATUS = status_port(SHELL_STATUS_BITS)
#: Bits that only the law knows; of an output without limits also whether it stands at one.
OF_LAW = ("sensor_fault", "invalid_input")
OF_LIMITS = ("at_low_limit", "at_high_limit")


@cache
def output_end(told: tuple[str, ...], *, rated: bool) -> Block:
    """Return the block of what stands at the actuator.

    `told`: the bits that the law tells; without `OF_LIMITS` the output has limits; `rated`: whether
    the shell limits its rate.
    """
    limited, slowed = "at_low_limit" not in told, "at_rate_limit" in told
    return Block(
        f"output_end{'' if limited else '_without_limits'}{'' if rated else '_without_rate'}"
        f"{'_of_own_rate' if slowed else ''}",
        (
            Signal("asked", description="what the law asks for"),
            MODE,
            ELAPSED,
            truth("time_off", SHELL_STATUS_BITS["scan_time_off"].meaning),
            *TOLD,
            *(LIMITS if limited else ()),
            *(REACH if rated else ()),
            truth("ramps", SHELL_STATUS_BITS["setpoint_ramps"].meaning),
            truth("limited", SHELL_STATUS_BITS["setpoint_limited"].meaning),
            *(truth(bit, STATUS_BITS[bit].meaning) for bit in told),
            truth("uncertain", SHELL_STATUS_BITS["sensor_uncertain"].meaning),
            truth("invalid", "a measurement or a setpoint that it needs is not a number"),
        ),
        (),
        (Signal("out", description="what stands at the actuator"), STATUS, *CONDITIONS),
        lambda s: _ended(s, told, rated),
        ("What stands at the actuator, and the status word: one bit a condition.",),
    )


def _ended(s: Symbols, told: tuple[str, ...], rated: bool) -> Equations:
    # But for manual and tracking it stands at its fail-safe value.
    safe = ca.logic_and(s["latched"], ca.logic_not(moved_by_hand(s["mode"])))
    out = ca.if_else(ca.logic_and(safe, is_number(s["tracked"])), s["tracked"], s["asked"])
    automatic, slowed = s["mode"] == Mode.AUTOMATIC, s.get("at_rate_limit", ca.SX(0))
    conditions = {
        "automatic": automatic,
        "tracking": s["mode"] == Mode.TRACKING,
        **{bit: s[bit] for bit in told},
        "invalid_input": ca.logic_or(s["invalid"], s["invalid_input"]),
        "invalid_time_step": ca.logic_not(s["elapsed"] > 0),
        "sensor_uncertain": s["uncertain"],
        "rides_through": s["waits"],
        "failed_safe": s["latched"],
        "scan_time_off": s["time_off"],
        "following": s["follows"],
        "setpoint_limited": s["limited"],
    }
    if "low_limit" in s:
        at_low, at_high = out <= s["low_limit"], out >= s["high_limit"]
        conditions |= {"at_low_limit": at_low, "at_high_limit": at_high}
    if rated:
        # At a limit of the actuator it is that which holds it.
        inside = ca.logic_and(out > s["low_limit"], out < s["high_limit"])
        at_end = ca.logic_or(out <= s["lowest"], out >= s["highest"])
        slowed = ca.logic_or(slowed, ca.logic_and(inside, at_end))
    in_force = ca.logic_and(automatic, ca.logic_not(ca.logic_or(safe, s["follows"])))
    ramps = ca.logic_and(s["ramps"], in_force)
    conditions |= {"at_rate_limit": slowed, "setpoint_ramps": ramps}
    results = {signal.name: conditions[signal.part] for signal in CONDITIONS}
    results |= {"out": out, "status": status_word(conditions, SHELL_STATUS_BITS)}
    return Equations({}, results, {"safe": safe})
