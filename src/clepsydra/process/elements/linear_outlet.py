"""A linear outlet: a flow in proportion to the level, as through a long thin tube."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.process.declared import flag, link
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class LinearOutlet(Element):
    """A laminar outlet at the floor: q = k h, or q = k (h₁ - h₂) between two tanks.

    The law of Hagen and Poiseuille for a tube of length l and radius r, k = π r⁴ g / (8 ν l).

    Parameters
    ----------
    coefficient : float
        k [m²/s]

    Examples
    --------
    >>> outlet = LinearOutlet("outlet_1", "tank_1", "basin", coefficient=2e-5)
    >>> (flow,) = outlet.flows({"outlet_1.coefficient": 2e-5, "tank_1.level": ca.SX(0.5)}, ())
    >>> float(flow.rate)
    1e-05
    """

    kind, table, symbol, place = "linear outlet", "linear_outlets", "orifice", 4
    #: The parameter that is 0 where it is plugged.
    opening: ClassVar[str] = "coefficient"

    source: str = link("the name of a tank", "tank")
    destination: str = link("the name of a tank or reservoir", "receiver")
    coefficient: float = quantity(
        "m^2/s",
        "a flow per level",
        "flow per level of",
        above=0.0,
        remedy="give the flow at one metre of level",
    )
    submerged: bool = flag(default=False, words="whether it joins two tanks below their surfaces")

    def as_built(self) -> tuple[str, ...]:
        """Return its flow per level."""
        return (f"{self.name}.coefficient",)

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q = k h."""
        level = symbols[f"{self.source}.level"]
        if self.submerged:
            driver = level - symbols[f"{self.destination}.level"]
        else:
            driver = ca.fmax(level, 0)
        coefficient = symbols[f"{self.name}.coefficient"]
        return (
            Flow(self.source, self.destination, coefficient, driver, reversible=self.submerged),
        )
