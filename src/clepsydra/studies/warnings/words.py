"""Numbers as the warnings print them."""

from __future__ import annotations

import math

from clepsydra.base.signal import Signal
from clepsydra.designs.request import in_shown_unit

#: What is less than this share of a range is nothing.
_ROUNDING = 1e-9


def shown(value: float, signal: Signal) -> str:
    """Return a value of a signal with four digits and the unit that the reader sees.

    Examples
    --------
    >>> shown(0.123456, Signal("tank_1.level", "m", display_unit="cm"))
    '12.35 cm'
    """
    nothing = math.isfinite(signal.span) and abs(value) <= _ROUNDING * signal.span
    return in_shown_unit(signal, 0.0 if nothing else value, digits=4)
