"""A signal: one named scalar with its unit and its range."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Kind = Literal["real", "integer", "boolean"]


@dataclass(frozen=True)
class Signal:
    """A named scalar quantity: an input, a parameter, a state or an output.

    Parameters
    ----------
    name : str
        Whole words joined by underscores; a dot separates an element from its quantity
        ("tank_1.level").
    unit : str
        SI unit of every number held for this signal; "1" for none.
    display_unit : str
        The unit that the reader sees; the SI unit where empty.
    low, high : float
        The range [unit], 0 % and 100 %.
    initial : float
        Initial value of a state, nominal value of an input, value of a parameter [unit].
    kind : {"real", "integer", "boolean"}
        The type that a printed program declares.
    description : str
        One phrase for comments, axes and tables.

    Examples
    --------
    >>> level = Signal("tank_1.level", "m", display_unit="cm", low=0.0, high=0.2)
    >>> level.to_percent(0.124)
    62.0
    """

    name: str
    unit: str = "1"
    display_unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    initial: float = 0.0
    kind: Kind = "real"
    description: str = ""

    @property
    def span(self) -> float:
        """The width of the range, high - low [unit]; infinite where a limit is open.

        >>> Signal("pump_1", "V", low=-2.0, high=10.0).span, Signal("tank_1.area", low=0.0).span
        (12.0, inf)
        """
        return self.high - self.low

    @property
    def shown_unit(self) -> str:
        """The unit that the reader sees."""
        return self.display_unit or self.unit

    @property
    def identifier(self) -> str:
        """The name as an identifier of a programming language."""
        return self.name.replace(".", "_")

    def to_percent(self, value: float) -> float:
        """Return the place of a value [unit] in the range [%]."""
        return 100.0 * (value - self.low) / self.span

    def from_percent(self, percent: float) -> float:
        """Return the value [unit] at a place in the range [%]."""
        return self.low + self.span * percent / 100.0
