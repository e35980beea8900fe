"""Split range: one value moves several actuators, each over its part of the range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal, owned, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.integral import APPLIED, applied_ports
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.ports import called, instance, parts_of, truth
from clepsydra.controllers.structure.block import Closed, Opened, WithoutSignals
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class Leg:
    """One actuator of a split range and its part of the range.

    Parameters
    ----------
    owner : str
        What its parameters belong to.
    moved : Signal
        What it moves.
    start, end : float
        Part of the splitter's range, in percent.
    at_start, at_end : float
        Values of what it moves there, in its unit.

    Examples
    --------
    >>> leg = Leg("split.valve_1", Signal("valve_1", "%"), 0.0, 50.0, 100.0, 0.0)
    >>> leg.port("split"), leg.parameters()[0].name
    ('split, valve_1', 'split.valve_1.start')
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
        name = self.moved.name
        found = [
            Signal("start", "%", initial=self.start, low=0.0, high=100.0,
                   description=f"start of the part of the range in which {name} moves"),
            Signal("end", "%", initial=self.end, low=0.0, high=100.0,
                   description=f"end of the part of the range in which {name} moves"),
            signals.gain("at_start", self.moved, self.at_start,
                         f"{name} at the start of its part and before it"),
            signals.gain("at_end", self.moved, self.at_end,
                         f"{name} at the end of its part and after it"),
        ]  # fmt: skip
        return owned(self.owner, found)

    def part(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return its parameters in a law, by the ports of a part."""
        return parts_of(self.owner, symbols, _PORTS)


@dataclass(frozen=True)
class SplitRangeBlock(WithoutSignals):
    """One value from 0 to 100 % moves several actuators.

    Parameters
    ----------
    name : str
    source : str
        The port that gives the value, in percent.
    legs : tuple of Leg
        Their parts of the range do not overlap.

    References
    ----------
    A. Reyes-Lúa, C. Zotică, T. Das, D. Krishnamoorthy and S. Skogestad, Changing between active
    constraint regions for optimal operation: classical advanced control versus model predictive
    control, Computer Aided Chemical Engineering, 2018, gives the use.

    Examples
    --------
    >>> inlet = Leg("split.inlet", Signal("inlet", "%"), 0, 50, 100, 0)
    >>> drain = Leg("split.drain", Signal("drain", "%"), 50, 100, 0, 100)
    >>> SplitRangeBlock("split", "level", (inlet, drain)).ports
    ('split, inlet', 'split, drain')
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

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """From the start of the first part to the end of the last."""
        parts = [leg.part(symbols) for leg in self.legs]
        low, high = parts[0]["start"], parts[0]["end"]
        for part in parts[1:]:
            low, high = ca.fmin(low, part["start"]), ca.fmax(high, part["end"])
        return (Limits(low, high),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Split."""
        (source,) = asked
        parts = [leg.part(symbols) for leg in self.legs]
        found = [
            called(_PART, instance(leg.port(self.name)), {**part, "asked": source.value}).outputs
            for leg, part in zip(self.legs, parts, strict=True)
        ]
        values = [each["value"] for each in found]
        told = tuple(
            Asked(value, source.usable, source.numbers, source.sensors) for value in values
        )
        ends = self.limits(symbols, limits)[0]

        def close(applied: Sequence[Applied]) -> Closed:
            in_force, follows = ca.SX(0), ca.SX(1)
            # What was asked, less what the actuators in automatic missed of it: beside one that
            # is moved by hand they go on as they are. Else where the last of them stands.
            reached, stands = limit(source.value, ends.low, ends.high), ends.low
            for leg, part, each, result in zip(self.legs, parts, found, applied, strict=True):
                in_force = ca.logic_or(in_force, result.in_force)
                follows = ca.logic_and(follows, ca.logic_or(result.follows, result.in_force))
                given = {**part, **each, **applied_ports(result)}
                name = path(instance(leg.port(self.name)), "is_told")
                told = called(_PART_IS_TOLD, name, given).outputs
                reached = reached + told["missed"]
                stands = ca.if_else(told["moves"], ca.fmax(stands, told["place"]), stands)
            value = ca.if_else(in_force, reached, stands)
            result = Applied(value, in_force, ca.logic_and(follows, ca.logic_not(in_force)))
            return Closed({}, {}, (result,))

        return Opened(told, close)


_PORTS = (
    Signal("start", "%", description="start of its part of the range"),
    Signal("end", "%", description="end of its part of the range"),
    Signal("at_start", description="the actuator there"),
    Signal("at_end"),
)


def _width(s: Symbols) -> ca.SX:
    return ca.fmax(0, s["end"] - s["start"])


def _part(s: Symbols) -> Equations:
    width = _width(s)
    wide = width > 0
    reach = (s["asked"] - s["start"]) / ca.if_else(wide, width, 1)
    share = limit(reach, ca.SX(0), ca.SX(1))
    value = s["at_start"] + (s["at_end"] - s["at_start"]) * share
    return Equations({}, {"share": share, "value": value})


def _part_is_told(s: Symbols) -> Equations:
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
    Signal("share", description="how far into its part what is asked for is, 0 to 1"),
    Signal("value", description="what the actuator is asked for"),
)
_PART = Block(
    "split_range_part",
    (Signal("asked", "%"), *_PORTS),
    (),
    _FOUND,
    _part,
    ("One actuator of a split range.",),
)
_PART_IS_TOLD = Block(
    "split_range_part_is_told",
    (*APPLIED[:2], *_PORTS, *_FOUND),
    (),
    (
        Signal("missed", "%", description="what is missing of what was asked for"),
        Signal("place", "%", description="where in the range the actuator stands"),
        truth("moves", "it stands within its part, or beyond it"),
    ),
    _part_is_told,
    ("What became of one actuator of a split range.",),
)
