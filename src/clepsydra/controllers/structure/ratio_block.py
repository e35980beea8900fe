"""Ratio control: one flow is kept in proportion to another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import (
    APPLIED,
    ASKED,
    Applied,
    Asked,
    Limits,
    instance,
    prefixed,
    truth,
)
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.controllers.signals import signed
from clepsydra.controllers.structure.block import Opened, PlainBlock
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: A wild signal within this share of its range cannot be divided by.
_TOO_SMALL = 1e-3


@dataclass(frozen=True)
class RatioBlock(PlainBlock):
    """What is asked for is a ratio times a wild signal, in units of both.

    `owner`: what its parameters belong to; `wild`: the measurement that nobody moves here; `moved`:
    what follows it: an output, or another loop's setpoint; `source`: the port of a loop that trims
    the ratio; without one the parameter ratio is it.
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

    def parameters(self) -> list[Signal]:
        """The ratio, or the limits between which a loop may trim it."""
        keys = (_RATIO,) if self.source is None else _ENDS
        return [key.of(self.owner, output=self.moved, wild=self.wild) for key in keys]

    def limits(self, sample: Sample, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those of the ratio."""
        if self.source is None:
            return ()
        return (Limits(*sample.of(self.owner, *(key.name for key in _ENDS))),)

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Multiply."""
        name, (measurement, sensor) = instance(self.name), sample.of(self.wild, "pv", "good")
        given = {"measurement": measurement, "sensor": sensor}
        for source in asked:
            given |= source.ports("trim_")
        first = sample.call(_demand(bool(asked)), path(name, "demand"), self.owner, **given)

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            if not asked:
                return ()
            span = self.wild.span
            smallest = ca.SX(_TOO_SMALL * span if math.isfinite(span) else 0.0)
            told = {**first, **applied[0].ports(), "smallest": smallest}
            return (Applied.read(sample.call(_UPDATE, path(name, "update"), **told), "got_"),)

        return Opened((Asked.read(first),), close)


_OF, _NAMES = "{output}/{wild}", "ratio of {output} to {wild}"
_RATIO = signed("ratio", _OF, _NAMES, 1.0)
_ENDS = tuple(
    signed(f"{end}_ratio", _OF, f"{end} {_NAMES}", value, below=other)
    for end, value, other in (("lowest", 0.0, "highest_ratio"), ("highest", 10.0, ""))
)


@cache
def _demand(trimmed: bool) -> Block:
    """Return the block of the product, with the ratio that is given or that a loop trims."""

    def equations(s: Symbols) -> Equations:
        number = is_number(s["measurement"])
        wild = value_or_zero(s["measurement"], number)
        good = ca.logic_and(number, s["sensor"])
        if not trimmed:
            usable = ca.logic_and(good, is_number(s["ratio"]))
            return Equations({}, Asked(s["ratio"] * wild, usable, number, s["sensor"]).ports())
        source = Asked.read(s, "trim_")
        ratio = ca.fmin(s["highest_ratio"], ca.fmax(s["lowest_ratio"], source.asked))
        product = Asked(
            ratio * wild,
            ca.logic_and(good, source.usable),
            ca.logic_and(number, source.numbers),
            ca.logic_and(s["sensor"], source.sensors),
        )
        return Equations({}, {**product.ports(), "ratio": ratio, "wild": wild, "good": good})

    trim = (*prefixed(ASKED, "trim_"), *(Signal(key.name) for key in _ENDS))
    return Block(
        "trimmed_ratio_demand" if trimmed else "ratio_demand",
        (
            Signal("measurement", description="the wild signal"),
            truth("sensor", "its sensor is good"),
            *(trim if trimmed else (Signal("ratio"),)),
        ),
        (),
        (*ASKED, *(_CARRIED if trimmed else ())),
        equations,
        ("What follows is asked to be the ratio times the wild signal.",),
    )


def _updated(s: Symbols) -> Equations:
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
    return Equations({}, told.ports("got_"))


_CARRIED = (Signal("ratio"), Signal("wild"), truth("good", "the wild signal is known"))
_UPDATE = Block(
    "trimmed_ratio_update",
    (*APPLIED, ASKED[0], *_CARRIED, Signal("smallest", description="that is divided by")),
    (),
    prefixed(APPLIED, "got_"),
    _updated,
    ("The ratio that was applied, or the one asked for where that cannot be told.",),
)
