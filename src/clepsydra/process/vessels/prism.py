"""A prism: vertical walls, so a box or an upright cylinder."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import casadi as ca

from clepsydra.process.vessels.vessel import Vessel, VesselParameter, reciprocal

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


@dataclass(frozen=True, init=False)
class Prism(Vessel):
    """A vessel of constant cross-section, V = A h.

    Parameters
    ----------
    height : float
        From the floor to the rim [m].
    area : float
        Cross-section A [m²]; kept as `base_area`.

    Examples
    --------
    >>> prism = Prism(height=0.2, area=28e-4)
    >>> round(prism.capacity, 12), prism.uniform
    (0.00056, True)
    """

    shape: ClassVar[str] = "prism"
    keys: ClassVar[tuple[str, ...]] = ("area", "diameter", "height")
    uniform: ClassVar[bool] = True

    height: float
    base_area: float

    def __init__(self, height: float, area: float) -> None:
        object.__setattr__(self, "height", height)
        object.__setattr__(self, "base_area", area)

    @classmethod
    def read(cls, table: TableReader) -> Self:
        """Make the shape from the area, or the diameter of an upright cylinder."""
        if table.has("area") and table.has("diameter"):
            raise table.refused(
                "diameter",
                table.written("diameter"),
                "either an area or a diameter",
                "remove one of the two",
            )
        if table.has("diameter"):
            diameter = table.quantity(
                "diameter", "m", "a diameter", "give the inner diameter of the tank", above=0.0
            )
            area = math.pi / 4 * diameter**2
        else:
            area = table.quantity(
                "area", "m^2", "an area", "give the cross-section of the tank", above=0.0
            )
        height = table.quantity(
            "height", "m", "a height", "give the height of the rim above the floor", above=0.0
        )
        return cls(height=height, area=area)

    def parameters(self) -> tuple[VesselParameter, ...]:
        """Return the cross-section."""
        return (VesselParameter("area", "m^2", self.base_area, "cross-section"),)

    def area(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the area [m²], the same at every level."""
        return values["area"]

    def volume(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the volume [m³] at a level [m], also below the floor and above the rim."""
        return values["area"] * level

    def level(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level [m] at a volume [m³], also below nothing and above the capacity."""
        return volume * reciprocal(values["area"])

    _area_within = area
    _volume_within = volume
    _level_within = level
