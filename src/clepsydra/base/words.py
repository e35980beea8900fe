"""Numbers in sentences."""

from __future__ import annotations

import math


def seconds(time: float) -> str:
    """Return a time with three digits, without an exponent.

    Examples
    --------
    >>> seconds(8143.3), seconds(0.0512), seconds(float("inf"))
    ('8140 s', '0.0512 s', 'no end')
    """
    return f"{float(f'{time:.3g}'):g} s" if math.isfinite(time) else "no end"
