"""Small axes as SVG text: curves in a frame of two lines, with round numbers at their ticks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clepsydra.base.words import with_minus
from clepsydra.report.colours import INK, MUTED
from clepsydra.report.drawing.shapes import path, polygon, text

#: Intervals between ticks at most, and what they count in, in powers of ten.
_INTERVALS, _ROUND = 3, (1.0, 2.0, 2.5, 5.0, 10.0)
#: Of a tick and of the room to its words, and from the middle of a line of words to its baseline.
_TICK, _TO_WORDS, TO_BASELINE = 3.0, 2.0, 2.6
_GRID = "#e6e9ed"


def ticks(low: float, high: float) -> dict[float, str]:
    """Return the round numbers between two ends, three intervals at most, and their words.

    Examples
    --------
    >>> ticks(12.2, 14.6), ticks(-4.0, 40.0)
    ({13.0: '13', 14.0: '14'}, {0.0: '0', 20.0: '20', 40.0: '40'})
    >>> list(ticks(-0.03, 0.03).values())
    ['−0.02', '0.00', '0.02']
    """
    shortest = (high - low) / _INTERVALS
    power = math.floor(math.log10(shortest))
    number = next(each for each in _ROUND if each * 10.0**power >= 0.999 * shortest)
    step = number * 10.0**power
    digits = max(0, (number == 2.5) - power - (number == 10.0))
    # An end that is a tick but for rounding counts as that.
    first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    return {k * step: with_minus(f"{k * step:.{digits}f}") for k in range(first, last + 1)}


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve, and how it is drawn.

    Parameters
    ----------
    x, y : ndarray [points]
        It is interrupted where y is not finite.
    colour : str
    width : float
        Of the line.
    held : bool
        Whether y holds until the next x.
    dashes : str
        Of the line; empty for none.

    Examples
    --------
    >>> Curve(np.array([0.0, 1.0]), np.array([2.0, 3.0]), "#000000", held=True).points.tolist()
    [[0.0, 2.0], [1.0, 2.0], [1.0, 3.0]]
    """

    x: np.ndarray
    y: np.ndarray
    colour: str
    width: float = 1.2
    held: bool = False
    dashes: str = ""

    @property
    def points(self) -> np.ndarray:
        """Through what the line goes [n, 2]."""
        if not self.held:
            return np.column_stack([self.x, self.y])
        return np.column_stack([np.repeat(self.x, 2)[1:], np.repeat(self.y, 2)[:-1]])


@dataclass(frozen=True)
class Axes:
    """A frame at a place of a picture, and what stands at its ends.

    Parameters
    ----------
    left, top, width, height : float
        Of the frame, in the unit of the picture.
    x, y : (float, float)
        From its left to its right, and from its bottom to its top.
    """

    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]

    def across(self, x: float) -> float:
        """Return where a value stands from left to right."""
        return self.left + self.width * (x - self.x[0]) / (self.x[1] - self.x[0])

    def down(self, y: float) -> float:
        """Return where a value stands from top to bottom."""
        return self.top + self.height * (self.y[1] - y) / (self.y[1] - self.y[0])

    def frame(self, *, named: bool) -> list[str]:
        """Return the grid, the lines at the left and below, and their ticks.

        Parameters
        ----------
        named : bool
            Whether the ticks below have numbers.
        """
        right, bottom = self.left + self.width, self.top + self.height
        grid, lines, words = "", f"M{self.left:.1f} {self.top:.1f}V{bottom:.1f}H{right:.1f}", []
        for value, said in ticks(*self.x).items():
            x = self.across(value)
            grid += f"M{x:.1f} {self.top:.1f}V{bottom:.1f}"
            lines += f"M{x:.1f} {bottom:.1f}v{_TICK}"
            if named:
                words.append(text(x, bottom + _TICK + _TO_WORDS + 2.0 * TO_BASELINE, said))
        for value, said in ticks(*self.y).items():
            y = self.down(value)
            grid += f"M{self.left:.1f} {y:.1f}H{right:.1f}"
            lines += f"M{self.left:.1f} {y:.1f}h-{_TICK}"
            words.append(text(self.left - _TICK - _TO_WORDS, y + TO_BASELINE, said, "end"))
        return [path(grid, 0.6, stroke=_GRID), path(lines, 0.7, stroke=MUTED), *words]

    def curve(self, curve: Curve) -> str:
        """Return a curve in the frame; nothing where none of its values is finite."""
        x, y = curve.points.T
        places = np.column_stack([self.across(x), self.down(y)])
        known = np.flatnonzero(np.isfinite(y))
        parts = np.split(known, np.flatnonzero(np.diff(known) > 1) + 1)
        data = "".join(polygon(places[part].tolist(), closed=False) for part in parts if part.size)
        look = {"stroke": curve.colour, "stroke_dasharray": curve.dashes}
        return path(data, curve.width, **look) if data else ""

    def level(self, value: float) -> str:
        """Return a line across the frame."""
        right = self.left + self.width
        return path(f"M{self.left:.1f} {self.down(value):.1f}H{right:.1f}", 0.8, stroke=INK)
