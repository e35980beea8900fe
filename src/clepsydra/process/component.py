"""A component: something dissolved in the liquid, carried by every stream."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.signal import Signal


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

    def in_element(self, owner: str, low: float, high: float, initial: float) -> Signal:
        """Return the signal of its concentration in an element, "tank_1.salt"."""
        name, words = f"{owner}.{self.name}", f"concentration of {self.name} in {owner}"
        shown = self.display_unit
        return Signal(name, self.unit, shown, low, high, initial, description=words)
