"""A PID loop that moves an output with nothing between, as one block."""

from __future__ import annotations

from functools import cache

from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_PORTS,
    RATE_LIMIT,
    asked_ports,
    output_element,
    output_results,
    told,
)
from clepsydra.controllers.blocks.handover import Applied
from clepsydra.controllers.blocks.ports import as_parts, called, parts_of, port
from clepsydra.controllers.structure.block import Closed
from clepsydra.controllers.structure.loop_phases import loop_ports
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


def is_plain(loop: PidBlock, output: OutputBlock) -> bool:
    """Return whether a loop moves an output, the operator its setpoint, and nothing is between.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> loop = PidBlock("loop", "level", PidForm(), level, pump, "level.sp")
    >>> is_plain(loop, OutputBlock(pump, "loop")), is_plain(loop, OutputBlock(pump, "sum"))
    (True, False)
    """
    return output.source == loop.name and loop.direct and not loop.inner


def closed(symbols: Symbols, instance: str, loop: PidBlock, output: OutputBlock) -> Closed:
    """Return a loop and its output in a law: an instance of `plain_loop`.

    Parameters
    ----------
    symbols : mapping
        The law's signals by name.
    instance : str
    loop : PidBlock
    output : OutputBlock

    Examples
    --------
    See `structure.law.structure_law`.
    """
    block = plain_loop(loop.generic, output.rate_limited)
    entries = [*block.inputs, *block.state]
    given = {**parts_of(output.signal, symbols, entries), **loop.of_law(symbols)}
    found = called(block, instance, given)
    status, conditions = told(found.outputs, output.signal)
    following = {entry.name: found.next_state[entry.name] for entry in loop.own_state()}
    last = {"last_output": found.next_state["last_output"]}
    return Closed(
        {**as_parts(loop.owner, following), **as_parts(output.signal, last)},
        as_parts(output.signal, {"out": found.outputs["manipulated"], "status": status}),
        (),
        {**as_parts(loop.owner, found.intermediates), **conditions},
    )


@cache
def plain_loop(loop: PidBlock, rate_limited: bool = False) -> Block:
    """Return the block of a loop with its output.

    Parameters
    ----------
    loop : PidBlock
        A generic one.
    rate_limited : bool

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> block = plain_loop(PidBlock("loop", "level", PidForm(), level, pump, "level.sp").generic)
    >>> block.name, [entry.name for entry in block.state]
    ('pi', ['integral', 'last_proportional_gain', 'last_setpoint_weight', 'last_output'])
    """
    element = output_element(rate_limited)

    def equations(s: Symbols) -> Equations:
        own = {**s, "last_applied": s["last_output"]}
        wish, carried = loop.asks(own, None)
        given = {**own, **asked_ports(wish)}
        found = element("output_end", {p.name: given[p.name] for p in element.inputs}, {}).outputs
        manipulated = found["manipulated"]
        applied = Applied(manipulated, found["controls"], found["follows"])
        state, _ = loop.told({**own, **carried}, applied)
        results = {signal.name: found[signal.name] for signal in output_results(rate_limited)}
        return Equations({**state, "last_output": manipulated}, results, carried)

    return Block(
        f"rate_limited_{loop.form.block}" if rate_limited else loop.form.block,
        (
            *loop_ports(loop),
            *OUTPUT_PORTS,
            *([RATE_LIMIT] if rate_limited else []),
        ),
        (*map(port, loop.own_state()), LAST_OUTPUT),
        output_results(rate_limited),
        equations,
        (loop.form.words,),
    )
