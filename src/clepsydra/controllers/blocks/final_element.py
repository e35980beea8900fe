"""The end of every law: one manipulated variable with its mode, limits and status word."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.handover import Applied, Asked
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.ports import as_parts, called, parts_of, truth
from clepsydra.controllers.blocks.status import STATUS_WORD
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: What a law or a block has for every output, beside what it asks for.
OUTPUT_PORTS = (
    Signal("mode", low=0.0, high=2.0, kind="integer", description="0 manual, 1 automatic, "
           "2 tracking"),
    Signal("manual", description="value in manual, in the unit of the output"),
    Signal("tracking", description="value in tracking"),
    Signal("low_limit"),
    Signal("high_limit"),
    Signal("time_step", "s", description="time since the last sample"),
)  # fmt: skip
#: `Asked`, as ports.
ASKED = (
    Signal("asked", description="in automatic, in the unit of the output"),
    truth("usable", "what is asked for may be acted on"),
    truth("numbers", "the signals behind it are numbers"),
    truth("sensors", "their sensors are sound"),
)
RATE_LIMIT = Signal("rate_limit", description="largest rate of change, per second")
LAST_OUTPUT = Signal("last_output", description="output of the last sample")
#: What it tells of a sample: the conditions of the status word.
TOLD = STATUS_WORD.inputs


@dataclass(frozen=True)
class FinalElement:
    """An output after mode, limits and rate limit.

    Parameters
    ----------
    manipulated : casadi.SX
        Always a number within the limits.
    applied : Applied
        For what asked.
    status : casadi.SX
        The status word.
    named : dict
        told_BIT of the output, the conditions of the status word.

    Examples
    --------
    >>> element = FinalElement(ca.SX(10), Applied(ca.SX(10), ca.SX(1), ca.SX(0)), ca.SX(9), {})
    >>> float(ca.evalf(element.manipulated))
    10.0
    """

    manipulated: ca.SX
    applied: Applied
    status: ca.SX
    named: dict[str, ca.SX]


def final_element(
    symbols: Symbols, moved: Signal, asked: Asked, *, rate_limited: bool = False
) -> FinalElement:
    """Write one output of a law: an instance of `output_element` and its status word.

    Parameters
    ----------
    symbols : mapping
        The law's signals by name: last_output, mode, manual, tracking, low_limit, high_limit
        and rate_limit (where limited) of the process input, and time_step.
    moved : Signal
        The process input.
    asked : Asked
        In automatic.
    rate_limited : bool

    Examples
    --------
    A law asks for 12 where 10 is the limit: automatic (1) + high limit (8).

    >>> given = dict(last_output=0, mode=1, manual=0, tracking=0, low_limit=0, high_limit=10)
    >>> symbols = {f"pump.{name}": ca.DM(value) for name, value in given.items()}
    >>> true = ca.DM(1)
    >>> asked = Asked(ca.DM(12), true, true, true)
    >>> element = final_element(symbols | {"time_step": true}, Signal("pump"), asked)
    >>> float(element.manipulated), float(ca.evalf(element.status))
    (10.0, 9.0)
    """
    block = output_element(rate_limited)
    given = {**parts_of(moved, symbols, block.inputs), **asked_ports(asked)}
    found = called(block, path(moved, "output"), given).outputs
    manipulated = found["manipulated"]
    applied = Applied(manipulated, found["controls"], found["follows"])
    return FinalElement(manipulated, applied, *told(found, moved))


def told(found: Symbols, moved: Signal) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return the status word of an output, and its conditions told_BIT.

    Parameters
    ----------
    found : mapping
        The ports of `TOLD`; one that a block does not have does not hold.
    moved : Signal

    Examples
    --------
    >>> word, conditions = told({"told_tracking": ca.SX(1)}, Signal("pump"))
    >>> int(ca.evalf(word)), "pump.told_automatic" in conditions
    (2, True)
    """
    conditions = {signal.name: found.get(signal.name, ca.SX(0)) for signal in TOLD}
    word = STATUS_WORD(path(moved, "status_word"), conditions, {}).outputs["status"]
    return word, as_parts(moved, conditions)


