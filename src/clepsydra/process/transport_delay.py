"""A transport delay: a channel or pipe that gives back what it received some time ago."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow
from clepsydra.process.hybrid import Delay
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class TransportDelay(Element):
    """A channel with plug flow at constant speed: q_out(t) = q_in(t - τ).

    What is dissolved travels along: (q C)_out(t) = (q C)_in(t - τ).

    Parameters
    ----------
    name : str
    destination : str
        The element that it runs into.
    time : float
        τ [s]

    Examples
    --------
    >>> [delay.name for delay in TransportDelay("channel", "tank_2", 60.0).delays()]
    ['channel.delayed_flow']
    """

    kind: ClassVar[str] = "transport delay"
    table: ClassVar[str] = "delays"
    symbol: ClassVar[str] = "delay"
    keys: ClassVar[tuple[str, ...]] = ("destination", "time")
    receives: ClassVar[bool] = True
    passes_on: ClassVar[bool] = True

    destination: str
    time: float

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the delay from its table of a process file."""
        return cls(
            name,
            destination=table.name("destination", "the name of a tank or reservoir"),
            time=table.quantity("time", "s", "a time", "give the dead time", above=0.0),
            components=table.components,
            display_units=table.display_units("time"),
        )

    def connections(self) -> tuple[Connection, ...]:
        """Return the element that it runs into."""
        return (Connection(("destination",), self.destination, "receiver"),)

    def delays(self) -> tuple[Delay, ...]:
        """Return the flow and what it carries."""
        return (
            Delay(self._flow, "m^3/s", self.time, "liquid"),
            *(
                Delay(self._flux(c.name), f"{c.amount_unit}/s", self.time, c.name)
                for c in self.components
            ),
        )

    def sent(self, symbols: Symbols, received: Sequence[Flow]) -> dict[str, ca.SX]:
        """Return the sums of what enters."""
        sent = {self._flow: sum((flow.rate for flow in received), start=ca.SX(0))}
        for c in self.components:
            fluxes = ((flow.fluxes or {})[c.name] for flow in received)
            sent[self._flux(c.name)] = sum(fluxes, start=ca.SX(0))
        return sent

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
        """Return what entered τ ago."""
        fluxes = {c.name: symbols[self._flux(c.name)] for c in self.components}
        return (Flow(self.name, self.destination, ca.SX(1), symbols[self._flow], fluxes=fluxes),)

    @property
    def _flow(self) -> str:
        return f"{self.name}.delayed_flow"

    def _flux(self, component: str) -> str:
        return f"{self.name}.delayed_{component}"
