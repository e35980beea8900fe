"""A reservoir: where liquid comes from and goes to, without end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.concentrations import (
    GivenConcentration,
    brought,
    concentration_signals,
    concentration_steps,
    concentration_values,
)
from clepsydra.process.element import Element
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Reservoir(Element):
    """A basin so large that its level does not change: dh/dt = 0, h = 0.

    Parameters
    ----------
    name : str
    given : mapping
        Component to its concentration in what is drawn from it.

    Examples
    --------
    >>> Reservoir("basin").receives
    True
    """

    kind: ClassVar[str] = "reservoir"
    place: ClassVar[int] = 1
    table: ClassVar[str] = "reservoirs"
    symbol: ClassVar[str] = "reservoir"
    receives: ClassVar[bool] = True
    gives: ClassVar[bool] = True
    endless: ClassVar[bool] = True

    given: Mapping[str, GivenConcentration] = brought()

    def brings(self) -> tuple[str, ...]:
        """Return the components with a concentration of their own."""
        return tuple(self.given)

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the concentrations that vary."""
        return concentration_signals(self.name, self.given, self.components)

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        """Return the sizes of the load steps of its concentrations by signal."""
        return concentration_steps(self.name, self.given)

    def concentrations(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return what is drawn from it carries."""
        return concentration_values(self.name, self.given, self.components, symbols)
