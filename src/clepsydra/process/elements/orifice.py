"""An orifice: a hole or short pipe out of a tank, without a valve."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process.cross_section import cross_section
from clepsydra.process.declared import flag, link
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.root_law import falling_root, signed_root
from clepsydra.program.step_law import Symbols

#: Level differences below which the flow is laminar, where the file does not say [m].
LAMINAR = 1e-3


@dataclass(frozen=True)
class Orifice(Element):
    """An opening at height z above a floor: q = c a √(2 g) φ(h - z).

    φ is the root law of `clepsydra.process.root_law`: Torricelli's √h (De motu aquarum, 1644),
    laminar below a small difference. A free outlet falls into whatever is below and nothing
    comes back. A submerged one joins two tanks at their floors, q = c a √(2 g) φ(h₁ - h₂), and
    flows either way.

    Parameters
    ----------
    area : float
        Cross-section a [m²]; 0 if it is plugged.
    discharge : float
        Discharge coefficient c [1].
    elevation : float
        z [m], of a free outlet above the floor of its tank; of a submerged one the height of the
        source's floor above that of the destination, counted with the level.

    Examples
    --------
    >>> outlet = Orifice("outlet_1", "tank_1", "basin", area=0.071e-4)
    >>> symbols = {"outlet_1.area": 0.071e-4, "outlet_1.discharge": 1.0, "gravity": 9.81,
    ...            "tank_1.level": 0.124}
    >>> (flow,) = outlet.flows(symbols, ())
    >>> round(float(flow.rate) * 1e6, 4)  # [cm³/s]
    11.0744
    """

    kind, table, symbol, place = "orifice", "orifices", "orifice", 3
    #: The parameter that is 0 where it is plugged.
    opening: ClassVar[str] = "area"

    source: str = link("the name of a tank", "tank")
    destination: str = link("the name of a tank or reservoir", "receiver")
    area: float = cross_section(
        "opening",
        "give the cross-section of the hole, 0 if it is plugged",
        "give the inner diameter of the hole, 0 if it is plugged",
        strict=False,
    )
    discharge: float = quantity(
        "1",
        "a discharge coefficient",
        "discharge coefficient of",
        above=0.0,
        default=1.0,
        remedy="give a number, or leave the key out for 1",
    )
    submerged: bool = flag(default=False, words="whether it joins two tanks below their surfaces")
    elevation: float = quantity(
        "m",
        "a height",
        remedy="leave it out for the floor",
        default=0.0,
        lowest=lambda known: -math.inf if known["submerged"] else 0.0,
    )
    laminar: float = quantity(
        "m",
        "a small difference of levels",
        above=0.0,
        default=LAMINAR,
        remedy="leave it out for 1 mm",
    )

    def parameters(self) -> tuple[Signal, ...]:
        """Return its area, shown in the square of the unit of a diameter, and the coefficient."""
        area = self._parameter("area", "m^2", self.area, "cross-section of")
        diameter = self.display_units.get("diameter")
        if diameter is not None:
            area = replace(area, display_unit=f"{diameter}^2")
        return (area, *super().parameters())

    def as_built(self) -> tuple[str, ...]:
        """Return its area: how a hole was drilled."""
        return (f"{self.name}.area",)

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return q = (c a √(2 g)) · φ: one root a step, the other once a run."""
        area, discharge = symbols[f"{self.name}.area"], symbols[f"{self.name}.discharge"]
        coefficient = discharge * area * ca.sqrt(2 * symbols["gravity"])
        level = symbols[f"{self.source}.level"]
        if self.submerged:
            above = level + self.elevation if self.elevation else level
            driver = signed_root(above - symbols[f"{self.destination}.level"], self.laminar)
        else:
            above = level - self.elevation if self.elevation else level
            driver = falling_root(above, self.laminar)
        return (
            Flow(self.source, self.destination, coefficient, driver, reversible=self.submerged),
        )
