"""What a page may write into the process image of a rig."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Cell:
    """One number that a page may set.

    Parameters
    ----------
    name : str
        In the process image.
    low, high : float
        The least and the largest value that is taken [SI]; infinite where there is none.
    whole : bool
        Whether only whole numbers are taken.
    """

    name: str
    low: float = -math.inf
    high: float = math.inf
    whole: bool = False

    def doubt(self, value: float) -> str:
        """Return why a value is not taken; "" where it is.

        Examples
        --------
        >>> mode = Cell("pump_1.mode", 0.0, 2.0, whole=True)
        >>> mode.doubt(1.0), mode.doubt(1.5), mode.doubt(3.0)
        ('', 'pump_1.mode: 1.5 is no whole number', 'pump_1.mode: 3 is outside of 0 to 2 (SI)')
        """
        if self.whole and value != math.floor(value):
            return f"{self.name}: {value:g} is no whole number"
        if not self.low <= value <= self.high:
            return f"{self.name}: {value:g} is outside of {self.low:g} to {self.high:g} (SI)"
        return ""
