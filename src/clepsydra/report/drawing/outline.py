"""The outline of a vessel as it is drawn: half of its width at each height."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clepsydra.process.element import Element
from clepsydra.report.drawing.bodies import PITCH, TANK_HALF, TANK_ROWS

#: Size of a drawn tank [px].
TANK_WIDTH, TANK_HEIGHT = 2 * TANK_HALF * PITCH, TANK_ROWS * PITCH
_STEPS = 40
#: A vessel narrower than this at its rim is drawn closed.
_OPEN = 0.35


@dataclass(frozen=True)
class Outline:
    """Shares of the greatest half-width from the floor to the rim.

    They are given at heights (1 - cos φ)/2 for equal steps of φ, so that a sphere is round near
    its poles.

    Examples
    --------
    >>> cone = Outline((0.0, 0.5, 1.0))
    >>> round(cone.share(0.5), 12), cone.open_above
    (0.5, True)
    """

    shares: tuple[float, ...]

    @property
    def open_above(self) -> bool:
        """Whether it is drawn without a lid."""
        return self.shares[-1] > _OPEN

    def share(self, height: float) -> float:
        """Return the share of the half-width at a share of the height."""
        angle = math.acos(1.0 - 2.0 * min(max(height, 0.0), 1.0))
        place = angle / math.pi * (len(self.shares) - 1)
        low = min(int(place), len(self.shares) - 2)
        return self.shares[low] + (place - low) * (self.shares[low + 1] - self.shares[low])

    def wall(self, y: float) -> float:
        """Return the distance of the wall from the middle [px], y below the rim [px]."""
        return TANK_WIDTH / 2 * self.share(1.0 - y / TANK_HEIGHT)

    def shell(self, x: float, above: bool) -> float:
        """Return how far below the rim a pipe at x from the middle meets the shell [px]."""
        steps = range(int(TANK_HEIGHT) + 1)
        heights = steps if above else reversed(steps)
        if above and self.open_above:
            return 0.0
        return next((float(y) for y in heights if self.wall(y) >= abs(x)), TANK_HEIGHT / 2)

    def polygon(self, x: float, y: float, height: float = 1.0) -> list[tuple[float, float]]:
        """Return the outline up to a share of the height, from the left wall over the floor.

        Parameters
        ----------
        x, y : float
            Middle and rim [px].
        height : float
            Share of the height.
        """
        count = len(self.shares) - 1
        inner = [h for h in (_height(place, count) for place in range(count + 1)) if h < height]
        wall = [
            (TANK_WIDTH / 2 * self.share(h), y + TANK_HEIGHT * (1.0 - h)) for h in [*inner, height]
        ]
        left = [(x - half, at) for half, at in reversed(wall)]
        return _without_repetition(left + [(x + half, at) for half, at in wall])


def _height(step: int, steps: int) -> float:
    return (1.0 - math.cos(math.pi * step / steps)) / 2.0


def outline_of(element: Element) -> Outline:
    """Return how a vessel is drawn: as wide at each height as the root of its area there.

    Anything that is no tank is a rectangle.
    """
    vessel = getattr(element, "vessel", None)
    if vessel is None or vessel.uniform:
        return Outline((1.0, 1.0))
    values = vessel.values()
    areas = [
        max(float(vessel.surface(vessel.height * _height(step, _STEPS), values)), 0.0)
        for step in range(_STEPS + 1)
    ]
    greatest = max(areas)
    return Outline(tuple(math.sqrt(area / greatest) for area in areas))


def _without_repetition(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [point for place, point in enumerate(points) if place == 0 or point != points[place - 1]]
