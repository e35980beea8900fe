"""A cylinder that lies on its side, with flat ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.process.vessels.vessel import SMALLEST_SHARE, Vessel, reciprocal

#: h/D = u P(2u - 1) with u = (2v)^(2/3), for shares v of the capacity up to one half. P is
#: analytic, as h is a power series in v^(2/3); this is its interpolation in 23 Chebyshev points,
#: in ascending powers, computed to 19 digits. Its own error is below 2e-16.
_LEVEL_SERIES = (
    0.46563170001411985,
    0.027144890767249134,
    0.005238212256448697,
    0.0013650379129142764,
    0.00041112903670234845,
    0.00013491998336679357,
    4.6866927752709355e-05,
    1.69522142307932e-05,
    6.320158732166814e-06,
    2.4123206410131497e-06,
    9.381730658190449e-07,
    3.703696635237346e-07,
    1.4813936991203448e-07,
    6.023213057194936e-08,
    2.4584280210201477e-08,
    9.536406608171076e-09,
    3.944028789884945e-09,
    2.287863513804503e-09,
    9.634958926913743e-10,
    -4.613688909442148e-11,
    -2.1486394621198524e-11,
    1.7164226291544615e-10,
    7.351838041446675e-11,
)


@dataclass(frozen=True)
class HorizontalCylinder(Vessel):
    """A lying cylinder of diameter D and length L.

    The wetted part of its end is a segment of half angle φ, cos φ = 1 - 2h/D, and the share of
    the capacity is v = (φ - sin φ cos φ)/π. The way back is Kepler's equation of an orbit of
    eccentricity one. Newton's method on it divides nothing by nothing at the bottom; the level
    is a smooth function of v^(2/3) instead, and a polynomial gives it to rounding. Above half
    full the empty space is inverted.

    Parameters
    ----------
    diameter, length : float
        [m].

    Examples
    --------
    >>> drum = HorizontalCylinder(diameter=2.0, length=3.0)
    >>> drum.height, round(drum.capacity / math.pi, 12)
    (2.0, 3.0)
    >>> round(float(drum.level(drum.capacity / 2, drum.values())), 12)
    1.0
    """

    shape: ClassVar[str] = "horizontal cylinder"

    diameter: float = quantity(
        "m", "a diameter", "diameter", above=0.0, remedy="give the inner diameter of the tank"
    )
    length: float = quantity(
        "m", "a length", "length", above=0.0, remedy="give the inner length of the tank"
    )
    height: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "height", self.diameter)

    def rim(self, values: Mapping[str, ca.SX]) -> ca.SX:
        """Return the level of the rim [m]: the diameter."""
        return values["diameter"]

    def _area_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        diameter = values["diameter"]
        smallest = SMALLEST_SHARE * diameter**2
        return 2 * values["length"] * ca.sqrt(ca.fmax(level * (diameter - level), smallest))

    def _volume_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        diameter = values["diameter"]
        lower = 2 * level <= diameter
        # Not fmin, whose derivative at half full is the mean of both sides, zero.
        depth = ca.if_else(lower, level, diameter - level)
        share = ca.fmax(depth * reciprocal(diameter), SMALLEST_SHARE)
        half_angle = 2 * ca.asin(ca.sqrt(share))
        segment = half_angle - 2 * (1 - 2 * share) * ca.sqrt(share * (1 - share))
        smaller = 0.25 * diameter**2 * values["length"] * segment
        full = math.pi / 4 * diameter**2 * values["length"]
        return ca.if_else(lower, smaller, full - smaller)

    def _level_within(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        diameter = values["diameter"]
        full = math.pi / 4 * diameter**2 * values["length"]
        lower = 2 * volume <= full
        smaller = ca.if_else(lower, volume, full - volume)
        power = ca.fmax(2 * smaller * reciprocal(full), SMALLEST_SHARE) ** (2 / 3)
        point = 2 * power - 1
        series = _LEVEL_SERIES[-1]
        for coefficient in reversed(_LEVEL_SERIES[:-1]):
            series = series * point + coefficient
        filled = diameter * power * series
        return ca.if_else(lower, filled, diameter - filled)
