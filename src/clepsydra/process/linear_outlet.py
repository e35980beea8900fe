"""A linear outlet: a flow in proportion to the level, as through a long thin tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class LinearOutlet(Element):
    """A laminar outlet at the floor: q = k h, or q = k (h₁ - h₂) between two tanks.

    The law of Hagen and Poiseuille for a tube of length l and radius r, k = π r⁴ g / (8 ν l).

    Parameters
    ----------
    name : str
    source : str
        The tank that it empties.
    destination : str
        The element that the liquid falls into; the other tank if submerged.
    coefficient : float
        k [m²/s]
    submerged : bool
        It joins two tanks below their surfaces, and flows either way.

    Examples
    --------
    >>> outlet = LinearOutlet("outlet_1", "tank_1", "basin", coefficient=2e-5)
    >>> (flow,) = outlet.flows({"outlet_1.coefficient": 2e-5, "tank_1.level": ca.SX(0.5)}, ())
    >>> float(flow.rate)
    1e-05
    """

    kind: ClassVar[str] = "linear outlet"
    table: ClassVar[str] = "linear_outlets"
    symbol: ClassVar[str] = "orifice"
    keys: ClassVar[tuple[str, ...]] = ("source", "destination", "coefficient", "submerged")

    source: str
    destination: str
    coefficient: float
    submerged: bool = False

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the outlet from its table of a process file."""
        return cls(
            name,
            source=table.name("source", "the name of a tank"),
            destination=table.name("destination", "the name of a tank or reservoir"),
            coefficient=table.quantity(
                "coefficient", "m^2/s", "a flow per level", "give the flow at one metre of level",
                above=0.0,
            ),
            submerged=table.flag("submerged", default=False),
            display_units=table.display_units("coefficient"),
        )  # fmt: skip

    def connections(self) -> tuple[Connection, ...]:
        """Return the tank above and the element below."""
        wanted = "tank" if self.submerged else "receiver"
        return (
            Connection(("source",), self.source, "tank"),
            Connection(("destination",), self.destination, wanted),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the flow per level."""
        return (self._parameter("coefficient", "m^2/s", self.coefficient, "flow per level of"),)

    def flows(self, symbols: Symbols, received: Sequence[Flow]) -> tuple[Flow, ...]:
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
