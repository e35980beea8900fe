"""Ratio control: one flow is kept in proportion to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.controllers.structure.block import Closed, Opened
from clepsydra.program.step_law import Symbols

#: A wild signal within this share of its range cannot be divided by.
_TOO_SMALL = 1e-3


@dataclass(frozen=True)
class RatioBlock:
    """What is asked for is a ratio times a wild signal, in units of both.

    Parameters
    ----------
    name : str
    number : int
        Last part of the names of its parameters.
    wild : Signal
        The process signal that nobody moves here.
    measured : int
        j of measurement_j, the wild signal.
    moved : Signal
        What follows it: an output, or another loop's setpoint.
    source : str or None
        The port of a loop that trims the ratio; without one the parameter ratio_k is it.

    Examples
    --------
    >>> block = RatioBlock("ratio", 1, Signal("feed", "l/s"), 2, Signal("acid", "l/s"), None)
    >>> [(p.name, p.unit) for p in block.parameters()]
    [('ratio_1', 'l/s/(l/s)')]
    """

    name: str
    number: int
    wild: Signal
    measured: int
    moved: Signal
    source: str | None

    @property
    def sources(self) -> tuple[str, ...]:
        """The loop that trims the ratio, if there is one."""
        return () if self.source is None else (self.source,)

    @property
    def ports(self) -> tuple[str, ...]:
        """The product."""
        return (self.name,)

    def parameters(self) -> list[Signal]:
        """The ratio, or the limits between which a loop may trim it."""
        unit = signals.ratio_of_units(self.moved.unit, self.wild.unit)
        what = f"{self.moved.name} to {self.wild.name}"
        if self.source is None:
            return [signals.gain(f"ratio_{self.number}", unit, 1.0, f"ratio of {what}")]
        return [
            signals.gain(f"{end}_ratio_{self.number}", unit, value, f"{end} ratio of {what}")
            for end, value in (("lowest", 0.0), ("highest", 10.0))
        ]

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
        """Those of the ratio."""
        if self.source is None:
            return ()
        ends = symbols[f"lowest_ratio_{self.number}"], symbols[f"highest_ratio_{self.number}"]
        return (Limits(*ends),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Multiply."""
        raw, sound = symbols[f"measurement_{self.measured}"], symbols[f"sensor_{self.measured}"]
        number = is_number(raw)
        wild = value_or_zero(raw, number)
        good = ca.logic_and(number, sound)
        if not asked:
            ratio = symbols[f"ratio_{self.number}"]
            product = Asked(ratio * wild, ca.logic_and(good, is_number(ratio)), number, sound)
            return Opened((product,), lambda applied: Closed({}))
        (source,) = asked
        (ends,) = self.limits(symbols, limits)
        ratio = ca.fmin(ends.high, ca.fmax(ends.low, source.value))
        product = Asked(
            ratio * wild,
            ca.logic_and(good, source.usable),
            ca.logic_and(number, source.numbers),
            ca.logic_and(sound, source.sensors),
        )
        span = self.wild.span
        smallest = _TOO_SMALL * span if ca.SX(span).is_regular() else 0.0
        divisible = ca.fabs(wild) > smallest

        def close(applied: Sequence[Applied]) -> Closed:
            (result,) = applied
            # What was applied as asked is told to the last bit: no rounding looks like a limit.
            quotient = result.value / ca.if_else(divisible, wild, 1)
            got = ca.if_else(result.value == product.value, ratio, quotient)
            known = ca.logic_and(divisible, good)
            told = Applied(
                ca.if_else(known, got, ratio),
                ca.logic_and(result.in_force, known),
                ca.logic_and(result.follows, known),
            )
            return Closed({}, {}, (told,))

        return Opened((product,), close)
