"""A component: something dissolved in the liquid, carried by every stream."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Component:
    """A dissolved component that every tank mixes and every stream carries.

    Parameters
    ----------
    unit : str
        SI unit of its concentration: "kg/m^3" or "mol/m^3".
    display_unit : str
        The unit that the user wrote.
    low, high : float
        Range of its concentrations [unit].
    """

    name: str
    unit: str
    display_unit: str
    low: float
    high: float

    @property
    def amount_unit(self) -> str:
        """SI unit of an amount of it."""
        return self.unit.removesuffix("/m^3")
