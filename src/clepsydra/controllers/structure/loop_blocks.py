"""The blocks of a PID loop: whole with its output, or in two calls around other blocks."""

from __future__ import annotations

from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_WORDS,
    output_end,
    output_ports,
    output_results,
)
from clepsydra.controllers.blocks.handover import APPLIED, ASKED, Applied, Asked, prefixed
from clepsydra.controllers.blocks.ports import truth, with_used_inputs, words_for
from clepsydra.controllers.structure.pid_loop import PidLoop
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_TRUTHS = ("setpoint_is_number", "measurement_is_number", "signals_known", "setpoint_is_remote")


@cache
def loop_with_output(loop: PidLoop, rate_limited: bool = False) -> Block:
    """Return the block of a loop that moves an output with nothing between."""

    def equations(s: Symbols) -> Equations:
        own = {**s, "last_applied": s["last_output"]}
        wish, carried = loop.asks(own, None)
        applied, results, named = output_end(own, wish, rate_limited=rate_limited)
        state, _, wound = loop.told({**own, **carried}, applied)
        results |= loop.shows({**own, **carried}, applied)
        named = {**carried, **named, **wound}
        state["last_output"] = applied.applied
        words = words_for(loop.words | OUTPUT_WORDS, state, results, named)
        return Equations(state, results, named, words)

    return Block(
        f"rate_limited_{loop.form.block}" if rate_limited else loop.form.block,
        (*loop.ports, *output_ports(rate_limited)),
        (*loop.memory, LAST_OUTPUT),
        (*output_results(rate_limited), *loop.results),
        equations,
        (loop.form.words,),
    )


@cache
def loop_in_two_calls(loop: PidLoop) -> tuple[Block, Block]:
    """Return the block that asks, and the one that is told; the second has the state."""
    outer = prefixed(ASKED, "remote_") if loop.inner else ()
    last = (Signal("last_applied"),) if loop.direct else ()
    given = (*outer, *loop.ports, Signal("time_step", "s"), *last)

    def asks(s: Symbols) -> Equations:
        wish, carried = loop.asks(s, Asked.read(s, "remote_") if outer else None)
        outputs = {**wish.ports(), **{name: carried[name] for name in needed}}
        return Equations({}, outputs, carried, words_for(loop.words, carried))

    def is_told(s: Symbols) -> Equations:
        applied = Applied.read(s)
        following, got, named = loop.told(s, applied)
        outputs = loop.shows(s, applied) | ({} if got is None else got.ports("got_"))
        return Equations(following, outputs, named, words_for(loop.words, following, named))

    symbols = {entry.name: ca.SX.sym(entry.name) for entry in (*given, *loop.memory)}
    needed: list[str] = []
    carried = asks(symbols).intermediates
    passed = tuple(truth(n, "") if n in _TRUTHS else Signal(n) for n in carried)
    ends = Signal("low_limit"), Signal("high_limit")
    words = (loop.form.words,)
    told = (*(prefixed(APPLIED, "got_") if loop.inner else ()), *loop.results)
    name = f"{loop.form.block}{'_inner' if loop.inner else ''}{'_at_output' if last else ''}"
    ports = (*APPLIED, *given, *passed, *ends)
    telling = with_used_inputs(Block(f"{name}_is_told", ports, loop.memory, told, is_told, words))
    needed += [signal.name for signal in passed if signal in telling.inputs]
    outputs = (*ASKED, *(signal for signal in passed if signal.name in needed))
    asking = with_used_inputs(
        Block(f"{name}_asks", (*given, *loop.memory), (), outputs, asks, words)
    )
    return asking, telling