def asked_ports(asked: Asked) -> Symbols:
    """Return what is asked for as ports of `output_element`.

    Examples
    --------
    >>> true = ca.SX(1)
    >>> list(asked_ports(Asked(ca.SX(3), true, true, true)))
    ['asked', 'usable', 'numbers', 'sensors']
    """
    values = asked.value, asked.usable, asked.numbers, asked.sensors
    return {signal.name: value for signal, value in zip(ASKED, values, strict=True)}


@cache
def output_element(rate_limited: bool = False) -> Block:
    """Return the block of one output: what is asked for in automatic, else what its mode says.

    In manual and tracking the output follows its value. Where an input that the mode uses is
    unusable, the output is held: a failed sensor holds automatic, but an operator can still
    move the output by hand. Limits hold in every mode, and so does the rate limit.

    It has no state: the last output is given to it, since a law reads it too.

    Parameters
    ----------
    rate_limited : bool

    Examples
    --------
    >>> output_element(True).name, [signal.name for signal in output_element().outputs][:3]
    ('rate_limited_output', ['controls', 'follows', 'manipulated'])
    """
    return Block(
        "rate_limited_output" if rate_limited else "output_element",
        (
            *ASKED,
            *OUTPUT_PORTS,
            *([RATE_LIMIT] if rate_limited else []),
            LAST_OUTPUT,
        ),
        (),
        (
            truth("controls", "what is asked for is in force"),
            truth("follows", "the output moves by hand or tracking"),
            *output_results(rate_limited),
        ),
        lambda s: _equations(s, rate_limited),
        (
            "Automatic takes what is asked for, manual and tracking their values, within the "
            "limits; what is unusable holds the output.",
        ),
    )


def output_results(rate_limited: bool = False) -> tuple[Signal, ...]:
    """Return what a block that ends in an output gives: what stands, and what it can tell of it.

    Examples
    --------
    >>> len(output_results(True)), len(output_results())
    (9, 8)
    """
    stands = Signal("manipulated", description="what stands at the actuator")
    return (stands, *(s for s in TOLD if rate_limited or s.name != "told_at_rate_limit"))


def _equations(s: Symbols, rate_limited: bool) -> Equations:
    last_output, low, high = s["last_output"], s["low_limit"], s["high_limit"]
    in_manual, in_automatic = s["mode"] == Mode.MANUAL, s["mode"] == Mode.AUTOMATIC
    in_tracking = s["mode"] == Mode.TRACKING
    time_step_good = is_time_step(s["time_step"])
    # The last test meets parameters that were changed to something unusable at run time.
    usable = ca.logic_and(ca.logic_and(s["usable"], time_step_good), is_number(s["asked"]))
    controls = ca.logic_and(in_automatic, usable)
    by_hand = ca.logic_and(in_manual, is_number(s["manual"]))
    tracks = ca.logic_and(in_tracking, is_number(s["tracking"]))
    follows = ca.logic_or(by_hand, tracks)

    wanted = ca.if_else(tracks, s["tracking"], last_output)
    wanted = ca.if_else(by_hand, s["manual"], wanted)
    wanted = ca.if_else(controls, s["asked"], wanted)
    manipulated = limit(wanted, low, high)
    conditions = {
        "automatic": in_automatic,
        "tracking": in_tracking,
        "sensor_fault": ca.logic_not(s["sensors"]),
        "invalid_input": ca.logic_or(
            ca.logic_not(s["numbers"]), ca.logic_not(ca.logic_or(in_automatic, follows))
        ),
        "invalid_time_step": ca.logic_not(time_step_good),
    }
    if rate_limited:
        step = s["rate_limit"] * ca.if_else(time_step_good, s["time_step"], 0)
        slowed = limit(manipulated, last_output - step, last_output + step)
        conditions["at_rate_limit"] = slowed != manipulated
        manipulated = limit(slowed, low, high)
    # A limit of minus infinity at run time is none that an actuator could be brought to.
    manipulated = ca.if_else(is_number(manipulated), manipulated, last_output)
    conditions |= {"at_low_limit": manipulated <= low, "at_high_limit": manipulated >= high}
    outputs = {"manipulated": manipulated, "controls": controls, "follows": follows}
    return Equations(
        {},
        outputs | {f"told_{name}": value for name, value in conditions.items()},
        {"by_hand": by_hand, "tracks": tracks, "wanted": wanted, "time_step_good": time_step_good},
    )
