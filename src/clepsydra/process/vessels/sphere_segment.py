"""A spherical bowl, or a whole sphere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.process.vessels.vessel import SMALLEST_SHARE, Vessel, reciprocal


@dataclass(frozen=True)
class SphereSegment(Vessel):
    """A sphere of diameter D, cut off at a height H ≤ D.

    With s = h/D the sphere is filled to the share v = 3 s² - 2 s³. The way back begins with a
    series in √(v/3) that is right to 0.4 %, and two steps of Halley's method, each of which
    cubes the error, take it to rounding. Above the centre the empty space is inverted, as that
    is exact near the top.

    Parameters
    ----------
    height : float
        From the floor to the rim [m].
    diameter : float
        Of the sphere [m].

    Examples
    --------
    >>> bowl = SphereSegment(height=0.25, diameter=1.0)
    >>> round(bowl.capacity, 6), round(float(bowl.level(bowl.capacity, bowl.values())), 12)
    (0.081812, 0.25)
    """

    shape: ClassVar[str] = "sphere"

    diameter: float = quantity(
        "m", "a diameter", "diameter", above=0.0, remedy="give the inner diameter of the sphere"
    )
    height: float = quantity(
        "m",
        "a height",
        above=0.0,
        at_most="diameter",
        default=None,
        remedy="a sphere ends at its diameter: correct height or diameter",
    )

    def __post_init__(self) -> None:
        if self.height is None:
            object.__setattr__(self, "height", self.diameter)

    def rim(self, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level of the rim [m], which no diameter puts above the top."""
        return ca.fmin(self.height, values["diameter"])

    def _area_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        return math.pi * level * (values["diameter"] - level)

    def _volume_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        return math.pi / 6 * level**2 * (3 * values["diameter"] - 2 * level)

    def _level_within(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        diameter = values["diameter"]
        whole = self._volume_within(diameter, values)
        lower = 2 * volume <= whole
        # Not fmin, whose derivative at half full is the mean of both sides, zero.
        smaller = ca.if_else(lower, volume, whole - volume)
        share = ca.fmax(smaller * reciprocal(whole), SMALLEST_SHARE)
        root = ca.sqrt(share * (1 / 3))
        # The series of the inverse; its last coefficient is set so that it meets s = 1/2.
        part = root * (1 + root * (1 / 3 + root * (5 / 18 + root * 0.62274)))
        for _ in range(2):
            error = part * part * (3 - 2 * part) - share
            slope = 6 * part * (1 - part)
            part = part - error * slope / (slope * slope - error * (3 - 6 * part))
        filled = diameter * part
        return ca.if_else(lower, filled, diameter - filled)
