"""Ports of blocks, and what one block hands to the next: what it asks, and what became of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.block import Block
from clepsydra.program.step_law import Symbols


def truth(name: str, description: str) -> Signal:
    """Return a port that is a truth value."""
    return Signal(name, low=0.0, high=1.0, kind="boolean", description=description)


@dataclass(frozen=True)
class _Handed:
    """What one block hands to another; each field is a port."""

    @classmethod
    def read(cls, symbols: Symbols, prefix: str = "") -> Self:
        """Return what stands at the ports of a block, whose names may begin with a prefix."""
        return cls(*(symbols[prefix + entry.name] for entry in fields(cls)))

    def ports(self, prefix: str = "") -> dict[str, ca.SX]:
        """Return the values by the names of the ports."""
        return {prefix + entry.name: getattr(self, entry.name) for entry in fields(self)}


@dataclass(frozen=True)
class Asked(_Handed):
    """What a block asks of the next one.

    `asked`: always a number where `usable` holds; `usable`: whether it may be acted on in this
    sample; `numbers`, `sensors`: whether all signals behind it are numbers, and their sensors
    sound: for the status word.
    """

    asked: ca.SX
    usable: ca.SX
    numbers: ca.SX
    sensors: ca.SX


@dataclass(frozen=True)
class Applied(_Handed):
    """What became of it, told back (the back calculation of a fieldbus block).

    `applied`: what the block would have had to ask for to get what was applied; `in_force`: whether
    the block had its say: the way to the actuator is in automatic; `follows`: whether the actuator
    moves without it, in manual or in tracking, and it has to follow. Where neither holds, an
    unusable signal froze everything.
    """

    applied: ca.SX
    in_force: ca.SX
    follows: ca.SX


@dataclass(frozen=True)
class Limits:
    """Between which values the next block takes what is asked."""

    low: ca.SX
    high: ca.SX


#: The ports of `Asked` and of `Applied`.
ASKED = (
    Signal("asked", description="in automatic, in the unit of the output"),
    truth("usable", "what is asked for may be acted on"),
    truth("numbers", "the signals behind it are numbers"),
    truth("sensors", "their sensors are sound"),
)
APPLIED = (
    Signal("applied", description="what was applied, as if asked for"),
    truth("in_force", "what was asked for had its say"),
    truth("follows", "the actuator moves without it, in manual or in tracking"),
)


def prefixed(ports: Iterable[Signal], prefix: str) -> tuple[Signal, ...]:
    """Return ports of another block under names of their own."""
    return tuple(replace(port, name=prefix + port.name) for port in ports)


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
