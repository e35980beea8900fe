"""A selector: the lowest or the highest of what several loops ask for (override control)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.structure.block import Closed, Opened
from clepsydra.program.step_law import Symbols

Selection = Literal["low", "high"]


@dataclass(frozen=True)
class SelectorBlock:
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

    def parameters(self) -> list[Signal]:
        """None."""
        return []

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
        """Those after it, for every source."""
        return (after[0],) * len(self.sources)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Select."""
        chosen = asked[0]
        for other in asked[1:]:
            chosen = self._better(chosen, other)

        def close(applied: Sequence[Applied]) -> Closed:
            (result,) = applied
            told = tuple(
                Applied(result.value, ca.logic_and(result.in_force, source.usable), result.follows)
                for source in asked
            )
            return Closed({}, {}, told)

        return Opened((chosen,), close)

    def _better(self, first: Asked, second: Asked) -> Asked:
        pick = ca.fmin if self.selection == "low" else ca.fmax
        both = ca.logic_and(first.usable, second.usable)
        one = ca.if_else(first.usable, first.value, second.value)
        return Asked(
            ca.if_else(both, pick(first.value, second.value), one),
            ca.logic_or(first.usable, second.usable),
            ca.logic_and(first.numbers, second.numbers),
            ca.logic_and(first.sensors, second.sensors),
        )
