"""A prism: vertical walls, so a box or an upright cylinder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process.cross_section import cross_section
from clepsydra.process.vessels.vessel import Vessel, reciprocal


@dataclass(frozen=True)
class Prism(Vessel):
    """A vessel of constant cross-section, V = A h.

    Parameters
    ----------
    height : float
        From the floor to the rim [m].
    area : float
        Cross-section A [m²].

    Examples
    --------
    >>> prism = Prism(height=0.2, area=28e-4)
    >>> round(prism.capacity, 12), prism.uniform
    (0.00056, True)
    """

    shape: ClassVar[str] = "prism"
    keys: ClassVar[tuple[str, ...]] = ("area", "diameter", "height")
    uniform: ClassVar[bool] = True

    height: float = quantity(
        "m", "a height", above=0.0, remedy="give the height of the rim above the floor"
    )
    area: float = cross_section(
        "tank",
        "give the cross-section of the tank",
        "give the inner diameter of the tank",
        strict=True,
    )

    def parameters(self) -> tuple[Signal, ...]:
        """Return the cross-section."""
        return (Signal("area", "m^2", initial=self.area, description="cross-section"),)

    def surface(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the area [m²], the same at every level."""
        return values["area"]

    def volume(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the volume [m³] at a level [m], also below the floor and above the rim."""
        return values["area"] * level

    def level(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level [m] at a volume [m³], also below nothing and above the capacity."""
        return volume * reciprocal(values["area"])

    _area_within = surface
    _volume_within = volume
    _level_within = level
