"""Numbers and lists as the warnings print them."""

from __future__ import annotations

import math

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si

#: What is less than this share of a range is nothing.
_ROUNDING = 1e-9


def shown(value: float, signal: Signal) -> str:
    """Return a value of a signal with four digits and the unit that the reader sees.

    Examples
    --------
    >>> shown(0.123456, Signal("tank_1.level", "m", display_unit="cm"))
    '12.35 cm'
    """
    if abs(value) <= _ROUNDING * signal.span and math.isfinite(signal.span):
        value = 0.0
    unit = "" if signal.shown_unit == "1" else f" {signal.shown_unit}"
    return f"{from_si(value, signal.unit, signal.shown_unit):.4g}{unit}"
