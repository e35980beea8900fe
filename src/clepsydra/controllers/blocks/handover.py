"""What a law asks of an output, and what it is told back about what was applied."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import truth
from clepsydra.program.step_law import Symbols


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

    Parameters
    ----------
    asked : casadi.SX
        Always a number where `usable` holds.
    usable : casadi.SX
        Whether it may be acted on in this sample.
    numbers, sensors : casadi.SX
        Whether all signals behind it are numbers, and their sensors sound: for the status word.
    """

    asked: ca.SX
    usable: ca.SX
    numbers: ca.SX
    sensors: ca.SX


@dataclass(frozen=True)
class Applied(_Handed):
    """What became of it, told back (the back calculation of a fieldbus block).

    Parameters
    ----------
    applied : casadi.SX
        What the block would have had to ask for to get what was applied.
    in_force : casadi.SX
        Whether the block had its say: the way to the actuator is in automatic.
    follows : casadi.SX
        Whether the actuator moves without it, in manual or in tracking, and it has to follow. Where
        neither holds, an unusable signal froze everything.
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
