"""Numbers and lists as the warnings print them."""

from __future__ import annotations

import math
from collections.abc import Sequence

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


def listed(names: Sequence[str]) -> str:
    """Return names as a list in a sentence.

    Examples
    --------
    >>> listed(["level_1"]), listed(["level_1", "level_2", "level_3"])
    ('level_1', 'level_1, level_2 and level_3')
    """
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
