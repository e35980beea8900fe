"""The end of every law: an output with its mode, limits and status word, and with an integral."""

from __future__ import annotations

from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import (
    WINDING_NAMES,
    AntiWindup,
    integral_words,
    next_integral,
)
from clepsydra.controllers.blocks.ports import ASKED, Applied, Asked, truth, words_for
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.status import STATUS_WORD, Mode
from clepsydra.controllers.blocks.validity import is_number, is_time_step, limit
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: What a law or a block has for every output, beside what it asks for.
OUTPUT_PORTS = tuple(
    key.port
    for key in (
        signals.MODE,
        signals.MANUAL,
        signals.TRACKING,
        signals.LOW_LIMIT,
        signals.HIGH_LIMIT,
        signals.TIME_STEP,
    )
)
RATE_LIMIT = Signal("rate_limit", description="largest rate of change, per second")
#: What a reader is told above the steps of an output.
OUTPUT_WORDS = {
    "controls": "automatic control is in force: valid signals and a valid time step",
    "manual_mode": "manual, with a valid manual value",
    "tracking_mode": "tracking, with a valid tracking value",
    "wanted": "value of the mode; with an invalid input the output is held",
    "manipulated": "limited output",
    "status_invalid_input": "for the status word",
}
LAST_OUTPUT = signals.LAST_OUTPUT.port


def final_element(
    sample: Sample, moved: Signal, asked: Asked, *, rate_limited: bool = False
) -> Applied:
    """Write one output of a law: an instance of `output_element` and its status word.

    `sample`: of a law that gets its last_output, low_limit, high_limit and rate_limit (where
    limited) by this; `moved`: the process input; `asked`: in automatic.

    Examples
    --------
    A law asks for 12 where 10 is the limit: automatic (1) + high limit (8).

    >>> given = dict(last_output=0, mode=1, manual=0, tracking=0, low_limit=0, high_limit=10)
    >>> symbols = {f"pump.{name}": ca.DM(value) for name, value in given.items()}
    >>> sample, true = Sample(symbols | {"time_step": ca.DM(1)}), ca.DM(1)
    >>> applied = final_element(sample, Signal("pump"), Asked(ca.DM(12), true, true, true))
    >>> float(applied.applied), float(ca.evalf(sample.outputs["pump.status"]))
    (10.0, 9.0)
    """
    declare_output(sample, moved, rate_limited=rate_limited)
    block = output_element(rate_limited)
    found = sample.call(block, path(moved, "output"), moved, **asked.ports())
    sample.next_state[path(moved, "last_output")] = found["manipulated"]
    give_output(sample, moved, found)
    return Applied(found["manipulated"], found["controls"], found["follows"])


def declare_output(sample: Sample, moved: Signal, *, rate_limited: bool = False) -> None:
    """Let a law have the limits and the last value of an output."""
    sample.parameters(*signals.limit_parameters(moved, rate_limited=rate_limited))
    sample.memory(signals.last_output(moved))


def give_output(sample: Sample, moved: Signal, found: Symbols) -> None:
    """Give an output and its status word, and name the conditions status_BIT.

    `found`: manipulated, and the conditions; one that a block does not have does not hold.
    """
    told = {signal.name: found.get(signal.name, ca.SX(0)) for signal in STATUS_WORD.inputs}
    word = STATUS_WORD(path(moved, "status_word"), told, {}).outputs["status"]
    sample.outputs[path(moved, "out")] = found["manipulated"]
    sample.outputs[path(moved, "status")] = word
    sample.name(moved, told)


@cache
def output_element(rate_limited: bool = False) -> Block:
    """Return the block of one output: what is asked for in automatic, else what its mode says.

    It has no state: the last output is given to it, since a law reads it too.
    """

    def equations(s: Symbols) -> Equations:
        applied, results, named = output_end(s, Asked.read(s), rate_limited=rate_limited)
        told = {"controls": applied.in_force, "follows": applied.follows} | results
        return Equations({}, told, named, words_for(OUTPUT_WORDS, told, named))

    return Block(
        "rate_limited_output" if rate_limited else "output_element",
        (*ASKED, *output_ports(rate_limited), LAST_OUTPUT),
        (),
        (
            truth("controls", "automatic control is in force"),
            truth("follows", "the output moves in manual or in tracking"),
            *output_results(rate_limited),
        ),
        equations,
        (
            "Automatic takes the demand, manual and tracking their values, within the limits; an "
            "invalid input holds the output.",
        ),
    )


def output_ports(rate_limited: bool = False) -> tuple[Signal, ...]:
    """Return what a block that ends in an output is given for it."""
    return (*OUTPUT_PORTS, RATE_LIMIT) if rate_limited else OUTPUT_PORTS


def output_results(rate_limited: bool = False) -> tuple[Signal, ...]:
    """Return what a block that ends in an output gives: what stands, and what it can tell of it."""
    stands = Signal("manipulated", description="output to the actuator")
    told = (s for s in STATUS_WORD.inputs if rate_limited or s.name != "status_at_rate_limit")
    return (stands, *told)


