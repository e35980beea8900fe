"""The output stage of a law with one integral for each output: anti-windup, mode, limits, hold."""

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
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_PORTS,
    OUTPUT_WORDS,
    give_output,
    output_end,
    output_results,
)
from clepsydra.controllers.blocks.ports import ASKED, Asked, words_for
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


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

    `sample`: of a law with integral, last_output, mode, manual, tracking, low_limit, high_limit and
    tracking_time (back-calculation) of the process input, and time_step; `moved`: the process
    input; `reading`: of the signals that it comes from; `proportional`: the part of the output that
    does not come from the integral, in its unit; `increment`: what the integral gains in this
    sample in automatic, in the unit of the output; `taken_up`: what the integral takes up of a
    change of gains, where the signals are valid.
    """
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

    The integral takes its increment under the anti-windup rule (`blocks.integral`). The other
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
            Signal("proportional", description="what does not come from the integral"),
            Signal("increment", description="what the integral gains in automatic"),
            *([Signal("taken_up", description="of a change of gains")] if takes_up else []),
            *ASKED[2:],
            *OUTPUT_PORTS,
            *([signals.TRACKING_TIME.port] if anti_windup == "back_calculation" else []),
        ),
        (signals.INTEGRAL.port, LAST_OUTPUT),
        output_results(),
        equations,
        ("The output is proportional + integral within its limits.",),
    )
