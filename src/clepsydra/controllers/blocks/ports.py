"""Ports of blocks, and what one block hands to the next: what it asks, and what became of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import starmap
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.block import Block
from clepsydra.program.step_law import Symbols


def truth(name: str, description: str) -> Signal:
    """Return a port that is a truth value."""
    return Signal(name, low=0.0, high=1.0, kind="boolean", description=description)


def told(name: str, description: str) -> Signal:
    """Return a truth value that a block tells where somebody reads it."""
    return replace(truth(name, description), optional=True)


@dataclass(frozen=True)
class _Handed:
    """What one block hands to another, a value and conditions; each field is a port."""

    @classmethod
    def declared(cls) -> tuple[Signal, ...]:
        """Return the ports of a block that takes or gives it."""
        (value, words), *conditions = ((e.name, e.metadata["words"]) for e in fields(cls))
        return (Signal(value, description=words), *starmap(truth, conditions))

    @classmethod
    def read(cls, symbols: Symbols, prefix: str = "") -> Self:
        """Return what stands at the ports of a block, whose names may begin with a prefix."""
        return cls(*(symbols[prefix + entry.name] for entry in fields(cls)))

    def ports(self, prefix: str = "") -> dict[str, ca.SX]:
        """Return the values by the names of the ports."""
        return {prefix + entry.name: getattr(self, entry.name) for entry in fields(self)}


@dataclass(frozen=True)
class Asked(_Handed):
    """What a block asks of the next one; for the status word the signals behind it.

    `asked` is always a number where `usable` holds.
    """

    asked: ca.SX = field(metadata={"words": "demand in automatic, in the unit of the output"})
    usable: ca.SX = field(metadata={"words": "the demand is valid"})
    numbers: ca.SX = field(metadata={"words": "its signals are numbers"})
    sensors: ca.SX = field(metadata={"words": "its sensors are good"})


@dataclass(frozen=True)
class Applied(_Handed):
    """What became of it, told back (the back calculation of a fieldbus block).

    `in_force`: the way to the actuator is in automatic; `follows`: the block has to follow. Where
    neither holds, an unusable signal froze everything.
    """

    applied: ca.SX = field(metadata={"words": "the demand that would have given what was applied"})
    in_force: ca.SX = field(metadata={"words": "the demand is in force"})
    follows: ca.SX = field(
        metadata={"words": "manual or tracking: the actuator moves without the demand"}
    )


@dataclass(frozen=True)
class Limits:
    """Between which values the next block takes what is asked."""

    low: ca.SX
    high: ca.SX


ASKED, APPLIED = Asked.declared(), Applied.declared()


def prefixed(ports: Iterable[Signal], prefix: str) -> tuple[Signal, ...]:
    """Return ports of another block under names of their own."""
    return tuple(replace(port, name=prefix + port.name) for port in ports)


PV = Signal("pv", description="the measurement, or the last good one")
GOOD = truth("good", "the measurement may be used")
SP = Signal("sp", description="setpoint in use")


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
