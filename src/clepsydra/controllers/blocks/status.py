"""Who moves an output, and its status word: one bit a condition."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import told
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations


class Mode(IntEnum):
    """Who moves an output.

    MANUAL takes the manual value, AUTOMATIC the control law, TRACKING the tracking value
    (another controller or a local station has the actuator). Any other number holds the
    last output.
    """

    MANUAL = 0
    AUTOMATIC = 1
    TRACKING = 2


@dataclass(frozen=True)
class StatusBit:
    """One bit of the status word: its value and what it tells."""

    value: int
    meaning: str


#: Name to bit. The word is the sum of the bits whose condition holds; the first two tell the
#: mode that was asked for, the rest what happened in this sample.
STATUS_BITS: dict[str, StatusBit] = {
    "automatic": StatusBit(1, "the mode is automatic"),
    "tracking": StatusBit(2, "the mode is tracking"),
    "at_low_limit": StatusBit(4, "the output stands at its low limit"),
    "at_high_limit": StatusBit(8, "the output stands at its high limit"),
    "sensor_fault": StatusBit(16, "a sensor that the law needs reports a fault"),
    "invalid_input": StatusBit(
        32, "an input in use is not a number, or the mode is not manual, automatic or tracking"
    ),
    "invalid_time_step": StatusBit(64, "the time step is not a number above zero"),
    "at_rate_limit": StatusBit(128, "the output moves as fast as its rate limit allows"),
}


def status_port(bits: Mapping[str, StatusBit]) -> Signal:
    """Return a status word as a signal, with its bits in words."""
    shown = (f"{bit.value} {name.replace('_', ' ')}" for name, bit in bits.items())
    most = float(sum(bit.value for bit in bits.values()))
    words = f"sum of {', '.join(shown)}"
    return Signal("status", low=0.0, high=most, kind="integer", description=words)


def status_word(
    conditions: Mapping[str, ca.SX], bits: Mapping[str, StatusBit] = STATUS_BITS
) -> ca.SX:
    """Return the sum of the bits whose condition holds.

    `conditions`: every name of a bit to a truth value; `bits`: name to bit.

    Examples
    --------
    >>> held = {name: ca.DM(name in ("automatic", "sensor_fault")) for name in STATUS_BITS}
    >>> int(status_word(held))
    17
    """
    word = ca.SX(0)
    for name, bit in bits.items():
        word = word + ca.if_else(conditions[name], bit.value, 0)
    return word


#: The block that makes it of the conditions status_BIT.
STATUS_WORD = Block(
    "status_word",
    tuple(told(f"status_{name}", bit.meaning) for name, bit in STATUS_BITS.items()),
    (),
    (Signal("status", low=0.0, high=255.0, kind="integer", description="sum of the bits"),),
    lambda s: Equations({}, {"status": status_word({n: s[f"status_{n}"] for n in STATUS_BITS})}),
)


def read_status(word: int, bits: Mapping[str, StatusBit] = STATUS_BITS) -> tuple[str, ...]:
    """Return the names of the bits that are set."""
    return tuple(name for name, bit in bits.items() if word & bit.value)
