"""A cone, also truncated, that widens or narrows upward."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import SMALLEST_SHARE, Vessel


@dataclass(frozen=True)
class Cone(Vessel):
    """A frustum of a cone: the radius r goes in a line from the floor to the rim.

    At a distance z from the narrow end, with k = dr/dz and r₀ the radius there,
    V = π z (r₀² + r₀ r + r²)/3. As r³ - r₀³ = 3 k V/π, the way back is a cube root and a
    quotient that holds for k = 0 as well. Volumes are measured from the narrow end because the
    radius of a small volume beside a point follows from that volume only.

    Parameters
    ----------
    height : float
        From the floor to the rim [m].
    floor_diameter, rim_diameter : float
        [m]; one of them may be zero.

    Examples
    --------
    A frustum of radii 1 m and 2 m and height 3 m holds 7π m³:

    >>> frustum = Cone(height=3.0, floor_diameter=2.0, rim_diameter=4.0)
    >>> round(frustum.capacity / math.pi, 12)
    7.0
    """

    shape: ClassVar[str] = "cone"

    height: float = quantity(
        "m", "a height", above=0.0, remedy="give the height of the rim above the floor"
    )
    floor_diameter: float = quantity(
        "m",
        "a diameter",
        "diameter at the floor",
        at_least=0.0,
        remedy="give the inner diameter at the floor, 0 for a point",
        default=0.0,
    )
    rim_diameter: float = quantity(
        "m",
        "a diameter",
        "diameter at the rim",
        at_least=0.0,
        default=0.0,
        required=True,
        remedy="give the inner diameter at the rim, 0 for a point",
    )

    @classmethod
    def read(cls, table: TableReader) -> Self:
        """Make the shape from its height and the diameters at floor and rim."""
        cone = super().read(table)
        if cone.floor_diameter == cone.rim_diameter == 0.0:
            expected = "a diameter above 0 m at the floor or at the rim"
            raise table.wrong("rim_diameter", expected, "correct one of the two diameters")
        return cone

    @property
    def _widens(self) -> bool:
        return self.floor_diameter <= self.rim_diameter

    def _radii(self, values: Mapping[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Return the radius at the narrow end and at the wide end [m]."""
        floor, rim = 0.5 * values["floor_diameter"], 0.5 * values["rim_diameter"]
        return (floor, rim) if self._widens else (rim, floor)

    def _radius(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        share = level / self.height
        return 0.5 * (values["floor_diameter"] * (1 - share) + values["rim_diameter"] * share)

    def _area_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        return math.pi * self._radius(level, values) ** 2

    def _volume_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        narrow, wide = self._radii(values)
        radius = self._radius(level, values)
        if self._widens:
            return math.pi / 3 * level * (narrow**2 + narrow * radius + radius**2)
        full = math.pi / 3 * self.height * (narrow**2 + narrow * wide + wide**2)
        empty = self.height - level
        return full - math.pi / 3 * empty * (narrow**2 + narrow * radius + radius**2)

    def _level_within(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        narrow, wide = self._radii(values)
        full = math.pi / 3 * self.height * (narrow**2 + narrow * wide + wide**2)
        measured = volume if self._widens else full - volume
        growth = 3 / math.pi * ((wide - narrow) / self.height)
        smallest = SMALLEST_SHARE * (narrow**3 + wide**3)
        radius = ca.fmax(narrow**3 + growth * measured, smallest) ** (1 / 3)
        distance = 3 / math.pi * measured / (narrow**2 + narrow * radius + radius**2)
        return distance if self._widens else self.height - distance
