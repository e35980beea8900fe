"""A vessel: the shape of a tank, as area and volume over level and as level over volume.

The content of a tank is what its balance integrates, dV/dt = Σ q, so that volume is conserved
to rounding and a tank whose floor is a point may run empty: dh/dt = Σ q / A(h) has no value
there, while V and h(V) have.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Self

import casadi as ca

from clepsydra.base.quantity import quantities
from clepsydra.base.signal import Signal
from clepsydra.process.declared import DeclaredKeys, read_fields
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols

#: The smallest argument of a root, as a share of its largest: far below rounding, so that
#: values are right to the last digit, and above zero, so that derivatives are finite.
SMALLEST_SHARE = 1e-60
#: Below the floor and above the rim walls are vertical. Where the floor or the rim is a point or
#: a line, the area there is this share of the mean area, so that a rounding error of volume
#: stays a small error of level.
_LEAST_AREA_SHARE = 0.01


class Vessel(ABC):
    """What all shapes have in common: how area, volume and level go on beyond floor and rim.

    A shape gives area and volume from the floor to the rim and the level of the volumes between.
    Outside, walls are vertical: with the area of the floor below it, where a time step may have
    taken more than there was, and with the area of the rim above it, where liquid spills. An
    area of the floor or the rim below one hundredth of the mean area is replaced by that.

    The methods take numbers or CasADi expressions. `values` holds the parameters by key.

    Examples
    --------
    A cone holds a third of the cylinder around it, and an eighth of that at half its height:

    >>> from clepsydra.process.vessels.cone import Cone
    >>> cone = Cone(height=3.0, floor_diameter=0.0, rim_diameter=2.0)
    >>> values = cone.values()
    >>> round(cone.capacity, 6), round(float(cone.level(cone.capacity / 8, values)), 12)
    (3.141593, 1.5)
    """

    #: What a process file calls it: "cone".
    shape: ClassVar[str]
    #: The keys that a process file may give besides `shape`.
    keys: ClassVar[tuple[str, ...]] = DeclaredKeys()  # type: ignore[assignment]
    #: Its area is the same at every level, so that the level itself may be integrated.
    uniform: ClassVar[bool] = False

    #: From the floor to the rim [m].
    height: float

    @classmethod
    def read(cls, table: TableReader) -> Self:
        """Make the shape from the table of a tank: its fields say what they hold."""
        return cls(**read_fields(cls, table))

    def parameters(self) -> tuple[Signal, ...]:
        """Return the numbers that become parameters of the process, described without the tank."""
        return tuple(
            each.of("", getattr(self, each.name)) for each in quantities(type(self)) if each.words
        )

    @abstractmethod
    def _area_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the area [m²] at a level from the floor to the rim."""

    @abstractmethod
    def _volume_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the volume [m³] below a level from the floor to the rim."""

    @abstractmethod
    def _level_within(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level [m] of a volume from nothing to the capacity."""

    def values(self) -> dict[str, ca.SX]:
        """Return the value of each parameter by key, as constants of CasADi."""
        return {each.name: ca.SX(each.initial) for each in self.parameters()}

    def sizes(self, tank: str, symbols: Symbols) -> dict[str, ca.SX]:
        """Return the symbol of each parameter by key, where the vessel is that of a tank."""
        return {each.name: symbols[f"{tank}.{each.name}"] for each in self.parameters()}

    def rim(self, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level of the rim [m]; a shape overrides it where it follows a parameter."""
        return ca.SX(self.height)

    @property
    def capacity(self) -> float:
        """The volume at the rim [m³]."""
        return float(self.volume(ca.SX(self.height), self.values()))

    @property
    def closed(self) -> bool:
        """Whether its rim is a point or a line, so that nothing can rise above it."""
        values = self.values()
        rim = float(self._area_within(self.rim(values), values))
        return rim < _LEAST_AREA_SHARE * self.capacity / self.height

    def full(self, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the volume at the rim [m³].

        Examples
        --------
        >>> from clepsydra.process.vessels.prism import Prism
        >>> float(Prism(2.0, area=1.5).full({"area": ca.SX(1.5)}))
        3.0
        """
        return self._volume_within(self.rim(values), values)

    def surface(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the area of the surface [m²] at a level [m].

        Examples
        --------
        The circle at half the height of a sphere:

        >>> from clepsydra.process.vessels.sphere_segment import SphereSegment
        >>> sphere = SphereSegment(diameter=2.0, height=2.0)
        >>> round(float(sphere.surface(1.0, sphere.values())), 12)
        3.14159265359
        """
        rim = self.rim(values)
        below, above = self._areas_outside(values)
        within = self._area_within(ca.fmin(rim, ca.fmax(0.0, level)), values)
        return ca.if_else(level < 0.0, below, ca.if_else(level > rim, above, within))

    def volume(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the volume [m³] at a level [m].

        Examples
        --------
        >>> from clepsydra.process.vessels.sphere_segment import SphereSegment
        >>> sphere = SphereSegment(diameter=2.0, height=2.0)
        >>> round(float(sphere.volume(1.0, sphere.values())), 12)
        2.094395102393
        """
        rim = self.rim(values)
        below, above = self._areas_outside(values)
        within = self._volume_within(ca.fmin(rim, ca.fmax(0.0, level)), values)
        return within + below * ca.fmin(level, 0.0) + above * ca.fmax(level - rim, 0.0)

    def level(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level [m] at a volume [m³]: the inverse of `volume`, for every number.

        Between floor and rim its derivative is one over the area, exactly. At an end that is a
        point or a line, where that has no bound, it is finite.

        Examples
        --------
        A sphere that holds half its capacity is filled to half its height:

        >>> from clepsydra.process.vessels.sphere_segment import SphereSegment
        >>> sphere = SphereSegment(diameter=2.0, height=2.0)
        >>> round(float(sphere.level(sphere.capacity / 2, sphere.values())), 12)
        1.0
        """
        full = self.full(values)
        below, above = self._areas_outside(values)
        within = self._level_within(ca.fmin(full, ca.fmax(0.0, volume)), values)
        above_rim = ca.fmax(volume - full, 0.0) * reciprocal(above)
        return ca.if_else(volume <= 0.0, volume * reciprocal(below), within + above_rim)

    def _areas_outside(self, values: Mapping[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Return the areas [m²] below the floor and above the rim."""
        rim = self.rim(values)
        least = _LEAST_AREA_SHARE * self.full(values) / rim
        below = ca.fmax(self._area_within(ca.SX(0), values), least)
        return below, ca.fmax(self._area_within(rim, values), least)


def reciprocal(value: ca.SX) -> ca.SX:
    """Return 1/value in a form that CasADi leaves alone.

    It would rewrite x · (1/p) as the quotient x/p, and so put a division into every step where
    a parameter's reciprocal needs one division a run.

    Examples
    --------
    >>> reciprocal(4.0)
    0.25
    """
    return 0.5 * (2 / value)


def vessel_of(table: TableReader, tank: str) -> Vessel | None:
    """Return the shape of a tank for an element that is joined to it; None where there is none."""
    return table.made.get(tank)
