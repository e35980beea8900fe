"""Split range: one value moves several actuators, each over its part of the range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.structure.block import Closed, Opened
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Leg:
    """One actuator of a split range and its part of the range.

    Parameters
    ----------
    number : int
        Last part of the names of its parameters.
    moved : Signal
        What it moves.
    start, end : float
        Part of the splitter's range, in percent.
    at_start, at_end : float
        Values of what it moves there, in its unit.

    Examples
    --------
    >>> Leg(1, Signal("valve_1", "%"), 0.0, 50.0, 100.0, 0.0).port("split")
    'split, valve_1'
    """

    number: int
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
        name, number = self.moved.name, self.number
        return [
            Signal(f"split_start_{number}", "%", initial=self.start, low=0.0, high=100.0,
                   description=f"start of the part of the range in which {name} moves"),
            Signal(f"split_end_{number}", "%", initial=self.end, low=0.0, high=100.0,
                   description=f"end of the part of the range in which {name} moves"),
            signals.gain(f"split_at_start_{number}", self.moved.unit, self.at_start,
                         f"{name} at the start of its part and before it"),
            signals.gain(f"split_at_end_{number}", self.moved.unit, self.at_end,
                         f"{name} at the end of its part and after it"),
        ]  # fmt: skip


@dataclass(frozen=True)
class SplitRangeBlock:
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
    >>> inlet = Leg(1, Signal("inlet", "%"), 0, 50, 100, 0)
    >>> drain = Leg(2, Signal("drain", "%"), 50, 100, 0, 100)
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

    def state(self) -> list[Signal]:
        """None."""
        return []

    def inputs(self) -> list[Signal]:
        """None."""
        return []

    def outputs(self) -> list[Signal]:
        """None."""
        return []

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """From the start of the first part to the end of the last."""
        starts = [symbols[f"split_start_{leg.number}"] for leg in self.legs]
        ends = [symbols[f"split_end_{leg.number}"] for leg in self.legs]
        low, high = starts[0], ends[0]
        for start, end in zip(starts[1:], ends[1:], strict=True):
            low, high = ca.fmin(low, start), ca.fmax(high, end)
        return (Limits(low, high),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Split."""
        (source,) = asked
        parts = [_Part(symbols, leg) for leg in self.legs]
        shares = [part.share_of(source.value) for part in parts]
        values = [part.value_at(share) for part, share in zip(parts, shares, strict=True)]
        told = tuple(
            Asked(value, source.usable, source.numbers, source.sensors) for value in values
        )
        ends = self.limits(symbols, limits)[0]

        def close(applied: Sequence[Applied]) -> Closed:
            in_force, follows = ca.SX(0), ca.SX(1)
            # What was asked, less what the actuators in automatic missed of it: beside one that
            # is moved by hand they go on as they are. Else where the last of them stands.
            reached, stands = limit(source.value, ends.low, ends.high), ends.low
            for part, share, value, result in zip(parts, shares, values, applied, strict=True):
                in_force = ca.logic_or(in_force, result.in_force)
                follows = ca.logic_and(follows, ca.logic_or(result.follows, result.in_force))
                got = part.share_at(result.value)
                missed = ca.logic_and(result.in_force, result.value != value)
                reached = reached + ca.if_else(missed, part.width * (got - share), 0)
                place = part.start + part.width * got
                stands = ca.if_else(got > 0, ca.fmax(stands, place), stands)
            value = ca.if_else(in_force, reached, stands)
            result = Applied(value, in_force, ca.logic_and(follows, ca.logic_not(in_force)))
            return Closed({}, {}, (result,))

        return Opened(told, close)


class _Part:
    """The part of the range of one leg, and the way there and back."""

    def __init__(self, symbols: Symbols, leg: Leg) -> None:
        number = leg.number
        self.start = symbols[f"split_start_{number}"]
        self.width = ca.fmax(0, symbols[f"split_end_{number}"] - self.start)
        self.at_start = symbols[f"split_at_start_{number}"]
        self.stroke = symbols[f"split_at_end_{number}"] - self.at_start

    def share_of(self, value: ca.SX) -> ca.SX:
        """Return how far into this part a value is, from 0 to 1."""
        wide = self.width > 0
        return limit((value - self.start) / ca.if_else(wide, self.width, 1), ca.SX(0), ca.SX(1))

    def value_at(self, share: ca.SX) -> ca.SX:
        """Return the actuator's value there."""
        return self.at_start + self.stroke * share

    def share_at(self, value: ca.SX) -> ca.SX:
        """Return the share that an actuator's value stands for."""
        moves = self.stroke != 0
        share = (value - self.at_start) / ca.if_else(moves, self.stroke, 1)
        return ca.if_else(moves, limit(share, ca.SX(0), ca.SX(1)), 0)