def output_end(
    s: Symbols, wish: Asked, *, rate_limited: bool = False
) -> tuple[Applied, dict[str, ca.SX], dict[str, ca.SX]]:
    """Return what became of what was asked of an output, its results, and names on the way.

    In manual and tracking the output follows its value. Where an input that the mode uses is
    unusable, the output is held: a failed sensor holds automatic, but an operator can still
    move the output in manual. Limits hold in every mode, and so does the rate limit.

    `s`: the ports of the output by name.
    """
    last_output, low, high = s["last_output"], s["low_limit"], s["high_limit"]
    in_manual, in_automatic = s["mode"] == Mode.MANUAL, s["mode"] == Mode.AUTOMATIC
    in_tracking = s["mode"] == Mode.TRACKING
    time_step_good = is_time_step(s["time_step"])
    # The last test meets parameters that were changed to something unusable at run time.
    usable = ca.logic_and(ca.logic_and(wish.usable, time_step_good), is_number(wish.asked))
    controls = ca.logic_and(in_automatic, usable)
    manual_mode = ca.logic_and(in_manual, is_number(s["manual"]))
    tracking_mode = ca.logic_and(in_tracking, is_number(s["tracking"]))
    follows = ca.logic_or(manual_mode, tracking_mode)

    wanted = ca.if_else(tracking_mode, s["tracking"], last_output)
    wanted = ca.if_else(manual_mode, s["manual"], wanted)
    wanted = ca.if_else(controls, wish.asked, wanted)
    manipulated = limit(wanted, low, high)
    conditions = {
        "automatic": in_automatic,
        "tracking": in_tracking,
        "sensor_fault": ca.logic_not(wish.sensors),
        "invalid_input": ca.logic_or(
            ca.logic_not(wish.numbers), ca.logic_not(ca.logic_or(in_automatic, follows))
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
    told = {f"status_{name}": value for name, value in conditions.items()}
    named = {
        "controls": controls,
        "manual_mode": manual_mode,
        "tracking_mode": tracking_mode,
        "wanted": wanted,
    }
    return (
        Applied(manipulated, controls, follows),
        {"manipulated": manipulated, **told},
        {**named, "time_step_good": time_step_good},
    )


def output_stage(
    sample: Sample,
    moved: Signal,
    reading: Reading,
    *,
    proportional: ca.SX,
    increment: ca.SX,
    anti_windup: AntiWindup,
    taken_up: ca.SX | None = None,
) -> ca.SX:
    """Write the output stage of one output, an instance of `output_stage_block`; return the output.

    `sample`: of a law that gets its integral, last_output, low_limit, high_limit and tracking_time
    (back-calculation) by this; `moved`: the process input; `reading`: of the signals that it comes
    from; `proportional`: the part of the output that does not come from the integral, in its unit;
    `increment`: what the integral gains in this sample in automatic, in the unit of the output;
    `taken_up`: what the integral takes up of a change of gains, where the signals are valid.
    """
    sample.memory(signals.INTEGRAL.of(moved, output=moved))
    declare_output(sample, moved)
    if anti_windup == "back_calculation":
        sample.parameters(signals.TRACKING_TIME.of(moved))
    given = {"proportional": proportional, "increment": increment}
    if taken_up is not None:
        given["taken_up"] = taken_up
    found = sample.call(
        output_stage_block(anti_windup, takes_up=taken_up is not None),
        path(moved, "stage"),
        moved,
        numbers=reading.numbers,
        sensors=reading.sensors,
        **given,
    )
    give_output(sample, moved, found)
    return found["manipulated"]


@cache
def output_stage_block(anti_windup: AntiWindup, *, takes_up: bool = False) -> Block:
    """Return the block of an output with an integral: proportional + integral in automatic.

    The integral takes its increment under the anti-windup rule (`blocks.anti_windup`). The other
    modes, limits and faults are those of every output (`blocks.final_element`).

    `takes_up`: whether it has the port taken_up.
    """

    def equations(s: Symbols) -> Equations:
        known = ca.logic_and(s["numbers"], s["sensors"])
        before = s["integral"]
        if takes_up:
            before = before + ca.if_else(known, s["taken_up"], 0)
        unlimited = s["proportional"] + before
        wish = Asked(unlimited, known, s["numbers"], s["sensors"])
        applied, results, named = output_end(s, wish)
        own = {**s, "integral_used": before}
        following, wound = next_integral(
            anti_windup, own, applied, known=known, last_applied=s["last_output"]
        )
        state = {"integral": following, "last_output": applied.applied}
        named |= {"signals_known": known, "unlimited": unlimited, **wound}
        words = words_for(OUTPUT_WORDS | integral_words(anti_windup), results, named)
        return Equations(state, results, named, words)

    return Block(
        f"output_integral_{WINDING_NAMES[anti_windup]}{'_taking_up' if takes_up else ''}",
        (
            Signal("proportional", description="proportional and derivative part"),
            Signal("increment", description="increment of the integral in automatic"),
            *(
                [Signal("taken_up", description="compensation of a change of gains")]
                if takes_up
                else []
            ),
            *ASKED[2:],
            *OUTPUT_PORTS,
            *([signals.TRACKING_TIME.port] if anti_windup == "back_calculation" else []),
        ),
        (signals.INTEGRAL.port, LAST_OUTPUT),
        output_results(),
        equations,
        ("The output is proportional + integral within its limits.",),
    )
