"""Split range: one value moves several actuators, each over its part of the range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import APPLIED, Applied, Asked, Limits, instance, truth
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import limit
from clepsydra.controllers.signals import signed
from clepsydra.controllers.structure.block import Opened, PlainBlock
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class Leg:
    """One actuator of a split range and its part of the range.

    `owner`: what its parameters belong to; `moved`: what it moves; `start`, `end`: part of the
    splitter's range, in percent; `at_start`, `at_end`: values of what it moves there, in its unit.
    """

    owner: str
    moved: Signal
    start: float
    end: float
    at_start: float
    at_end: float

    def port(self, block: str) -> str:
        """The name under which the actuator takes its value."""
        return f"{block}, {self.moved.name}"

    def parameters(self) -> list[Signal]:
        """Part of the range, and the values at its ends."""
        return [key.of(self.owner, getattr(self, key.name), output=self.moved) for key in _PART]


@dataclass(frozen=True)
class SplitRangeBlock(PlainBlock):
    """One value from 0 to 100 % moves several actuators.

    `source`: the port that gives the value, in percent; `legs`: their parts of the range do not
    overlap.

    References
    ----------
    A. Reyes-Lúa, C. Zotică, T. Das, D. Krishnamoorthy and S. Skogestad, Changing between active
    constraint regions for optimal operation: classical advanced control versus model predictive
    control, Computer Aided Chemical Engineering, 2018, gives the use.
    """

    name: str
    source: str
    legs: tuple[Leg, ...]

    @property
    def sources(self) -> tuple[str, ...]:
        """What gives the value."""
        return (self.source,)

    @property
    def ports(self) -> tuple[str, ...]:
        """One for each actuator."""
        return tuple(leg.port(self.name) for leg in self.legs)

    def parameters(self) -> list[Signal]:
        """Those of all legs."""
        return [parameter for leg in self.legs for parameter in leg.parameters()]

    def limits(self, sample: Sample, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """From the start of the first part to the end of the last."""
        starts, ends = zip(
            *(sample.of(leg.owner, "start", "end") for leg in self.legs), strict=True
        )
        return (Limits(reduce(ca.fmin, starts), reduce(ca.fmax, ends)),)

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Split."""
        (source,) = asked
        names = [instance(leg.port(self.name)) for leg in self.legs]
        found = [
            sample.call(_SPLIT, name, leg.owner, asked=source.asked)
            for name, leg in zip(names, self.legs, strict=True)
        ]
        wishes = tuple(replace(source, asked=each["value"]) for each in found)
        ends = self.limits(sample, limits)[0]

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            in_force, follows = ca.SX(0), ca.SX(1)
            # What was asked, less what the actuators in automatic missed of it: beside one that
            # is moved in manual they go on as they are. Else where the last of them stands.
            reached, stands = limit(source.asked, ends.low, ends.high), ends.low
            for name, leg, each, result in zip(names, self.legs, found, applied, strict=True):
                in_force = ca.logic_or(in_force, result.in_force)
                follows = ca.logic_and(follows, ca.logic_or(result.follows, result.in_force))
                given = each | result.ports()
                told = sample.call(_UPDATE, path(name, "update"), leg.owner, **given)
                reached = reached + told["missed"]
                stands = ca.if_else(told["moves"], ca.fmax(stands, told["place"]), stands)
            value = ca.if_else(in_force, reached, stands)
            return (Applied(value, in_force, ca.logic_and(follows, ca.logic_not(in_force))),)

        return Opened(wishes, close)


_PART = (
    Key("start", "%", "start of the part of the range in which {output} moves", 0.0, 100.0),
    Key("end", "%", "end of the part of the range in which {output} moves", 0.0, 100.0),
    signed("at_start", "{output}", "{output} at the start of its part and before it"),
    signed("at_end", "{output}", "{output} at the end of its part and after it"),
)
_PORTS = tuple(key.port for key in _PART)


def _width(s: Symbols) -> ca.SX:
    return ca.fmax(0, s["end"] - s["start"])


def _split(s: Symbols) -> Equations:
    width = _width(s)
    wide = width > 0
    reach = (s["asked"] - s["start"]) / ca.if_else(wide, width, 1)
    share = limit(reach, ca.SX(0), ca.SX(1))
    value = s["at_start"] + (s["at_end"] - s["at_start"]) * share
    return Equations({}, {"share": share, "value": value})


def _updated(s: Symbols) -> Equations:
    width, stroke = _width(s), s["at_end"] - s["at_start"]
    moves = stroke != 0
    reach = (s["applied"] - s["at_start"]) / ca.if_else(moves, stroke, 1)
    got = ca.if_else(moves, limit(reach, ca.SX(0), ca.SX(1)), 0)
    missed = ca.logic_and(s["in_force"], s["applied"] != s["value"])
    return Equations(
        {},
        {
            "missed": ca.if_else(missed, width * (got - s["share"]), 0),
            "place": s["start"] + width * got,
            "moves": got > 0,
        },
    )


_FOUND = (
    Signal("share", description="share of its part that the demand asks for, 0 to 1"),
    Signal("value", description="demand to the actuator"),
)
_SPLIT = Block(
    "split_range_part",
    (Signal("asked", "%"), *_PORTS),
    (),
    _FOUND,
    _split,
    ("One actuator of a split range.",),
)
_UPDATE = Block(
    "split_range_part_update",
    (*APPLIED[:2], *_PORTS, *_FOUND),
    (),
    (
        Signal("missed", "%", description="part of the demand that is not met"),
        Signal("place", "%", description="where in the range the actuator stands"),
        truth("moves", "it stands within its part, or beyond it"),
    ),
    _updated,
    ("What became of one actuator of a split range.",),
)
