"""A loop in increments: polynomial control, with its output."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, elements
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_PORTS,
    asked_ports,
    output_element,
    output_results,
)
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.ports import called, truth
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@cache
def increments(measurement_gains: int, setpoint_gains: int, increment_gains: int) -> Block:
    """Return the block of a loop in increments.

    Parameters
    ----------
    measurement_gains, setpoint_gains, increment_gains : int
        The degrees of Q, R and P.

    Examples
    --------
    >>> block = increments(2, 0, 0)
    >>> block.name, [entry.name for entry in block.state]
    ('increments_2_0_0', ['past_value.1', 'past_value.2', 'last_output'])
    """
    counts = {"value": measurement_gains, "setpoint": setpoint_gains, "move": increment_gains}
    stems = dict(zip(("measurement", "setpoint", "increment"), counts.values(), strict=True))
    state = [
        Signal(name, description=f"{what}, {j} samples ago")
        for what, count in counts.items()
        for j, name in enumerate(elements(f"past_{what}", count), start=1)
    ]
    return Block(
        "_".join(["increments", *map(str, counts.values())]),
        (
            Signal("setpoint", description="what the value shall be"),
            Signal("value", description="the measurement, or a prediction of it"),
            truth("known", "the value is a number from a sound sensor"),
            truth("numbers", "value and setpoint are numbers"),
            truth("sensors", "the sensor is sound"),
            Signal("reference_gain"),
            *(Signal(name) for stem, n in stems.items() for name in elements(f"{stem}_gain", n)),
            *OUTPUT_PORTS,
        ),
        (*state, LAST_OUTPUT),
        output_results(),
        lambda s: _increments(s, counts),
        ("P u' = r0 w - Q y in the differences from one sample to the next.",),
    )


def _increments(s: Symbols, counts: dict[str, int]) -> Equations:
    past = {
        what: [s[name] for name in elements(f"past_{what}", count)]
        for what, count in counts.items()
    }
    increment = s["reference_gain"] * (s["setpoint"] - s["value"])
    for stem, what, sign in (
        ("measurement_gain", "value", -1.0),
        ("setpoint_gain", "setpoint", 1.0),
    ):
        gains = elements(stem, counts[what])
        for gain, new, old in zip(gains, [s[what], *past[what]], past[what], strict=False):
            part = s[gain] * (new - old)
            increment = increment + part if sign > 0.0 else increment - part
    for gain, move in zip(elements("increment_gain", counts["move"]), past["move"], strict=True):
        increment = increment - s[gain] * move
    known = ca.logic_and(s["numbers"], s["known"])
    asked = asked_ports(Asked(s["last_output"] + increment, known, s["numbers"], s["sensors"]))
    found = called(output_element(), "output", {**s, **asked}).outputs
    manipulated = found["manipulated"]
    # The sample counts where its signals were there and something was moved by them or by hand.
    acts = ca.logic_or(found["controls"], found["follows"])
    counts_now = ca.logic_and(ca.logic_and(known, is_time_step(s["time_step"])), acts)
    state = {"last_output": manipulated}
    for what, now, taken in (
        ("value", s["value"], counts_now),
        ("setpoint", s["setpoint"], counts_now),
        ("move", manipulated - s["last_output"], acts),
    ):
        state |= _shifted(f"past_{what}", now, past[what], taken)
    outputs = {signal.name: found[signal.name] for signal in output_results()}
    return Equations(state, outputs, {"increment": increment})


def _shifted(stem: str, now: ca.SX, past: Sequence[ca.SX], counts: ca.SX) -> dict[str, ca.SX]:
    """Return the memory one sample later, or as it is where the sample does not count."""
    return {
        name: ca.if_else(counts, new, old)
        for name, new, old in zip(elements(stem, len(past)), [now, *past], past, strict=False)
    }
