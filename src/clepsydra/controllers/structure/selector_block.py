"""A selector: the lowest or the highest of what several loops ask for (override control)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import casadi as ca

from clepsydra.controllers.blocks.final_element import ASKED, asked_ports
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.ports import called, instance
from clepsydra.controllers.structure.block import Closed, Opened, WithoutSignals
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Selection = Literal["low", "high"]


@dataclass(frozen=True)
class SelectorBlock(WithoutSignals):
    """The lowest or highest of several values.

    All its sources are told what was applied, so the integrals of those that were not selected
    follow it (external reset), and each takes over without a bump when its turn comes. A source
    that is not usable is passed over while another one is.

    Parameters
    ----------
    name : str
    sources : tuple of str
        Ports of loops.
    selection : {"low", "high"}

    References
    ----------
    F. G. Shinskey, Process Control Systems, 4th edition, McGraw-Hill 1996, chapter 6.

    Examples
    --------
    >>> SelectorBlock("lowest", ("level", "strength"), "low").ports
    ('lowest',)
    """

    name: str
    sources: tuple[str, ...]
    selection: Selection

    @property
    def ports(self) -> tuple[str, ...]:
        """The selected value."""
        return (self.name,)

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those after it, for every source."""
        return (after[0],) * len(self.sources)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Select."""
        chosen, name = asked[0], instance(self.name)
        for source, other in zip(self.sources[1:], asked[1:], strict=True):
            given = {
                f"{each}_{n}": value
                for each, wish in (("first", chosen), ("second", other))
                for n, value in asked_ports(wish).items()
            }
            both = f"{name}.or.{instance(source)}"
            found = called(_selector(self.selection), both, given)
            chosen = Asked(*(found.outputs[signal.name] for signal in ASKED))

        def close(applied: Sequence[Applied]) -> Closed:
            (result,) = applied
            told = tuple(
                Applied(result.value, ca.logic_and(result.in_force, source.usable), result.follows)
                for source in asked
            )
            return Closed({}, {}, told)

        return Opened((chosen,), close)


@cache
def _selector(selection: Selection) -> Block:
    """Return the block that selects one of two."""

    def equations(s: Symbols) -> Equations:
        first, second = (
            Asked(*(s[f"{each}_{signal.name}"] for signal in ASKED)) for each in ("first", "second")
        )
        pick = ca.fmin if selection == "low" else ca.fmax
        both = ca.logic_and(first.usable, second.usable)
        one = ca.if_else(first.usable, first.value, second.value)
        chosen = Asked(
            ca.if_else(both, pick(first.value, second.value), one),
            ca.logic_or(first.usable, second.usable),
            ca.logic_and(first.numbers, second.numbers),
            ca.logic_and(first.sensors, second.sensors),
        )
        return Equations({}, asked_ports(chosen))

    return Block(
        f"{selection}_selector",
        tuple(
            replace(signal, name=f"{each}_{signal.name}")
            for each in ("first", "second")
            for signal in ASKED
        ),
        (),
        ASKED,
        equations,
        (f"The {selection}est of two values; one that is not usable is passed over.",),
    )
