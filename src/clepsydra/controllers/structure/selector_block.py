"""A selector: the lowest or the highest of what several loops ask for (override control)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import casadi as ca

from clepsydra.controllers.blocks.ports import ASKED, Applied, Asked, Limits, instance, prefixed
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.structure.block import Opened, PlainBlock
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Selection = Literal["low", "high"]


@dataclass(frozen=True)
class SelectorBlock(PlainBlock):
    """The lowest or highest of several values.

    All its sources are told what was applied, so the integrals of those that were not selected
    follow it (external reset), and each takes over without a bump when its turn comes. A source
    that is not usable is passed over while another one is.

    `sources`: ports of loops.

    References
    ----------
    F. G. Shinskey, Process Control Systems, 4th edition, McGraw-Hill 1996, chapter 6.
    """

    name: str
    sources: tuple[str, ...]
    selection: Selection

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Select."""
        chosen, block = asked[0], _selector(self.selection)
        for source, other in zip(self.sources[1:], asked[1:], strict=True):
            both = f"{instance(self.name)}.or.{instance(source)}"
            given = chosen.ports("first_") | other.ports("second_")
            chosen = Asked.read(sample.call(block, both, **given))

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            (result,) = applied
            return tuple(
                replace(result, in_force=ca.logic_and(result.in_force, source.usable))
                for source in asked
            )

        return Opened((chosen,), close)


@cache
def _selector(selection: Selection) -> Block:
    """Return the block that selects one of two."""

    def equations(s: Symbols) -> Equations:
        first, second = Asked.read(s, "first_"), Asked.read(s, "second_")
        pick = ca.fmin if selection == "low" else ca.fmax
        both = ca.logic_and(first.usable, second.usable)
        one = ca.if_else(first.usable, first.asked, second.asked)
        chosen = Asked(
            ca.if_else(both, pick(first.asked, second.asked), one),
            ca.logic_or(first.usable, second.usable),
            ca.logic_and(first.numbers, second.numbers),
            ca.logic_and(first.sensors, second.sensors),
        )
        return Equations({}, chosen.ports())

    return Block(
        f"{selection}_selector",
        (*prefixed(ASKED, "first_"), *prefixed(ASKED, "second_")),
        (),
        ASKED,
        equations,
        (f"The {selection}est of two values; one that is not usable is passed over.",),
    )
