"""The outline of a vessel as it is drawn: half of its width at each height."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from clepsydra.process.element import Element
from clepsydra.report.drawing.bodies import PITCH, TANK_HALF, TANK_ROWS

#: Size of a drawn tank [px].
TANK_WIDTH, TANK_HEIGHT = 2 * TANK_HALF * PITCH, TANK_ROWS * PITCH
#: Where a vessel is measured, in shares of its height: closer near the poles of a sphere.
_HEIGHTS = (1.0 - np.cos(np.linspace(0.0, math.pi, 41))) / 2.0
#: A vessel narrower than this at its rim is drawn closed.
_OPEN = 0.35


@dataclass(frozen=True)
class Outline:
    """Shares of the greatest half-width at shares of the height, from the floor to the rim.

    Examples
    --------
    >>> cone = Outline((0.0, 1.0), (0.0, 1.0))
    >>> cone.polygon(64.0, 0.0, 0.5), cone.open_above
    ([(32.0, 56.0), (64.0, 112.0), (96.0, 56.0)], True)
    """

    heights: tuple[float, ...]
    shares: tuple[float, ...]

    @property
    def open_above(self) -> bool:
        """Whether it is drawn without a lid."""
        return self.shares[-1] > _OPEN

    def polygon(self, x: float, y: float, height: float = 1.0) -> list[tuple[float, float]]:
        """Return the outline up to a share of the height, from the left wall over the floor.

        Parameters
        ----------
        x, y : float
            Middle and rim [px].
        height : float
            Share of the height.
        """
        heights = [*(each for each in self.heights if each < height), height]
        halves = TANK_WIDTH / 2 * np.interp(heights, self.heights, self.shares)
        wall = [
            (half, y + TANK_HEIGHT * (1.0 - each))
            for half, each in zip(halves.tolist(), heights, strict=True)
        ]
        left = [(x - half, at) for half, at in reversed(wall)]
        return [point for point, _ in groupby(left + [(x + half, at) for half, at in wall])]


def outline_of(element: Element) -> Outline:
    """Return how a vessel is drawn: as wide at each height as the root of its area there.

    Anything that is no tank is a rectangle.
    """
    vessel = getattr(element, "vessel", None)
    if vessel is None or vessel.uniform:
        return Outline((0.0, 1.0), (1.0, 1.0))
    values = vessel.values()
    heights = _HEIGHTS.tolist()
    areas = [max(float(vessel.surface(vessel.height * each, values)), 0.0) for each in heights]
    return Outline(tuple(heights), tuple(math.sqrt(area / max(areas)) for area in areas))
