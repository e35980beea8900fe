"""Ports of blocks: signals without the unit, the range and the owner of an instance."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.block import Block


def truth(name: str, description: str) -> Signal:
    """Return a port that is a truth value."""
    return Signal(name, low=0.0, high=1.0, kind="boolean", description=description)


PV = Signal("pv", description="the measurement, or the last good one")
GOOD = truth("good", "the measurement may be used")
SP = Signal("sp", description="the setpoint that the law gets")


def instance(name: str) -> str:
    """Return what the block of a part of a control scheme is called: a path."""
    return re.sub(r"\W+", ".", name)


def with_used_inputs(block: Block) -> Block:
    """Return a block without the inputs that nothing in it reads."""
    entries = [*block.state, *block.inputs]
    symbols = {entry.name: ca.SX.sym(entry.name) for entry in entries}
    found = block.equations(symbols)
    results = ca.vertcat(*found.next_state.values(), *found.outputs.values())
    used = {symbol.name() for symbol in ca.symvar(results)}
    unused = {signal.name: ca.SX(0) for signal in block.inputs if signal.name not in used}
    return replace(
        block,
        inputs=tuple(signal for signal in block.inputs if signal.name in used),
        equations=lambda s: block.equations({**unused, **s}),
    )


def words_for(words: Mapping[str, str], *computed: Mapping[str, ca.SX]) -> dict[str, str]:
    """Return those words that stand above a step of a block in one of its forms."""
    return {name: words[name] for values in computed for name in values if name in words}
