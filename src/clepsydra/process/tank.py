"""A tank: an open vessel with vertical walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Element, Flow
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True)
class Tank(Element):
    """A tank of constant cross-section: A dh/dt = Σ q_in - Σ q_out.

    The mass balance of an incompressible liquid; see W. L. Luyben, Process Modeling,
    Simulation and Control for Chemical Engineers, 1990, section 2.1.

    Parameters
    ----------
    name : str
    area : float
        Cross-section A [m²].
    height : float
        From the floor to the rim [m]; the upper end of the range of the level.

    Examples
    --------
    >>> tank = Tank("tank_1", area=28e-4, height=0.2)
    >>> [signal.name for signal in tank.states() + tank.parameters()]
    ['tank_1.level', 'tank_1.area']
    """

    kind: ClassVar[str] = "tank"
    table: ClassVar[str] = "tanks"
    keys: ClassVar[tuple[str, ...]] = ("area", "height")
    receives: ClassVar[bool] = True

    area: float
    height: float

    @classmethod
    def read(cls, name: str, table: TableReader) -> Self:
        """Make the tank from its table of a process file."""
        return cls(
            name,
            area=table.quantity(
                "area", "m^2", "an area", "give the cross-section of the tank", above=0.0
            ),
            height=table.quantity(
                "height", "m", "a height", "give the height of the rim above the floor", above=0.0
            ),
            display_units=table.display_units("area", "height"),
        )

    @property
    def level(self) -> str:
        """The name of its state."""
        return f"{self.name}.level"

    def states(self) -> tuple[Signal, ...]:
        """Return the level, from the floor to the rim; searches for it begin half-way up."""
        return (
            Signal(
                self.level,
                "m",
                display_unit=self.display_units.get("height", ""),
                low=0.0,
                high=self.height,
                initial=self.height / 2,
                description=f"level of {self.name}",
            ),
        )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the cross-section."""
        return (self._parameter("area", "m^2", self.area, "cross-section of"),)

    def derivatives(
        self, symbols: Symbols, received: Sequence[Flow], given: Sequence[Flow]
    ) -> dict[str, ca.SX]:
        """Return dh/dt [m/s]; all that depends on parameters only is multiplied first."""
        # Exactly 1/A. CasADi would rewrite q · (1/A) as the quotient q/A and so put a division
        # into every step; this product it leaves alone.
        inverse_area = 0.5 * (2 / symbols[f"{self.name}.area"])
        rate = ca.SX(0)
        for flow in received:
            rate += flow.coefficient * inverse_area * flow.driver
        for flow in given:
            rate -= flow.coefficient * inverse_area * flow.driver
        return {self.level: rate}
