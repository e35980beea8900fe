"""A loop of a control scheme as two blocks on one state: it asks, and is told what was applied."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.final_element import ASKED, asked_ports
from clepsydra.controllers.blocks.handover import Applied, Asked
from clepsydra.controllers.blocks.integral import APPLIED, applied_ports
from clepsydra.controllers.blocks.ports import port, truth, with_used_inputs
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

if TYPE_CHECKING:
    from clepsydra.controllers.structure.pid_block import PidBlock

_TRUTHS = ("setpoint_is_number", "measurement_is_number", "signals_known", "setpoint_is_remote")


def loop_ports(loop: PidBlock) -> tuple[Signal, ...]:
    """Return what a loop computes with, but for its state and the time step.

    Examples
    --------
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> from clepsydra.controllers.structure.pid_block import PidBlock
    >>> loop = PidBlock("loop", "level", PidForm("P"), Signal("level"), Signal("pump"), "level.sp")
    >>> [signal.name for signal in loop_ports(loop)]
    ['setpoint', 'measurement', 'sensor', 'proportional_gain', 'setpoint_weight']
    """
    given = () if loop.sources else (Signal("setpoint", description="what it shall be"),)
    return (
        *given,
        Signal("measurement"),
        truth("sensor", "the sensor of the measurement is good"),
        *map(port, loop.own_inputs()),
        *map(port, loop.own_parameters()),
    )


@cache
def phases(loop: PidBlock) -> tuple[Block, Block]:
    """Return the block that asks, and the one that is told; the second has the state.

    Parameters
    ----------
    loop : PidBlock
        A generic one.

    Examples
    --------
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> from clepsydra.controllers.structure.pid_block import PidBlock
    >>> level, pump = Signal("level"), Signal("pump")
    >>> loop = PidBlock("loop", "level", PidForm(), level, pump, "level.sp", direct=False)
    >>> [block.name for block in phases(loop.generic)]
    ['pi_asks', 'pi_is_told']
    """
    state = tuple(map(port, loop.own_state()))
    outer = tuple(port_of(signal, "remote") for signal in ASKED) if loop.sources else ()
    last = (Signal("last_applied"),) if loop.direct else ()
    given = (*outer, *loop_ports(loop), Signal("time_step", "s"), *last)

    def asks(s: Symbols) -> Equations:
        remote = Asked(*(s[signal.name] for signal in outer)) if outer else None
        wish, carried = loop.asks(s, remote)
        return Equations({}, {**asked_ports(wish), **{n: carried[n] for n in needed}}, carried)

    def is_told(s: Symbols) -> Equations:
        applied = Applied(*(s[signal.name] for signal in APPLIED))
        following, got = loop.told(s, applied)
        outputs = {} if got is None else applied_ports(got)
        return Equations(following, {f"got_{name}": value for name, value in outputs.items()})

    symbols = {entry.name: ca.SX.sym(entry.name) for entry in (*given, *state)}
    needed: list[str] = []
    carried = asks(symbols).intermediates
    passed = tuple(truth(n, "") if n in _TRUTHS else Signal(n) for n in carried)
    ends = Signal("low_limit"), Signal("high_limit")
    words = (loop.form.words,)
    got = tuple(port_of(signal, "got") for signal in APPLIED) if loop.sources else ()
    name = f"{loop.form.block}{'_inner' if loop.sources else ''}{'_at_output' if last else ''}"
    telling = with_used_inputs(
        Block(f"{name}_is_told", (*APPLIED, *given, *passed, *ends), state, got, is_told, words)
    )
    needed += [signal.name for signal in passed if signal in telling.inputs]
    outputs = (*ASKED, *(signal for signal in passed if signal.name in needed))
    asking = with_used_inputs(Block(f"{name}_asks", (*given, *state), (), outputs, asks, words))
    return asking, telling


def port_of(signal: Signal, prefix: str) -> Signal:
    """Return a port of another block under a name of its own.

    Examples
    --------
    >>> port_of(truth("usable", "it may be acted on"), "remote").name
    'remote_usable'
    """
    return replace(signal, name=f"{prefix}_{signal.name}")
