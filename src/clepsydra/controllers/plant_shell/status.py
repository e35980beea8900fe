"""The status word of an output behind the plant shell: 16 bits, 15 of them in use."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.status import STATUS_BITS, StatusBit, status_word
from clepsydra.controllers.plant_shell.ports import count
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations

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
_LARGEST_WORD = float(sum(bit.value for bit in SHELL_STATUS_BITS.values()))


def status_signal(signal: Signal) -> Signal:
    """Return the status of an output as the shell gives it.

    Examples
    --------
    >>> status_signal(Signal("status_1", kind="integer")).high
    32767.0
    """
    bits = ", ".join(
        f"{bit.value} {name.replace('_', ' ')}" for name, bit in SHELL_STATUS_BITS.items()
    )
    return replace(
        signal, low=0.0, high=_LARGEST_WORD, kind="integer", description=f"sum of {bits}"
    )


def bit_of(word: ca.SX, name: str) -> ca.SX:
    """Return whether a bit of a law's own status word is set.

    Examples
    --------
    >>> [bool(ca.evalf(bit_of(ca.SX(41), name))) for name in ("at_high_limit", "sensor_fault")]
    [True, False]
    """
    value = float(STATUS_BITS[name].value)
    return ca.floor(word / value) - 2.0 * ca.floor(word / (2.0 * value)) == 1.0


#: The status word of an output, from its conditions.
STATUS_WORD = Block(
    "plant_status",
    tuple(truth(name, bit.meaning) for name, bit in SHELL_STATUS_BITS.items()),
    (),
    (count("status", _LARGEST_WORD, "the sum of the bits whose condition holds"),),
    lambda symbols: Equations({}, {"status": status_word(symbols, SHELL_STATUS_BITS)}),
    ("The status word of an output: one bit a condition.",),
)


def read_status(word: int) -> tuple[str, ...]:
    """Return the names of the bits that are set.

    Examples
    --------
    >>> read_status(1041)
    ('automatic', 'sensor_fault', 'failed_safe')
    """
    return tuple(name for name, bit in SHELL_STATUS_BITS.items() if word & bit.value)
