"""One number that a record tells, with its confidence interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.designs.gain_units import unit_of_gain

#: An interval of a positive quantity whose ends differ by more says nothing.
_WIDE = 100.0


@dataclass(frozen=True)
class Estimate:
    """A parameter as it was found [SI], with its 95 % confidence interval or none: not a number."""

    signal: Signal
    value: float
    low: float = math.nan
    high: float = math.nan

    @property
    def shown(self) -> tuple[float, float, float]:
        """Value and interval in the unit that the reader sees."""
        signal = self.signal
        value, low, high = (
            from_si(number, signal.unit, signal.shown_unit)
            for number in (self.value, self.low, self.high)
        )
        return value, low, high

    @property
    def is_told(self) -> bool:
        """Whether the record tells it: its sign and, of a time constant, its order."""
        if math.isnan(self.low):
            return True
        if self.signal.low == 0.0:
            return self.low > 0.0 and self.high < _WIDE * self.low
        return self.low > 0.0 or self.high < 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return name, unit, value and interval [SI], for JSON."""
        return {
            "name": self.signal.name,
            "what": self.signal.description,
            "value": self.value,
            "low": self.low,
            "high": self.high,
            "unit": self.signal.unit,
        }


def around(signal: Signal, value: float, reach: float) -> Estimate:
    """Return an estimate whose interval reaches as far to both sides."""
    return Estimate(signal, value, value - reach, value + reach)


def by_logarithm(signal: Signal, value: float, reach: float) -> Estimate:
    """Return an estimate above zero, whose interval is that of its logarithm.

    Examples
    --------
    >>> found = by_logarithm(Signal("tau", "s", low=0.0), 10.0, math.log(2.0))
    >>> round(found.low, 9), round(found.high, 9)
    (5.0, 20.0)
    """
    factor = math.exp(min(reach, 700.0))
    return Estimate(signal, value, value / factor, value * factor)


def ratio_signal(
    name: str, output: Signal, manipulated: Signal, what: str, *, per: str = ""
) -> Signal:
    """Return the signal of a gain from an input to an output, with both its units.

    Examples
    --------
    >>> level = Signal("level", "m", display_unit="cm")
    >>> found = ratio_signal("slope", level, Signal("pump", "V"), "slope per input", per="/s")
    >>> found.unit, found.display_unit
    ('m/V/s', 'cm/V/s')
    """
    shown = (replace(each, unit=each.shown_unit) for each in (manipulated, output))
    unit, display = unit_of_gain(manipulated, output), unit_of_gain(*shown)
    return Signal(name, (unit or "1") + per, display_unit=(display or "1") + per, description=what)
