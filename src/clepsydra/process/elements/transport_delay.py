"""A transport delay: a channel or pipe that gives back what it received some time ago."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.process.declared import link
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.hybrid import Delay
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class TransportDelay(Element):
    """A channel with plug flow at constant speed: q_out(t) = q_in(t - τ).

    What is dissolved travels along: (q C)_out(t) = (q C)_in(t - τ).

    Parameters
    ----------
    destination : str
        The element that it runs into.
    time : float
        τ [s]
    """

    kind, table, symbol, place = "transport delay", "delays", "delay", 9
    receives = passes_on = True

    destination: str = link("the name of a tank or reservoir", "receiver")
    time: float = quantity("s", "a time", above=0.0, remedy="give the dead time")

    def delays(self) -> tuple[Delay, ...]:
        """Return the flow and what it carries."""
        return (
            Delay(self._flow, "m^3/s", self.time, "liquid"),
            *(
                Delay(self._flux(c.name), f"{c.amount_unit}/s", self.time, c.name)
                for c in self.components
            ),
        )

    def sent(self, symbols: Symbols, received: Flows) -> dict[str, ca.SX]:
        """Return the sums of what enters."""
        sent = {self._flow: sum((flow.rate for flow in received), start=ca.SX(0))}
        for c in self.components:
            fluxes = ((flow.fluxes or {})[c.name] for flow in received)
            sent[self._flux(c.name)] = sum(fluxes, start=ca.SX(0))
        return sent

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return what entered τ ago."""
        fluxes = {c.name: symbols[self._flux(c.name)] for c in self.components}
        return (Flow(self.name, self.destination, ca.SX(1), symbols[self._flow], fluxes=fluxes),)

    @property
    def _flow(self) -> str:
        return f"{self.name}.delayed_flow"

    def _flux(self, component: str) -> str:
        return f"{self.name}.delayed_{component}"
