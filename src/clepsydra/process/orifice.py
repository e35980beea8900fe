"""An orifice: a hole or short pipe out of a tank, without a valve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow
from clepsydra.process.root_law import falling_root, signed_root
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader

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
    name : str
    source : str
        The tank that it empties.
    destination : str
        The element that the liquid falls into; the other tank if submerged.
    area : float
        Cross-section a [m²]; 0 if it is plugged.
    discharge : float
        Discharge coefficient c [1].
    submerged : bool
        It joins two tanks below their surfaces.
    elevation : float
        z [m], of a free outlet above the floor of its tank; of a submerged one the height of the
        source's floor above that of the destination, counted with the level.
    laminar : float
        Difference of levels below which the flow is laminar [m].

    Examples
    --------
    >>> outlet = Orifice("outlet_1", "tank_1", "basin", area=0.071e-4)
    >>> symbols = {"outlet_1.area": 0.071e-4, "outlet_1.discharge": 1.0, "gravity": 9.81,
    ...            "tank_1.level": 0.124}
    >>> (flow,) = outlet.flows(symbols, ())
    >>> round(float(flow.rate) * 1e6, 4)  # [cm³/s]
    11.0744
    """

    kind: ClassVar[str] = "orifice"
    table: ClassVar[str] = "orifices"
    symbol: ClassVar[str] = "orifice"
    keys: ClassVar[tuple[str, ...]] = (
        "source", "destination", "area", "discharge", "submerged", "elevation", "laminar",
    )  # fmt: skip

    source: str
    destination: str
    area: float
    discharge: float = 1.0
    submerged: bool = False
    elevation: float = 0.0
    laminar: float = LAMINAR

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the orifice from its table of a process file."""
        submerged = table.flag("submerged", default=False)
        return cls(
            name,
            source=table.name("source", "the name of a tank"),
            destination=table.name("destination", "the name of a tank or reservoir"),
            area=table.quantity(
                "area", "m^2", "an area", "give the cross-section of the hole, 0 if it is plugged",
                at_least=0.0,
            ),
            discharge=table.quantity(
                "discharge",
                "1",
                "a discharge coefficient",
                "give a number, or leave the key out for 1",
                above=0.0,
                default=1.0,
            ),
            submerged=submerged,
            elevation=table.quantity(
                "elevation", "m", "a height", "leave it out for the floor",
                at_least=None if submerged else 0.0, default=0.0,
            ),
            laminar=table.quantity(
                "laminar", "m", "a small difference of levels", "leave it out for 1 mm",
                above=0.0, default=LAMINAR,
            ),
            display_units=table.display_units("area"),
        )  # fmt: skip

    def connections(self) -> tuple[Connection, ...]:
        """Return the tank above and the element below."""
        wanted = "tank" if self.submerged else "receiver"
        return (
            Connection(("source",), self.source, "tank"),
            Connection(("destination",), self.destination, wanted),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the cross-section and the discharge coefficient."""
        return (
            self._parameter("area", "m^2", self.area, "cross-section of"),
            self._parameter("discharge", "1", self.discharge, "discharge coefficient of"),
        )

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
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
