"""Ratio control: one flow is kept in proportion to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, owned, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import ASKED, asked_ports
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.integral import APPLIED, applied_ports
from clepsydra.controllers.blocks.ports import called, instance, truth
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.controllers.structure.block import Closed, Opened, WithoutSignals
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: A wild signal within this share of its range cannot be divided by.
_TOO_SMALL = 1e-3


@dataclass(frozen=True)
class RatioBlock(WithoutSignals):
    """What is asked for is a ratio times a wild signal, in units of both.

    Parameters
    ----------
    name : str
    owner : str
        What its parameters belong to.
    wild : Signal
        The measurement that nobody moves here.
    moved : Signal
        What follows it: an output, or another loop's setpoint.
    source : str or None
        The port of a loop that trims the ratio; without one the parameter ratio is it.

    Examples
    --------
    >>> block = RatioBlock("ratio", "acid", Signal("feed", "l/s"), Signal("acid", "l/s"), None)
    >>> [(p.name, p.unit) for p in block.parameters()]
    [('acid.ratio', 'l/s/(l/s)')]
    """

    name: str
    owner: str
    wild: Signal
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
        unit = signals.per(self.moved, self.wild)
        what = f"{self.moved.name} to {self.wild.name}"
        if self.source is None:
            return owned(self.owner, [signals.gain("ratio", unit, 1.0, f"ratio of {what}")])
        ends = (("lowest", 0.0), ("highest", 10.0))
        return owned(
            self.owner,
            [
                signals.gain(f"{end}_ratio", unit, value, f"{end} ratio of {what}")
                for end, value in ends
            ],
        )

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those of the ratio."""
        if self.source is None:
            return ()
        ends = (symbols[path(self.owner, f"{end}_ratio")] for end in ("lowest", "highest"))
        return (Limits(*ends),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Multiply."""
        name, wild = instance(self.name), self.wild
        given = {"measurement": symbols[path(wild, "pv")], "sensor": symbols[path(wild, "good")]}
        for source, ends in zip(asked, self.limits(symbols, limits), strict=True):
            given |= {f"trim_{n}": value for n, value in asked_ports(source).items()}
            given |= {"lowest_ratio": ends.low, "highest_ratio": ends.high}
        if not asked:
            given["ratio"] = symbols[path(self.owner, "ratio")]
        first = called(_asks(bool(asked)), path(name, "asks"), given).outputs
        product = Asked(*(first[signal.name] for signal in ASKED))

        def close(applied: Sequence[Applied]) -> Closed:
            if not asked:
                return Closed({})
            span = self.wild.span
            smallest = _TOO_SMALL * span if ca.SX(span).is_regular() else 0.0
            told = {**first, **applied_ports(applied[0]), "smallest": ca.SX(smallest)}
            last = called(_IS_TOLD, path(name, "is_told"), told).outputs
            return Closed({}, {}, (Applied(*last.values()),))

        return Opened((product,), close)


@cache
def _asks(trimmed: bool) -> Block:
    """Return the block of the product, with the ratio that is given or that a loop trims."""
    trim = tuple(replace(signal, name=f"trim_{signal.name}") for signal in ASKED)

    def equations(s: Symbols) -> Equations:
        number = is_number(s["measurement"])
        wild = value_or_zero(s["measurement"], number)
        good = ca.logic_and(number, s["sensor"])
        if not trimmed:
            usable = ca.logic_and(good, is_number(s["ratio"]))
            return Equations({}, asked_ports(Asked(s["ratio"] * wild, usable, number, s["sensor"])))
        source = Asked(*(s[signal.name] for signal in trim))
        ratio = ca.fmin(s["highest_ratio"], ca.fmax(s["lowest_ratio"], source.value))
        product = Asked(
            ratio * wild,
            ca.logic_and(good, source.usable),
            ca.logic_and(number, source.numbers),
            ca.logic_and(s["sensor"], source.sensors),
        )
        return Equations({}, {**asked_ports(product), "ratio": ratio, "wild": wild, "good": good})

    ratios = (*trim, Signal("lowest_ratio"), Signal("highest_ratio"))
    return Block(
        "trimmed_ratio_asks" if trimmed else "ratio_asks",
        (
            Signal("measurement", description="the wild signal"),
            truth("sensor", "its sensor is good"),
            *(ratios if trimmed else (Signal("ratio"),)),
        ),
        (),
        (*ASKED, *(_CARRIED if trimmed else ())),
        equations,
        ("What follows is asked to be the ratio times the wild signal.",),
    )


def _is_told(s: Symbols) -> Equations:
    wild, ratio = s["wild"], s["ratio"]
    divisible = ca.fabs(wild) > s["smallest"]
    # What was applied as asked is told to the last bit: no rounding looks like a limit.
    quotient = s["applied"] / ca.if_else(divisible, wild, 1)
    got = ca.if_else(s["applied"] == s["asked"], ratio, quotient)
    known = ca.logic_and(divisible, s["good"])
    told = Applied(
        ca.if_else(known, got, ratio),
        ca.logic_and(s["in_force"], known),
        ca.logic_and(s["follows"], known),
    )
    return Equations({}, {f"got_{name}": value for name, value in applied_ports(told).items()})


_CARRIED = (Signal("ratio"), Signal("wild"), truth("good", "the wild signal is known"))
_IS_TOLD = Block(
    "trimmed_ratio_is_told",
    (*APPLIED, ASKED[0], *_CARRIED, Signal("smallest", description="that is divided by")),
    (),
    tuple(replace(signal, name=f"got_{signal.name}") for signal in APPLIED),
    _is_told,
    ("The ratio that was applied, or the one asked for where that cannot be told.",),
)
