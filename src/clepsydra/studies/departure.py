"""How far and for how long loads drive a level out of its band, which is no longer good enough."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from clepsydra.base.words import time_text
from clepsydra.linear.signal_words import shown

if TYPE_CHECKING:
    from clepsydra.process.process import Process

#: A share of the measurement's range that no sensor shows, and rounding and integration may leave.
_NOTHING = 1e-4


def departures(process: Process, scores: Mapping[str, float]) -> tuple[str, ...]:
    """Return the levels that a run with these scores took out of their bands, a clause each.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.base.signal import Signal
    >>> level = Signal("level", "1", "%", low=0.0, high=1.0)
    >>> process = SimpleNamespace(bands=("level",), signal=lambda name: level)
    >>> departures(process, {"time_outside_band[level]": 754.0, "above_band[level]": 0.034})
    ('level is outside for 12.6 min, by at most 3.4 % above',)
    """
    found = []
    for name in process.bands:
        signal = process.signal(name)
        time, above, below = (
            scores.get(f"{key}[{name}]", 0.0)
            for key in ("time_outside_band", "above_band", "below_band")
        )
        far = [
            f"{shown(signal, depth, 3)} {side}"
            for side, depth in (("above", above), ("below", below))
            if depth > _NOTHING * signal.span
        ]
        if far:
            words = " and ".join(far)
            found.append(f"{name} is outside for {time_text(time)}, by at most {words}")
    return tuple(found)
